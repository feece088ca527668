//! What all sweeps over the parameters of a FREE share, whatever computes the paths.

use crate::{Run, SectionError, Shard, SolidError};
use actuator::{
    Fidelity, FreeMap, FreeParameter, FreePath, LoadedFree, MapAxis, ParameterError,
    units::{DEG, KPA, MPA},
};
use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicUsize, Ordering},
};

/// Why a sweep cannot be begun.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FreeSweepError {
    /// An axis is empty, not rising, or holds a number that it must not hold.
    #[error("{axis}: {problem}")]
    Axis {
        /// Which axis.
        axis: String,
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
    /// A value of an axis is none that its parameter can have.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The FREE cannot be represented.
    #[error("the FREE at {:.2} deg from the hoop, {:.4} MPa: {source}", .node.free.winding.angle_from_hoop() / DEG, .node.free.elastomer.shear_modulus() / MPA)]
    Free {
        /// The FREE.
        node: Box<LoadedFree>,
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
    /// The FREE and its loads.
    pub node: LoadedFree,
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

fn check_axis(axis: &str, values: &[f64], unit: f64) -> Result<(), FreeSweepError> {
    let error = |problem| Err(FreeSweepError::Axis { axis: axis.to_owned(), problem });
    if values.is_empty() {
        return error("is empty; give at least one value".to_owned());
    }
    if let Some(value) = values.iter().find(|value| !value.is_finite()) {
        return error(format!("holds {value}, which is not a number"));
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

/// An empty map of a FREE over `axes` (SI) and pressures (Pa), all rising. Winding angle and shear modulus that are not among the
/// axes become axes of the FREE's own value; other axes of a single value are put into the FREE; zero pressure is added where it is
/// missing. `check` judges the FREEs at the corners.
pub(crate) fn empty_map(
    mut node: LoadedFree,
    mut axes: Vec<MapAxis>,
    mut pressures: Vec<f64>,
    (fidelity, settings): (Fidelity, String),
    source: (String, String),
    check: &dyn Fn(&LoadedFree) -> Result<(), PathError>,
) -> Result<FreeMap, FreeSweepError> {
    for (index, axis) in axes.iter().enumerate() {
        let name = axis.parameter.name();
        check_axis(name, &axis.values, axis.parameter.unit())?;
        if axes[..index].iter().any(|other| other.parameter == axis.parameter) {
            let problem = "is given twice; give all its values at once".to_owned();
            return Err(FreeSweepError::Axis { axis: name.to_owned(), problem });
        }
    }
    check_axis("pressures (kPa)", &pressures, KPA)?;
    if pressures[0] < 0.0 {
        let problem = format!("holds {}; a path rises from zero", pressures[0] / KPA);
        return Err(FreeSweepError::Axis { axis: "pressures (kPa)".to_owned(), problem });
    }
    if pressures[0] > 0.0 {
        pressures.insert(0, 0.0);
    }
    let mut always = Vec::new();
    for parameter in [FreeParameter::WindingAngle, FreeParameter::ShearModulus] {
        let values = match axes.iter().position(|axis| axis.parameter == parameter) {
            Some(place) => axes.remove(place).values,
            None => parameter.of(&node).into_iter().collect(),
        };
        always.push(MapAxis { parameter, values });
    }
    for axis in axes.iter().filter(|axis| axis.values.len() == 1) {
        node = axis.parameter.set(node, axis.values[0])?;
    }
    axes.retain(|axis| axis.values.len() > 1);
    axes.append(&mut always);
    let mut map =
        FreeMap { node, axes, pressures, paths: Vec::new(), checks: Vec::new(), fidelity, settings, source };
    for node in 0..map.node_count() {
        let coordinates = map.coordinates(node);
        let loaded = map.at(&coordinates)?;
        let ends = |axis: &MapAxis, value| axis.values.first() == value || axis.values.last() == value;
        if map.axes.iter().zip(&coordinates).all(|(axis, value)| ends(axis, Some(value))) {
            check(&loaded).map_err(|source| FreeSweepError::Free { node: Box::new(loaded), source })?;
        }
    }
    map.paths = vec![None; map.node_count()];
    Ok(map)
}

/// The FREEs of `checks` paths between the nodes; none where the map has a single node. Parameters that are whole numbers take the
/// values of nodes.
pub(crate) fn check_points(map: &FreeMap, checks: usize, seed: u64) -> Vec<LoadedFree> {
    if map.paths.len() < 2 {
        return Vec::new();
    }
    let mut state = seed;
    let mut next = || {
        let between = |axis: &MapAxis, state: &mut u64| match axis.parameter {
            FreeParameter::Fibres => {
                axis.values[(next_fraction(state) * axis.values.len() as f64) as usize % axis.values.len()]
            }
            _ => between_nodes(&axis.values, state),
        };
        // The last two axes first, as before there were others.
        let (named, always) = map.axes.split_at(map.axes.len() - 2);
        let always: Vec<f64> = always.iter().map(|axis| between(axis, &mut state)).collect();
        let mut coordinates: Vec<f64> = named.iter().map(|axis| between(axis, &mut state)).collect();
        coordinates.extend(always);
        map.at(&coordinates)
    };
    // What lies between values that a parameter can have is one, too.
    (0..checks).filter_map(|_| next().ok()).collect()
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
type FindPath<'a> =
    dyn Fn(&LoadedFree, &[f64], &mut Told<'_>) -> Result<FreePath, Option<PathError>> + Sync + 'a;

/// Told of each path that was found, in whatever order they are. A thread begins its next path when this has returned.
pub(crate) type Finished<'a> = dyn FnMut(&LoadedFree, &FreePath) + Send + 'a;

/// Computes the paths of the map (nodes, then checks) that are missing and belong to `shard`, each by `path` in at most
/// `steps_a_path` steps that it tells of. A path that ends in `Err(None)` was stopped on the way.
pub(crate) fn fill(
    map: &mut FreeMap,
    check_points: &[LoadedFree],
    shard: Shard,
    (run, steps_a_path): (&Run<'_>, usize),
    finished: &mut Finished<'_>,
    path: &FindPath<'_>,
) -> Result<FreeSweepReport, FreeSweepError> {
    let expected = map.node_count();
    if map.paths.len() != expected {
        return Err(FreeSweepError::Shape { expected, found: map.paths.len() });
    }
    let is_done = |row: usize| match row.checked_sub(expected) {
        None => map.paths[row].is_some(),
        Some(check) => map.checks.iter().any(|(node, _)| *node == check_points[check]),
    };
    let own: Vec<usize> = (0..expected + check_points.len()).filter(|row| shard.owns(*row)).collect();
    let rows: Vec<(usize, LoadedFree)> = own
        .iter()
        .filter(|row| !is_done(**row))
        .map(|&row| match row.checked_sub(expected) {
            None => Ok((row, map.at(&map.coordinates(row))?)),
            Some(check) => Ok((row, check_points[check])),
        })
        .collect::<Result<_, ParameterError>>()?;

    let (steps, already) = (steps_a_path * own.len(), steps_a_path * (own.len() - rows.len()));
    (run.progress)(already, steps);
    let pressures = map.pressures.clone();
    let (next, steps_done) = (AtomicUsize::new(0), AtomicUsize::new(already));
    let results = Mutex::new((map, FreeSweepReport { left: rows.len(), ..Default::default() }, finished));
    std::thread::scope(|scope| {
        for _ in 0..run.jobs.clamp(1, rows.len().max(1)) {
            scope.spawn(|| {
                while !run.is_stopped() {
                    let Some((row, node)) = rows.get(next.fetch_add(1, Ordering::Relaxed)) else {
                        break;
                    };
                    let mut told = Told { run, steps_done: &steps_done, steps, own: 0, most: steps_a_path };
                    let path = path(node, &pressures, &mut told);
                    let mut results = results.lock().unwrap_or_else(PoisonError::into_inner);
                    let (map, report, finished) = &mut *results;
                    match path {
                        Err(None) => break,
                        Err(Some(error)) => report.failed.push(FailedPath { node: *node, error }),
                        Ok(path) => {
                            finished(node, &path);
                            report.computed += 1;
                            match map.paths.get_mut(*row) {
                                Some(place) => *place = Some(path),
                                None => map.checks.push((*node, path)),
                            }
                        }
                    }
                    report.left -= 1;
                    drop(results);
                    told.finish();
                }
            });
        }
    });
    let (map, report, _) = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    // In the order of the points, whichever thread was first.
    let place = |node: &LoadedFree| check_points.iter().position(|point| point == node);
    map.checks.sort_by_key(|(node, _)| place(node));
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use actuator::{FreeState, PathEnd};
    use std::{collections::HashSet, sync::atomic::AtomicBool};

    /// A path made of nothing, for what does not depend on how it is found.
    fn made_up(node: &LoadedFree) -> FreePath {
        let state = FreeState {
            pressure: 0.0,
            axial_stretch: node.free.winding.angle_from_hoop(),
            expansion: 1.0,
            twist_per_length: 0.0,
            residual: 0.0,
            middle: None,
            section: None,
            mesh_error: None,
        };
        FreePath::solved(vec![state], PathEnd::Range)
    }

    #[test]
    fn a_thread_begins_no_path_before_its_last_one_was_told_of() {
        let angles = (20..80).map(|degrees| f64::from(degrees) * DEG).collect();
        let axes = MapAxis::of_angles_and_moduli(angles, vec![0.4e6]);
        let made_by = (Fidelity::Section, String::new());
        let free = crate::section::tests::free(30.0).into();
        let mut map = empty_map(free, axes, vec![0.0], made_by, Default::default(), &|_| Ok(())).unwrap();
        const JOBS: usize = 3;
        let (begun, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
        let run = Run { jobs: JOBS, progress: &|_, _| {}, stop: &stop };
        let mut told = HashSet::new();
        let report = fill(
            &mut map,
            &[],
            Shard::WHOLE,
            (&run, 1),
            &mut |node, path| {
                assert_eq!(*path, made_up(node));
                told.insert(node.free.winding.angle_from_hoop().to_bits());
                // Time for the others to run ahead, if they did.
                std::thread::sleep(std::time::Duration::from_micros(300));
                let begun = begun.load(Ordering::SeqCst);
                assert!(begun < told.len() + JOBS, "{begun} begun, {} told of", told.len());
            },
            &|node, _, _| {
                begun.fetch_add(1, Ordering::SeqCst);
                Ok(made_up(node))
            },
        );
        assert_eq!((report.unwrap().computed, told.len()), (60, 60));
        assert!(map.is_complete());
    }
}
