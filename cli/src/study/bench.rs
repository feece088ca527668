use super::module_rods::Laws;
use crate::{exit::Exit, failure::Failure, interrupt, progress::Progress};
use actuator::units::KPA;
use fe::{Deformation, SolidError, SolidLoad, SolidMesh, SolidSolver, SolidState, Specimen};
use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicUsize, Ordering},
};

/// Where studies are computed: how finely, on how many threads, and who is told.
pub struct Bench {
    /// Coarse meshes and few states: for a look, not for numbers.
    pub coarse: bool,
    /// Modules as solids too, beside the rods.
    pub solids: bool,
    /// Threads.
    pub jobs: usize,
    /// Told of progress.
    pub progress: Progress,
    /// Laws of FREEs that studies of modules share.
    pub laws: Laws,
}

/// A body and the equilibria found on its way.
pub struct Inflated {
    /// Its solver.
    pub solver: SolidSolver,
    /// The state at the last stop.
    pub last: SolidState,
    /// Pressure (Pa) and state at each stop.
    pub states: Vec<(f64, SolidState)>,
    /// Pressure (Pa) and deformation at each stop.
    pub path: Vec<(f64, Deformation)>,
    /// Largest relative residual.
    pub residual: f64,
}

/// An error of the solid on its way to the user.
pub fn failure(error: SolidError) -> Failure {
    match error {
        SolidError::Stopped => Failure::interrupted(),
        other => Failure::new(Exit::NotConverged, other),
    }
}

impl Bench {
    /// `work` on every item, as many at a time as there are threads; the results in the items' order, or the first failure.
    pub fn each<T: Sync, R: Send>(
        &self,
        what: &str,
        items: &[T],
        work: impl Fn(&T) -> Result<R, Failure> + Sync,
    ) -> Result<Vec<R>, Failure> {
        self.progress.say(what);
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let failed = Mutex::new(None);
        let results: Vec<Mutex<Option<R>>> = items.iter().map(|_| Mutex::new(None)).collect();
        let lock = |place: &Mutex<Option<Failure>>, failure| {
            place.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
            next.store(items.len(), Ordering::Relaxed);
        };
        self.progress.at(0, items.len());
        std::thread::scope(|scope| {
            for _ in 0..self.jobs.clamp(1, items.len().max(1)) {
                scope.spawn(|| {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        let Some(item) = items.get(index) else { break };
                        if interrupt::is_asked() {
                            lock(&failed, Failure::interrupted());
                            break;
                        }
                        match work(item) {
                            Ok(result) => {
                                *results[index].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
                                self.progress.at(done.fetch_add(1, Ordering::Relaxed) + 1, items.len());
                            }
                            Err(failure) => lock(&failed, failure),
                        }
                    }
                });
            }
        });
        if let Some(failure) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(failure);
        }
        let found =
            results.into_iter().map(|place| place.into_inner().unwrap_or_else(PoisonError::into_inner));
        found.map(|result| result.ok_or_else(Failure::interrupted)).collect()
    }

    /// Inflates one sector of a body through rising pressures, Pa.
    pub fn inflate(
        &self,
        specimen: &Specimen,
        mesh: SolidMesh,
        pressures: &[f64],
    ) -> Result<Inflated, Failure> {
        let mut solver = SolidSolver::sector(specimen, mesh).map_err(failure)?;
        let rest = solver.rest();
        let mut states: Vec<(f64, SolidState)> = vec![];
        let last = solver
            .follow(&rest, 0.0, pressures, &SolidLoad::pressure, &mut |pressure, state| {
                states.push((pressure, state.clone()));
                !interrupt::is_asked()
            })
            .map_err(failure)?;
        let residual = states.iter().map(|(_, state)| state.residual()).fold(0.0, f64::max);
        let path = states.iter().map(|(pressure, state)| (*pressure, solver.deformation(state))).collect();
        Ok(Inflated { solver, last, states, path, residual })
    }
}

/// `count` equal steps to `greatest` kPa, in Pa.
pub fn steps(greatest_kpa: f64, count: usize) -> Vec<f64> {
    (1..=count).map(|i| KPA * greatest_kpa * i as f64 / count as f64).collect()
}

/// A mesh in words: elements around, along and through the wall.
pub fn mesh_name(mesh: SolidMesh) -> String {
    let under = match mesh.under_fibre {
        0 => String::new(),
        n => format!(", {} under each fibre", 2 * n),
    };
    format!("{} × {} × {}{under}", mesh.around, mesh.along, mesh.radial)
}
