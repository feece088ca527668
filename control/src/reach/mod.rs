//! The reachable set of a module's tip: all positions that pressures within the bounds reach.
//!
//! The map from pressures to position is taken as linear on small simplices of the box of pressures. Of four pressures, the images of
//! their faces of three dimensions fill the image of the box; what these cover of lines through a lattice, along x, y and z, gives the
//! volume, and where the lines leave it the true outer boundary, whether it comes from a face of the box or from pressures inside,
//! where the map is singular. Two errors, of the simplices and of the lattice, are both shown by halving them.

mod columns;
mod dexterity;
mod outline;
mod patch;
mod sideways;
mod surface;
#[cfg(test)]
mod tests;

pub use dexterity::Dexterity;
pub use outline::Segments;
pub use patch::Face;
pub use sideways::Sideways;
pub use surface::{Facet, Surface};

use crate::Bounds;
use columns::{Columns, Lattice};
use patch::{Patch, patches};
use rom::{OutOfDomain, PoseEvaluation, PoseModel};
use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicUsize, Ordering},
};

/// How finely a reachable set is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReachSettings {
    /// Steps along each pressure. Twice as many: a quarter of the error, sixteen times the time of four FREEs.
    pub steps: usize,
    /// Cells of the lattice along each axis.
    pub cells: usize,
    /// Threads; the result does not depend on them.
    pub jobs: usize,
}

impl ReachSettings {
    /// Whether these can be computed.
    ///
    /// # Errors
    /// [`ReachError::Setting`] with what can.
    pub fn check(&self, bounds: &Bounds) -> Result<(), ReachError> {
        let faces = patches(bounds, 1);
        let sides = faces.first().map_or(0, Patch::dimensions).max(1);
        let most = (MOST_NODES as f64 / faces.len().max(1) as f64).powf(1.0 / sides as f64) as usize - 1;
        for (what, given, least, most) in [
            ("steps of each pressure", self.steps, 1, most),
            ("cells of the lattice", self.cells, 2, MOST_CELLS),
        ] {
            if given < least || given > most {
                return Err(ReachError::Setting { what, given, least, most });
            }
        }
        Ok(())
    }
}

/// Told how far the work is and asked whether to go on.
pub struct ReachRun<'a> {
    /// Told of slices done and all.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
    /// Whether to stop.
    pub is_stopped: &'a (dyn Fn() -> bool + Sync),
}

/// Why there is no reachable set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReachError {
    /// The model has no answer at pressures within the bounds.
    #[error(transparent)]
    Outside(#[from] OutOfDomain),
    /// Too coarse or too fine.
    #[error("{what}: {given}; give {least} to {most}")]
    Setting {
        /// What was set.
        what: &'static str,
        /// To what.
        given: usize,
        /// Least that makes sense.
        least: usize,
        /// Greatest that can be computed.
        most: usize,
    },
    /// Stopped from outside.
    #[error("stopped")]
    Stopped,
    /// A thread broke down.
    #[error("a thread broke down")]
    Broken,
}

/// A set of less extent than this along an axis, as a share of its greatest, is flat.
const FLAT: f64 = 1e-6;
/// Most nodes of pressures on all faces, 32 bytes each.
const MOST_NODES: usize = 20_000_000;
/// Most cells of the lattice along an axis.
const MOST_CELLS: usize = 512;

/// The reachable set at one fineness.
#[derive(Clone, Debug)]
pub struct ReachableSet {
    /// Least and greatest x, y, z among the nodes, m.
    pub extent: [(f64, f64); 3],
    /// Spacing of the lattice along each axis, m.
    pub spacing: [f64; 3],
    /// Greatest distance from the z axis by direction; flat sets have none.
    pub sideways: Sideways,
    lattice: Lattice,
    /// None where the set is flat.
    columns: Option<[Columns; 3]>,
}

impl ReachableSet {
    /// Of a model within bounds; `make` gives every thread its own.
    ///
    /// # Errors
    /// [`ReachError`] where the settings make no sense, the model has no answer, or a stop was asked for.
    pub fn compute<M: PoseModel>(
        make: &(impl Fn() -> M + Sync),
        bounds: &Bounds,
        settings: ReachSettings,
        run: &ReachRun<'_>,
    ) -> Result<Self, ReachError> {
        let ReachSettings { steps, cells, jobs } = settings;
        settings.check(bounds)?;
        let sides = bounds.lower.iter().zip(&bounds.upper).filter(|(lower, upper)| upper > lower).count();
        let mut patches = patches(bounds, steps);
        let mut extent = [(f64::INFINITY, f64::NEG_INFINITY); 3];
        for patch in &mut patches {
            if (run.is_stopped)() {
                return Err(ReachError::Stopped);
            }
            patch.fill(make, bounds, jobs)?;
            for position in patch.positions() {
                for (ends, value) in extent.iter_mut().zip(position) {
                    *ends = (ends.0.min(*value), ends.1.max(*value));
                }
            }
        }
        let sizes = extent.map(|(low, high)| high - low);
        let greatest = sizes.iter().fold(0.0f64, |greatest, size| greatest.max(*size));
        let spacing = sizes.map(|size| size / cells as f64);
        let is_solid = sides >= 3 && sizes.iter().all(|size| *size > FLAT * greatest);
        if !is_solid {
            let lattice = Lattice { spacing, first: [0; 3], count: [0; 3] };
            return Ok(ReachableSet {
                extent,
                spacing,
                lattice,
                sideways: Sideways::default(),
                columns: None,
            });
        }
        let lattice = Lattice::around(extent, spacing);
        let (columns, sideways) = rasterise(&patches, lattice, jobs, run)?;
        Ok(ReachableSet { extent, spacing, sideways, lattice, columns: Some(columns) })
    }

    /// Whether it has no volume: fewer than three FREEs, or a tip guided on a plane or a line.
    pub fn is_flat(&self) -> bool {
        self.columns.is_none()
    }

    /// Volume (m^3): mean over lines along x, y and z.
    pub fn volume(&self) -> f64 {
        self.columns.as_ref().map_or(0.0, |columns| columns.iter().map(Columns::volume).sum::<f64>() / 3.0)
    }

    /// The outer boundary.
    pub fn surface(&self) -> Surface {
        self.columns.as_ref().map_or_else(Surface::default, |columns| Surface::of(columns, &self.lattice))
    }

    /// How many of positions lie in a cell of the lattice none of whose corners is in the set: missed by more than the lattice
    /// explains.
    pub fn count_missed<'a>(&self, positions: impl Iterator<Item = &'a [f64; 3]>) -> usize {
        let Some(columns) = &self.columns else { return 0 };
        let (inside, count) = (surface::inside(&columns[2], &self.lattice), self.lattice.count);
        let corner_inside = |position: &[f64; 3]| {
            let cell: [i64; 3] = std::array::from_fn(|axis| {
                (position[axis] / self.spacing[axis] - 0.5).floor() as i64 - self.lattice.first[axis]
            });
            (0..8).any(|corner: i64| {
                let at: [i64; 3] = std::array::from_fn(|axis| cell[axis] + (corner >> axis & 1));
                let known = at.iter().zip(count).all(|(at, count)| (0..count as i64).contains(at));
                let [i, j, k] = at.map(|at| at.max(0) as usize);
                known && inside[(i * count[1] + j) * count[2] + k]
            })
        };
        positions.filter(|position| !corner_inside(position)).count()
    }
}

/// What the images of all simplices cover along the three axes and how far they reach; slices of the patches are shared among threads.
fn rasterise(
    patches: &[Patch],
    lattice: Lattice,
    jobs: usize,
    run: &ReachRun<'_>,
) -> Result<([Columns; 3], Sideways), ReachError> {
    let slices: Vec<(&Patch, usize)> =
        patches.iter().flat_map(|patch| (0..patch.slices()).map(move |slice| (patch, slice))).collect();
    let empty = || ([0, 1, 2].map(|axis| Columns::new(axis, lattice)), Sideways::default());
    let (next, done, whole) = (AtomicUsize::new(0), AtomicUsize::new(0), Mutex::new(empty()));
    (run.progress)(0, slices.len());
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, slices.len().max(1)) {
            scope.spawn(|| {
                let mut own = empty();
                while let Some((patch, slice)) = slices.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if (run.is_stopped)() {
                        break;
                    }
                    patch.simplices(*slice, |nodes| {
                        own.0.iter_mut().for_each(|columns| columns.add(nodes));
                        own.1.add(nodes.map(|(position, _)| position));
                    });
                    (run.progress)(done.fetch_add(1, Ordering::Relaxed) + 1, slices.len());
                }
                let mut whole = whole.lock().unwrap_or_else(PoisonError::into_inner);
                whole.0.iter_mut().zip(&own.0).for_each(|(whole, own)| whole.join(own));
                whole.1.join(&own.1);
            });
        }
    });
    if done.into_inner() < slices.len() {
        return Err(ReachError::Stopped);
    }
    let mut whole = whole.into_inner().unwrap_or_else(PoisonError::into_inner);
    whole.0.iter_mut().for_each(Columns::finish);
    Ok(whole)
}

/// Evenly scattered pressures within bounds (Pa): what a set is checked with.
pub fn scattered_pressures(bounds: &Bounds, count: usize) -> Vec<Vec<f64>> {
    // Roberts's sequence: multiples of powers of the root of x^(d+1) = x + 1.
    let frees = bounds.lower.len();
    let root = (0..60).fold(1.5f64, |x, _| (1.0 + x).powf(1.0 / (frees + 1) as f64));
    let part = |n: usize, free: usize| (0.5 + n as f64 * root.powi(-(free as i32 + 1))).fract();
    let pressure =
        |n, free: usize| bounds.lower[free] + part(n, free) * (bounds.upper[free] - bounds.lower[free]);
    (1..=count).map(|n| (0..frees).map(|free| pressure(n, free)).collect()).collect()
}

/// Positions (m) of a model at pressures.
///
/// # Errors
/// [`OutOfDomain`] where it has no answer.
pub fn positions<M: PoseModel>(model: &M, pressures: &[Vec<f64>]) -> Result<Vec<[f64; 3]>, OutOfDomain> {
    let mut into = PoseEvaluation::new(model.domain().len(), 0);
    let position = |pressures: &Vec<f64>| {
        model.evaluate(pressures, &mut into)?;
        Ok(into.chart.to_pose().position.into())
    };
    pressures.iter().map(position).collect()
}
