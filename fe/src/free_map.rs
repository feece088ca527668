pub(crate) use crate::free_sweep::next_fraction;
use crate::{
    FreeSweepError, FreeSweepReport, PathError, PathRequest, Run, SectionError, SectionMesh, SectionSolver,
    Shard, free_sweep,
};
use actuator::{Fidelity, FreeMap, FreePath, LoadedFree, MapAxis};

/// How the map of a FREE is computed: a path of section states from rest to the limit point at each angle and modulus.
///
/// Every path is followed from rest on its own, so that the map depends neither on the number of threads nor on the sharding.
/// (Sections of equal EA/(mu B^2) are the same up to the unit of stress; the moduli of a map change that number, and a path
/// costs milliseconds, so each is solved.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeSweep {
    /// Mesh of the section.
    pub mesh: SectionMesh,
    /// States beside those at the pressures asked for: evenly spaced in s = 1 - sqrt(1 - p/p_limit), up to the limit point.
    pub extra_states: usize,
    /// States are added where the cubic in s through four neighbouring ones misses by more than this share of the greatest change
    /// of stretch, expansion or twist along the path; `None`: nowhere.
    pub interpolation_tolerance: Option<f64>,
    /// Where given, paths go on past the limit point, up to this multiple of the enclosed volume there.
    pub beyond_limit: Option<f64>,
    /// Whether each path is solved on two coarser meshes as well, for an estimate of its errors. A mesh with an odd number of
    /// elements some way cannot be halved, and there is no estimate.
    pub estimate_errors: bool,
    /// Number of paths between the nodes, for a fit to be judged by.
    pub checks: usize,
    /// Chooses where the checks lie.
    pub seed: u64,
}

impl Default for FreeSweep {
    /// The default mesh with estimates of its errors, 24 states beside those asked for and more where a cubic misses by 1e-5, nothing
    /// beyond the limit, 6 checks.
    fn default() -> Self {
        FreeSweep {
            mesh: SectionMesh::default(),
            extra_states: 24,
            interpolation_tolerance: Some(1e-5),
            beyond_limit: None,
            estimate_errors: true,
            checks: 6,
            seed: 1,
        }
    }
}

impl FreeSweep {
    /// An empty map of a FREE over `axes` (SI) and pressures (Pa), all rising. Winding angle and shear modulus that are not among the
    /// axes become axes of the FREE's own value; other axes of a single value are put into the FREE; zero pressure is added where it
    /// is missing. `source` is name and text of the description.
    ///
    /// # Errors
    /// [`FreeSweepError`] where an axis or the FREE at one of the corners makes no sense.
    pub fn empty_map(
        &self,
        node: LoadedFree,
        axes: Vec<MapAxis>,
        pressures: Vec<f64>,
        source: (String, String),
    ) -> Result<FreeMap, FreeSweepError> {
        let made_by = (Fidelity::Section, self.settings());
        free_sweep::empty_map(node, axes, pressures, made_by, source, &|node| {
            Ok(SectionSolver::new(&node.free, self.mesh).map(|_| ())?)
        })
    }

    /// The settings in words, as they stand in the map.
    pub fn settings(&self) -> String {
        let SectionMesh { radial, under_fibre, between_fibres } = self.mesh;
        let errors = if self.estimate_errors && self.mesh.coarsened().is_some() {
            "errors estimated from half as many elements; "
        } else {
            ""
        };
        let resolved = self.interpolation_tolerance.map_or_else(String::new, |tolerance| {
            format!(", more where a cubic misses by {tolerance:e} of the path's change")
        });
        let beyond = self.beyond_limit.map_or_else(String::new, |ratio| {
            format!(", beyond the limit to {ratio} times the volume there")
        });
        format!(
            "section of half a fibre pitch, nine-node quadrilaterals with linear pressure, {radial} through the wall, \
             {under_fibre} under half a fibre, {between_fibres} beside it; {errors}{} states beside those asked \
             for{resolved}{beyond}; {} checks, seed {}",
            self.extra_states, self.checks, self.seed
        )
    }

    /// The FREEs of the checks, between the nodes; none where the map has a single node.
    pub fn check_points(&self, map: &FreeMap) -> Vec<LoadedFree> {
        free_sweep::check_points(map, self.checks, self.seed)
    }

    /// Computes the paths of the map (nodes, then checks) that are missing and belong to `shard`.
    ///
    /// `finished` is told each path that was found, from the thread that found it, which then begins another: no more paths than
    /// there are threads are begun and not told of. Progress is told in paths, those that the map held already among them. A stop
    /// asked for by `run` takes effect after the paths being followed. Paths that cannot be followed are reported, and their nodes
    /// stay empty.
    ///
    /// # Errors
    /// [`FreeSweepError::Shape`] where the map does not fit its own axes.
    pub fn fill(
        &self,
        map: &mut FreeMap,
        shard: Shard,
        run: &Run<'_>,
        finished: &mut (dyn FnMut(&LoadedFree, &FreePath) + Send),
    ) -> Result<FreeSweepReport, FreeSweepError> {
        let check_points = self.check_points(map);
        free_sweep::fill(map, &check_points, shard, (run, 1), finished, &|node, pressures, _| {
            self.path(node, pressures).map_err(|error| Some(PathError::Section(error)))
        })
    }

    /// The path of one FREE through pressures (Pa, rising, the first zero).
    ///
    /// # Errors
    /// [`SectionError`] where there is no such section or the path is lost.
    pub fn path(&self, node: &LoadedFree, pressures: &[f64]) -> Result<FreePath, SectionError> {
        let request = PathRequest {
            load: node.load,
            pressures,
            extra_states: self.extra_states,
            interpolation_tolerance: self.interpolation_tolerance,
            beyond_limit: self.beyond_limit,
            estimate_errors: self.estimate_errors,
        };
        SectionSolver::new(&node.free, self.mesh)?.free_path(&request)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::tests::free;
    use actuator::{PathEnd, units::DEG};
    use std::sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
    };

    const SWEEP: FreeSweep = FreeSweep {
        mesh: SectionMesh { radial: 1, under_fibre: 1, between_fibres: 2 },
        extra_states: 5,
        interpolation_tolerance: None,
        beyond_limit: None,
        estimate_errors: false,
        checks: 3,
        seed: 7,
    };

    fn axes(angles: &[f64], moduli: &[f64]) -> Vec<MapAxis> {
        let angles: Vec<f64> = angles.iter().map(|angle| angle * DEG).collect();
        MapAxis::of_angles_and_moduli(angles, moduli.to_vec())
    }

    fn empty() -> FreeMap {
        let pressures = (0..=6).map(|i| 1e4 * f64::from(i)).collect();
        let axes = axes(&[20.0, 40.0, 70.0], &[0.2e6, 0.393e6]);
        SWEEP.empty_map(free(30.0).into(), axes, pressures, Default::default()).unwrap()
    }

    fn fill(map: &mut FreeMap, shard: Shard, jobs: usize) -> FreeSweepReport {
        let run = Run { jobs, progress: &|_, _| {}, stop: &AtomicBool::new(false) };
        SWEEP.fill(map, shard, &run, &mut |_, _| {}).unwrap()
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
        for LoadedFree { free: point, .. } in points {
            let (angle, modulus) = (point.winding.angle_from_hoop(), point.elastomer.shear_modulus());
            assert!(angle > map.winding_angles()[0] && angle < map.winding_angles()[2]);
            assert!(map.winding_angles().iter().all(|node| (node - angle).abs() > 0.05));
            assert!(modulus > 0.24e6 && modulus < 0.35e6);
        }
    }

    #[test]
    fn a_default_sweep_fills_in_evidence_and_constants_and_beyond_the_limit_where_asked() {
        let sweep = FreeSweep { extra_states: 5, checks: 1, beyond_limit: Some(1.2), ..FreeSweep::default() };
        let axes = axes(&[30.0, 60.0], &[0.393e6]);
        let mut map = sweep.empty_map(free(30.0).into(), axes, vec![0.0, 20e3], Default::default()).unwrap();
        let told = "errors estimated from half as many elements; 5 states beside those asked for, more where a cubic misses by 1e-5 of \
                    the path's change, beyond the limit to 1.2 times the volume there";
        assert!(map.settings.contains(told), "{}", map.settings);
        let run = Run { jobs: 1, progress: &|_, _| {}, stop: &AtomicBool::new(false) };
        sweep.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| {}).unwrap();
        for path in map.paths.iter().flatten().chain(map.checks.iter().map(|(_, path)| path)) {
            assert!(path.limit_error.is_some_and(|error| error > 0.0));
            assert!(path.states.iter().all(|state| state.section.is_some() && state.mesh_error.is_some()));
            assert!(
                path.states.len() > 8,
                "5 states, those asked for and those put between: {}",
                path.states.len()
            );
            assert_eq!(path.beyond.len(), 4);
        }
    }

    #[test]
    fn a_stop_keeps_what_is_finished() {
        let (stop, told) = (AtomicBool::new(false), Mutex::new(Vec::new()));
        let run =
            Run { jobs: 1, progress: &|done, total| told.lock().unwrap().push((done, total)), stop: &stop };
        let (mut map, mut saved) = (empty(), vec![]);
        let report = SWEEP
            .fill(&mut map, Shard::WHOLE, &run, &mut |node: &LoadedFree, path: &FreePath| {
                saved.push((*node, path.clone()));
                stop.store(true, Ordering::Relaxed);
            })
            .unwrap();
        assert_eq!((report.computed, report.left), (1, 8));
        assert_eq!(saved, [(map.at(&map.coordinates(0)).unwrap(), map.paths[0].clone().unwrap())]);
        assert_eq!(std::mem::take(&mut *told.lock().unwrap()), [(0, 9), (1, 9)]);
        // What is there already counts.
        stop.store(false, Ordering::Relaxed);
        SWEEP.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| stop.store(true, Ordering::Relaxed)).unwrap();
        assert_eq!(*told.lock().unwrap(), [(1, 9), (2, 9)]);
    }

    #[test]
    fn unusable_axes_are_refused_with_the_numbers() {
        let make = |angles: &[f64], moduli: &[f64], pressures: &[f64]| {
            SWEEP
                .empty_map(free(30.0).into(), axes(angles, moduli), pressures.to_vec(), Default::default())
                .map(|map| map.pressures)
                .map_err(|error| error.to_string())
        };
        assert_eq!(make(&[30.0], &[1e6], &[1e4]), Ok(vec![0.0, 1e4]));
        let falling = make(&[30.0], &[1e6, 0.5e6], &[0.0]).unwrap_err();
        assert_eq!(falling, "shear_modulus_mpa: must rise, but 0.5 follows 1");
        assert!(make(&[], &[1e6], &[0.0]).unwrap_err().contains("winding_angle_deg: is empty"));
        assert!(make(&[30.0], &[1e6], &[-1e3]).unwrap_err().contains("holds -1;"));
        assert!(make(&[30.0], &[f64::NAN], &[0.0]).unwrap_err().contains("holds NaN"));
        assert!(make(&[0.5, 20.0], &[1e6], &[0.0]).unwrap_err().contains("0.50 deg from the hoop"));
    }
}
