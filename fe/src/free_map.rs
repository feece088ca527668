use crate::{Run, SectionError, SectionMesh, SectionSolver, Shard};
use actuator::{Free, FreeMap, FreePath, units::DEG, units::KPA, units::MPA};
use std::sync::{
    atomic::{AtomicUsize, Ordering},
    mpsc,
};

/// How the map of a FREE is computed: a path of section states from rest to the limit point at each angle and modulus.
///
/// Every path is followed from rest on its own, so that the map depends neither on the number of threads nor on the sharding.
/// (Sections of equal EA/(mu B^2) are the same up to the unit of stress; the moduli of a map change that number, and a path
/// costs milliseconds, so each is solved.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FreeSweep {
    /// Mesh of the section.
    pub mesh: SectionMesh,
    /// States beside those at the pressures asked for: evenly spaced in s = 1 - sqrt(1 - p/p_limit), up to the limit point.
    pub extra_states: usize,
    /// Number of paths between the nodes, for a fit to be judged by.
    pub checks: usize,
    /// Chooses where the checks lie.
    pub seed: u64,
}

impl Default for FreeSweep {
    /// The default mesh, 24 states beside those asked for, 6 checks.
    fn default() -> Self {
        FreeSweep { mesh: SectionMesh::default(), extra_states: 24, checks: 6, seed: 1 }
    }
}

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
    Section {
        /// The FREE.
        free: Box<Free>,
        /// What is wrong with it.
        source: SectionError,
    },
}

/// A path that was not found; its node stays empty.
#[derive(Clone, Debug, PartialEq)]
pub struct FailedPath {
    /// The FREE.
    pub free: Free,
    /// Why.
    pub error: SectionError,
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
fn between_nodes(axis: &[f64], state: &mut u64) -> f64 {
    let (place, share) = (next_fraction(state), 0.25 + 0.5 * next_fraction(state));
    match axis.len() {
        1 => axis[0],
        nodes => {
            let interval = ((place * (nodes - 1) as f64) as usize).min(nodes - 2);
            axis[interval] + share * (axis[interval + 1] - axis[interval])
        }
    }
}

impl FreeSweep {
    /// An empty map of `free` over winding angles (rad from the hoop), shear moduli (Pa) and pressures (Pa), all rising; zero
    /// pressure is added where it is missing. `source` is name and text of the description.
    ///
    /// # Errors
    /// [`FreeSweepError`] where an axis or the FREE at one of its ends makes no sense.
    pub fn empty_map(
        &self,
        free: Free,
        winding_angles: Vec<f64>,
        shear_moduli: Vec<f64>,
        mut pressures: Vec<f64>,
        source: (String, String),
    ) -> Result<FreeMap, FreeSweepError> {
        check_axis("winding angles (deg)", &winding_angles, 0.0, DEG)?;
        check_axis("shear moduli (MPa)", &shear_moduli, f64::MIN_POSITIVE, MPA)?;
        check_axis("pressures (kPa)", &pressures, 0.0, KPA)?;
        if pressures[0] > 0.0 {
            pressures.insert(0, 0.0);
        }
        for angle in [winding_angles[0], winding_angles[winding_angles.len() - 1]] {
            let node = free.at(angle, shear_moduli[0]);
            SectionSolver::new(&node, self.mesh)
                .map_err(|source| FreeSweepError::Section { free: Box::new(node), source })?;
        }
        let nodes = winding_angles.len() * shear_moduli.len();
        Ok(FreeMap {
            free,
            winding_angles,
            shear_moduli,
            pressures,
            paths: vec![None; nodes],
            checks: Vec::new(),
            settings: self.settings(),
            source,
        })
    }

    /// The settings in words, as they stand in the map.
    pub fn settings(&self) -> String {
        let SectionMesh { radial, under_fibre, between_fibres } = self.mesh;
        format!(
            "section of half a fibre pitch, nine-node quadrilaterals with linear pressure, {radial} through the wall, \
             {under_fibre} under half a fibre, {between_fibres} beside it; {} states beside those asked for; \
             {} checks, seed {}",
            self.extra_states, self.checks, self.seed
        )
    }

    /// The FREEs of the checks, at angles and moduli between the nodes; none where the map has a single node.
    pub fn check_points(&self, map: &FreeMap) -> Vec<Free> {
        if map.paths.len() < 2 {
            return Vec::new();
        }
        let mut state = self.seed;
        let mut next = || {
            let angle = between_nodes(&map.winding_angles, &mut state);
            map.free.at(angle, between_nodes(&map.shear_moduli, &mut state))
        };
        (0..self.checks).map(|_| next()).collect()
    }

    /// Computes the paths of the map (nodes, then checks) that are missing and belong to `shard`.
    ///
    /// `checkpoint` is called with the map after each new path, from the calling thread. A stop asked for by `run` takes effect
    /// after the paths being followed. Paths that cannot be followed are reported, and their nodes stay empty.
    ///
    /// # Errors
    /// [`FreeSweepError::Shape`] where the map does not fit its own axes.
    pub fn fill(
        &self,
        map: &mut FreeMap,
        shard: Shard,
        run: &Run<'_>,
        checkpoint: &mut dyn FnMut(&FreeMap),
    ) -> Result<FreeSweepReport, FreeSweepError> {
        let moduli = map.shear_moduli.len();
        let expected = map.winding_angles.len() * moduli;
        if map.paths.len() != expected {
            return Err(FreeSweepError::Shape { expected, found: map.paths.len() });
        }
        let check_points = self.check_points(map);
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
        let next = AtomicUsize::new(0);
        let (sender, receiver) = mpsc::channel::<(usize, Free, Result<FreePath, SectionError>)>();
        let mut report = FreeSweepReport::default();
        std::thread::scope(|scope| {
            for _ in 0..run.jobs.clamp(1, rows.len().max(1)) {
                let (sender, next, rows, pressures) = (sender.clone(), &next, &rows, &pressures);
                scope.spawn(move || {
                    while !run.is_stopped() {
                        let Some(&(row, free)) = rows.get(next.fetch_add(1, Ordering::Relaxed)) else {
                            break;
                        };
                        let path = SectionSolver::new(&free, self.mesh)
                            .and_then(|mut solver| solver.path(pressures, self.extra_states));
                        // The receiver outlives the scope; were it gone, there would be nobody to compute for.
                        if sender.send((row, free, path)).is_err() {
                            break;
                        }
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
                (run.progress)(done, rows.len());
            }
            report.left = rows.len() - done;
        });
        // In the order of the points, whichever thread was first.
        let place = |free: &Free| check_points.iter().position(|point| point == free);
        map.checks.sort_by_key(|(free, _)| place(free));
        Ok(report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::tests::free;
    use actuator::PathEnd;
    use std::sync::{Mutex, atomic::AtomicBool};

    const SWEEP: FreeSweep = FreeSweep {
        mesh: SectionMesh { radial: 1, under_fibre: 1, between_fibres: 2 },
        extra_states: 5,
        checks: 3,
        seed: 7,
    };

    fn empty() -> FreeMap {
        let angles = [20.0, 40.0, 70.0].map(f64::to_radians).to_vec();
        let pressures = (0..=6).map(|i| 1e4 * f64::from(i)).collect();
        SWEEP.empty_map(free(30.0), angles, vec![0.2e6, 0.393e6], pressures, Default::default()).unwrap()
    }

    fn fill(map: &mut FreeMap, shard: Shard, jobs: usize) -> FreeSweepReport {
        let run = Run { jobs, progress: &|_, _| {}, stop: &AtomicBool::new(false) };
        SWEEP.fill(map, shard, &run, &mut |_| {}).unwrap()
    }

    fn whole() -> FreeMap {
        let mut map = empty();
        let report = fill(&mut map, Shard::WHOLE, 2);
        assert_eq!((report.computed, report.left, report.failed.len()), (9, 0, 0));
        map
    }

    #[test]
    fn paths_hold_what_was_asked_for_and_end_in_their_limit_points() {
        let map = whole();
        assert!(map.is_complete());
        for path in map.paths.iter().flatten().chain(map.checks.iter().map(|(_, path)| path)) {
            assert_eq!(path.end, PathEnd::LimitPoint);
            let limit = path.limit_pressure().unwrap();
            assert_eq!(path.states[0].pressure, 0.0);
            assert!(path.states.windows(2).all(|pair| pair[1].pressure > pair[0].pressure));
            assert!(path.states.iter().all(|state| state.residual < 1e-8));
            for pressure in map.pressures.iter().filter(|pressure| **pressure < limit) {
                assert!(path.states.iter().any(|state| (state.pressure - pressure).abs() < 1e-9 * limit));
            }
            for share in 1..=5 {
                let pressure = limit * (1.0 - (1.0 - f64::from(share) / 6.0).powi(2));
                assert!(path.states.iter().any(|state| (state.pressure - pressure).abs() < 2e-9 * limit));
            }
        }
        // Softer rubber and steeper fibres give way earlier.
        let limit = |i, j| map.path(i, j).unwrap().limit_pressure().unwrap();
        assert!(limit(0, 0) < limit(0, 1) && limit(1, 1) < limit(0, 1) && limit(2, 1) < limit(1, 1));
    }

    #[test]
    fn shards_make_the_same_map_as_one_run_and_finished_paths_are_kept() {
        let whole = whole();
        let mut parts = empty();
        for index in 0..2 {
            fill(&mut parts, Shard { index, count: 2 }, 1);
        }
        assert_eq!(parts, whole);
        assert_eq!(fill(&mut parts, Shard::WHOLE, 1).computed, 0);
    }

    #[test]
    fn checks_lie_between_the_nodes() {
        let map = empty();
        let points = SWEEP.check_points(&map);
        assert_eq!(points.len(), 3);
        for point in points {
            let (angle, modulus) = (point.winding.angle_from_hoop(), point.elastomer.shear_modulus());
            assert!(angle > map.winding_angles[0] && angle < map.winding_angles[2]);
            assert!(map.winding_angles.iter().all(|node| (node - angle).abs() > 0.05));
            assert!(modulus > 0.24e6 && modulus < 0.35e6);
        }
    }

    #[test]
    fn a_stop_keeps_what_is_finished() {
        let (stop, saved, told) = (AtomicBool::new(false), Mutex::new(0), Mutex::new(Vec::new()));
        let run =
            Run { jobs: 1, progress: &|done, total| told.lock().unwrap().push((done, total)), stop: &stop };
        let mut map = empty();
        let report = SWEEP
            .fill(&mut map, Shard::WHOLE, &run, &mut |map: &FreeMap| {
                *saved.lock().unwrap() = map.paths.iter().flatten().count();
                stop.store(true, Ordering::Relaxed);
            })
            .unwrap();
        assert!(report.left > 0 && report.computed + report.left == 9, "{report:?}");
        assert_eq!(*saved.lock().unwrap(), report.computed);
        assert_eq!(told.lock().unwrap()[0], (1, 9));
    }

    #[test]
    fn unusable_axes_are_refused_with_the_numbers() {
        let make = |angles: &[f64], moduli: &[f64], pressures: &[f64]| {
            let angles = angles.iter().map(|angle| angle * DEG).collect();
            SWEEP
                .empty_map(free(30.0), angles, moduli.to_vec(), pressures.to_vec(), Default::default())
                .map(|map| map.pressures)
                .map_err(|error| error.to_string())
        };
        assert_eq!(make(&[30.0], &[1e6], &[1e4]), Ok(vec![0.0, 1e4]));
        let falling = make(&[30.0], &[1e6, 0.5e6], &[0.0]).unwrap_err();
        assert_eq!(falling, "shear moduli (MPa): must rise, but 0.5 follows 1");
        assert!(make(&[], &[1e6], &[0.0]).unwrap_err().contains("winding angles (deg): is empty"));
        assert!(make(&[30.0], &[1e6], &[-1e3]).unwrap_err().contains("holds -1,"));
        assert!(make(&[30.0], &[f64::NAN], &[0.0]).unwrap_err().contains("holds NaN"));
        assert!(make(&[0.5, 20.0], &[1e6], &[0.0]).unwrap_err().contains("0.50 deg from the hoop"));
    }
}
