//! What all sweeps over winding angle and shear modulus share, whatever computes the paths.

use crate::{Run, SectionError, Shard, SolidError};
use actuator::{Fidelity, Free, FreeMap, FreePath, units::DEG, units::KPA, units::MPA};
use std::sync::{
    atomic::{AtomicUsize, Ordering},
    mpsc,
};

/// Why a sweep cannot be begun.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FreeSweepError {
    /// An axis is empty, not rising, or holds a number that it must not hold.
    #[error("{axis}: {problem}")]
    Axis {
        /// Which axis.
        axis: &'static str,
        /// What is wrong and what is wanted.
        problem: String,
    },
    /// The map's nodes are not those of its axes.
    #[error("the map holds {found} paths, but its axes have {expected} nodes: make it again")]
    Shape {
        /// Angles times moduli.
        expected: usize,
        /// Paths.
        found: usize,
    },
    /// The FREE cannot be represented.
    #[error("the FREE at {:.2} deg from the hoop, {:.4} MPa: {source}", .free.winding.angle_from_hoop() / DEG, .free.elastomer.shear_modulus() / MPA)]
    Free {
        /// The FREE.
        free: Box<Free>,
        /// What is wrong with it.
        source: PathError,
    },
}

/// Why a path was not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PathError {
    /// As a section.
    #[error(transparent)]
    Section(#[from] SectionError),
    /// As a solid.
    #[error(transparent)]
    Solid(#[from] SolidError),
}

/// A path that was not found; its node stays empty.
#[derive(Clone, Debug, PartialEq)]
pub struct FailedPath {
    /// The FREE.
    pub free: Free,
    /// Why.
    pub error: PathError,
}

/// What a sweep did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FreeSweepReport {
    /// Paths computed now.
    pub computed: usize,
    /// Paths that were to be computed but are not, because a stop was asked for.
    pub left: usize,
    /// Paths that were not found.
    pub failed: Vec<FailedPath>,
}

fn check_axis(axis: &'static str, values: &[f64], least: f64, unit: f64) -> Result<(), FreeSweepError> {
    let error = |problem| Err(FreeSweepError::Axis { axis, problem });
    if values.is_empty() {
        return error("is empty; give at least one value".to_owned());
    }
    if let Some(value) = values.iter().find(|value| !(value.is_finite() && **value >= least)) {
        return error(format!("holds {}, which is not a number of at least {}", value / unit, least / unit));
    }
    match values.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => error(format!("must rise, but {} follows {}", pair[1] / unit, pair[0] / unit)),
        None => Ok(()),
    }
}

/// Next number of the generator splitmix64 as a fraction in [0, 1): the same on every machine.
pub(crate) fn next_fraction(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// A value well between two neighbouring nodes of an axis; the node itself where there is only one.
pub(crate) fn between_nodes(axis: &[f64], state: &mut u64) -> f64 {
    let (place, share) = (next_fraction(state), 0.25 + 0.5 * next_fraction(state));
    match axis.len() {
        1 => axis[0],
        nodes => {
            let interval = ((place * (nodes - 1) as f64) as usize).min(nodes - 2);
            axis[interval] + share * (axis[interval + 1] - axis[interval])
        }
    }
}

/// An empty map of `free` over winding angles (rad from the hoop), shear moduli (Pa) and pressures (Pa), all rising; zero
/// pressure is added where it is missing. `check` judges the FREEs at both ends of the angles.
pub(crate) fn empty_map(
    free: Free,
    [winding_angles, shear_moduli, mut pressures]: [Vec<f64>; 3],
    (fidelity, settings): (Fidelity, String),
    source: (String, String),
    check: &dyn Fn(&Free) -> Result<(), PathError>,
) -> Result<FreeMap, FreeSweepError> {
    check_axis("winding angles (deg)", &winding_angles, 0.0, DEG)?;
    check_axis("shear moduli (MPa)", &shear_moduli, f64::MIN_POSITIVE, MPA)?;
    check_axis("pressures (kPa)", &pressures, 0.0, KPA)?;
    if pressures[0] > 0.0 {
        pressures.insert(0, 0.0);
    }
    for angle in [winding_angles[0], winding_angles[winding_angles.len() - 1]] {
        let node = free.at(angle, shear_moduli[0]);
        check(&node).map_err(|source| FreeSweepError::Free { free: Box::new(node), source })?;
    }
    let nodes = winding_angles.len() * shear_moduli.len();
    Ok(FreeMap {
        free,
        winding_angles,
        shear_moduli,
        pressures,
        paths: vec![None; nodes],
        checks: Vec::new(),
        fidelity,
        settings,
        source,
    })
}

/// The FREEs of `checks` paths at angles and moduli between the nodes; none where the map has a single node.
pub(crate) fn check_points(map: &FreeMap, checks: usize, seed: u64) -> Vec<Free> {
    if map.paths.len() < 2 {
        return Vec::new();
    }
    let mut state = seed;
    let mut next = || {
        let angle = between_nodes(&map.winding_angles, &mut state);
        map.free.at(angle, between_nodes(&map.shear_moduli, &mut state))
    };
    (0..checks).map(|_| next()).collect()
}

/// How far a path has come: told by whatever computes it.
pub(crate) struct Told<'a> {
    run: &'a Run<'a>,
    steps_done: &'a AtomicUsize,
    steps: usize,
    own: usize,
    most: usize,
}

impl Told<'_> {
    /// One step of the path is done. Whether to go on.
    pub fn step(&mut self) -> bool {
        if self.own < self.most {
            self.own += 1;
            let done = self.steps_done.fetch_add(1, Ordering::Relaxed) + 1;
            (self.run.progress)(done, self.steps);
        }
        !self.run.is_stopped()
    }

    /// The path is done: its steps that were not needed are too.
    fn finish(mut self) {
        while self.own < self.most {
            self.step();
        }
    }
}

/// Finds the path of a FREE through pressures.
type FindPath<'a> = dyn Fn(&Free, &[f64], &mut Told<'_>) -> Result<FreePath, Option<PathError>> + Sync + 'a;

/// Computes the paths of the map (nodes, then checks) that are missing and belong to `shard`, each by `path` in at most
/// `steps_a_path` steps that it tells of. A path that ends in `Err(None)` was stopped on the way.
pub(crate) fn fill(
    map: &mut FreeMap,
    check_points: &[Free],
    shard: Shard,
    (run, steps_a_path): (&Run<'_>, usize),
    checkpoint: &mut dyn FnMut(&FreeMap),
    path: &FindPath<'_>,
) -> Result<FreeSweepReport, FreeSweepError> {
    let moduli = map.shear_moduli.len();
    let expected = map.winding_angles.len() * moduli;
    if map.paths.len() != expected {
        return Err(FreeSweepError::Shape { expected, found: map.paths.len() });
    }
    let is_done = |row: usize| match row.checked_sub(expected) {
        None => map.paths[row].is_some(),
        Some(check) => map.checks.iter().any(|(free, _)| *free == check_points[check]),
    };
    let rows: Vec<(usize, Free)> = (0..expected + check_points.len())
        .filter(|row| shard.owns(*row) && !is_done(*row))
        .map(|row| match row.checked_sub(expected) {
            None => (row, map.free.at(map.winding_angles[row / moduli], map.shear_moduli[row % moduli])),
            Some(check) => (row, check_points[check]),
        })
        .collect();

    let pressures = map.pressures.clone();
    let (next, steps_done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let (sender, receiver) = mpsc::channel::<(usize, Free, Result<FreePath, PathError>)>();
    let mut report = FreeSweepReport::default();
    std::thread::scope(|scope| {
        for _ in 0..run.jobs.clamp(1, rows.len().max(1)) {
            let (sender, next, rows, pressures, steps_done) =
                (sender.clone(), &next, &rows, &pressures, &steps_done);
            scope.spawn(move || {
                while !run.is_stopped() {
                    let Some(&(row, free)) = rows.get(next.fetch_add(1, Ordering::Relaxed)) else {
                        break;
                    };
                    let steps = steps_a_path * rows.len();
                    let mut told = Told { run, steps_done, steps, own: 0, most: steps_a_path };
                    let path = match path(&free, pressures, &mut told) {
                        Err(None) => break,
                        Err(Some(error)) => Err(error),
                        Ok(path) => Ok(path),
                    };
                    // The receiver outlives the scope; were it gone, there would be nobody to compute for.
                    if sender.send((row, free, path)).is_err() {
                        break;
                    }
                    told.finish();
                }
            });
        }
        drop(sender);
        let mut done = 0;
        for (row, free, path) in &receiver {
            done += 1;
            match path {
                Ok(path) => {
                    report.computed += 1;
                    match map.paths.get_mut(row) {
                        Some(node) => *node = Some(path),
                        None => map.checks.push((free, path)),
                    }
                    checkpoint(map);
                }
                Err(error) => report.failed.push(FailedPath { free, error }),
            }
        }
        report.left = rows.len() - done;
    });
    // In the order of the points, whichever thread was first.
    let place = |free: &Free| check_points.iter().position(|point| point == free);
    map.checks.sort_by_key(|(free, _)| place(free));
    Ok(report)
}
