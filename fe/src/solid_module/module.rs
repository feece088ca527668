use super::{
    SolidModuleError, SolidModuleSettings, equations::Tangent, equilibrium::SolidShape,
    joined_free::JoinedFree,
};
use crate::tip_plate::{GuidedPlate, Plate};
use actuator::Module;
use rayon::prelude::*;

/// A module of FREEs as solids, clamped to two rigid plates.
///
/// The FREEs meet in the plate's six coordinates q alone. Each is assembled with its cap carried, its inside eliminated (`S = K_cc - K_ci
/// K_ii^-1 K_ic`), and the plate's tangent is the sum of `T^T S T`, T being how a cap moves with q, and what turning arms and coordinates
/// add. Negative eigenvalues of the whole are those of every K_ii and of the plate's tangent (Haynsworth).
///
/// Loads, guides and pose are those of [`crate::RodModule`]. Spacers there are none.
pub struct SolidModule {
    pub(super) frees: Vec<JoinedFree>,
    pub(super) tip: GuidedPlate,
    pub(super) height: f64,
    /// The tangent factorised last.
    pub(super) tangent: Option<Tangent>,
    pool: Option<rayon::ThreadPool>,
}

impl SolidModule {
    /// A module at rest.
    ///
    /// # Errors
    /// [`SolidModuleError`] where the module has spacers or a FREE makes no solid.
    pub fn new(module: &Module, settings: SolidModuleSettings) -> Result<Self, SolidModuleError> {
        if module.spacers > 0 {
            return Err(SolidModuleError::Spacers(module.spacers));
        }
        if module.frees.is_empty() {
            return Err(SolidModuleError::Empty);
        }
        let join = |(free, placed): (usize, &actuator::PlacedFree)| {
            JoinedFree::new(module, placed, settings.mesh(&placed.free))
                .map_err(|source| SolidModuleError::Free { free, source })
        };
        let frees: Vec<JoinedFree> = module.frees.iter().enumerate().map(join).collect::<Result<_, _>>()?;
        let threads = settings.threads.min(frees.len());
        let pool = (threads > 1).then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
        Ok(SolidModule {
            frees,
            tip: GuidedPlate::new(module, &settings.tip_load),
            height: module.length(),
            tangent: None,
            pool: pool.and_then(Result::ok),
        })
    }

    /// Unknowns of all FREEs and of the plate.
    pub fn unknowns(&self) -> usize {
        self.frees.iter().map(|free| free.solver.unknowns() - 6).sum::<usize>() + 6
    }

    /// Does the same to each FREE, on as many threads as were asked for. In the order of the FREEs.
    pub(super) fn each<T: Send>(&mut self, work: impl Fn(usize, &mut JoinedFree) -> T + Sync) -> Vec<T> {
        let frees = &mut self.frees;
        match &self.pool {
            Some(pool) => pool.install(|| {
                frees.par_iter_mut().enumerate().map(|(index, free)| work(index, free)).collect()
            }),
            None => frees.iter_mut().enumerate().map(|(index, free)| work(index, free)).collect(),
        }
    }

    /// Middle of each FREE at its planes of points from the base to the tip, m, base frame.
    pub fn centrelines(&self, shape: &SolidShape) -> Vec<Vec<[f64; 3]>> {
        let tubes = self.frees.iter().zip(&shape.frees).map(|(free, state)| free.tube(state));
        tubes.map(|tube| tube.points.into_iter().map(Into::into).collect()).collect()
    }

    /// Undeformed FREEs under a plate at their mean length.
    pub(super) fn straight(&self) -> SolidShape {
        SolidShape {
            plate: Plate::at_height(self.height),
            frees: self.frees.iter().map(|free| free.solver.rest()).collect(),
            pressures: vec![0.0; self.frees.len()],
        }
    }
}
