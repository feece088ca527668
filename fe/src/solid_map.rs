use crate::{
    FreeSweepError, FreeSweepReport, PathError, Run, SectionMesh, SectionSolver, Shard, SolidError,
    SolidMesh, SolidSolver, SolidState, Specimen, free_sweep,
};
use actuator::{Fidelity, Free, FreeMap, FreePath, FreeState, LoadedFree, MapAxis, units::DEG};

/// Least number of elements along: the middle fifth of the tube must hold two.
const LEAST_ALONG: usize = 10;
/// Least number of elements around; four for each fibre if that is more.
const LEAST_AROUND: usize = 24;
/// Elements through the wall. One, with two around for each fibre, costs 2 % of the twist at low pressures, where fibres press into
/// the wall.
const RADIAL: usize = 2;

/// How the map of a FREE is computed by solids: whole tubes between rigid caps, each followed from rest through the pressures asked
/// for, as far as its limit point.
///
/// States are those of the whole from cap to cap, with what the middle does beside them. Paths are followed each from rest on its
/// own, so that the map depends neither on the number of threads nor on the sharding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolidSweep {
    /// Elements through the wall, around and along; `None` for [`SolidSweep::usual_mesh`].
    pub elements: Option<[u32; 3]>,
    /// Number of paths between the nodes, for a fit to be judged by.
    pub checks: usize,
    /// Chooses where the checks lie.
    pub seed: u64,
}

impl Default for SolidSweep {
    /// The usual mesh, 2 checks.
    fn default() -> Self {
        SolidSweep { elements: None, checks: 2, seed: 1 }
    }
}

impl SolidSweep {
    /// Two elements through the wall, four around for each fibre (at least 24 in all, an even number for each), and as many along that an element is no longer than
    /// 0.26 outer radii along the tube and 0.76 along a fibre.
    pub fn usual_mesh(free: &Free) -> SolidMesh {
        let fibres = free.winding.fibres.max(1) as usize;
        let around = SolidMesh::around(free, LEAST_AROUND).max(4 * fibres);
        let longest = SolidMesh::longest_element(free);
        // In fives, so that nodes lie at the ends of the middle fifth.
        let along = 5 * (free.tube.length / (5.0 * longest)).ceil().min(1e6) as usize;
        SolidMesh { radial: RADIAL, ..SolidMesh::new(around, along.max(LEAST_ALONG)) }
    }

    /// The mesh of a FREE.
    pub fn mesh(&self, free: &Free) -> SolidMesh {
        match self.elements {
            None => Self::usual_mesh(free),
            Some(elements) => SolidMesh::of_elements(elements),
        }
    }

    /// The solid that stands for a FREE: one sector of it, from one fibre to the next, which under pressure alone moves as the whole
    /// does as long as that stays straight.
    ///
    /// # Errors
    /// [`SolidError`] where FREE or mesh make no sense.
    pub fn solver(&self, free: &Free) -> Result<SolidSolver, SolidError> {
        let (specimen, mesh) = (Specimen::from(free), self.mesh(free));
        match free.winding.fibres {
            0 | 1 => SolidSolver::new(&specimen, mesh),
            _ => SolidSolver::sector(&specimen, mesh),
        }
    }

    /// An empty map; see [`crate::FreeSweep::empty_map`].
    ///
    /// # Errors
    /// [`FreeSweepError`] where an axis, the mesh or the FREE at one of the ends makes no sense.
    pub fn empty_map(
        &self,
        node: LoadedFree,
        axes: Vec<MapAxis>,
        pressures: Vec<f64>,
        source: (String, String),
    ) -> Result<FreeMap, FreeSweepError> {
        let made_by = (Fidelity::Solid { elements: self.elements }, String::new());
        let mut map = free_sweep::empty_map(node, axes, pressures, made_by, source, &|node| {
            Ok(self.solver(&node.free).map(|_| ())?)
        })?;
        map.settings = self.settings(&map.node.free, map.winding_angles());
        Ok(map)
    }

    /// The settings in words, as they stand in the map.
    pub fn settings(&self, free: &Free, winding_angles: &[f64]) -> String {
        let solid = self.solid_in_words(free, winding_angles);
        format!("{solid}; {} checks, seed {}", self.checks, self.seed)
    }

    /// The solids in words.
    pub(crate) fn solid_in_words(&self, free: &Free, winding_angles: &[f64]) -> String {
        let mut along: Vec<(f64, SolidMesh)> =
            winding_angles.iter().map(|&angle| (angle, self.mesh(&free.at(angle, 1.0)))).collect();
        along.dedup_by(|next, before| next.1 == before.1);
        let meshes: Vec<String> = along
            .iter()
            .map(|(angle, mesh)| {
                let from =
                    if along.len() > 1 { format!(" from {:.4} deg", angle / DEG) } else { String::new() };
                format!("{} x {} x {}{from}", mesh.radial, mesh.around, mesh.along)
            })
            .collect();
        let bulk_ratio = Specimen::from(free).bulk_ratio;
        format!(
            "solid between rigid caps, from one fibre to the next, 27-node hexahedra with linear pressure, bulk over shear modulus {bulk_ratio:.0}; elements \
             through the wall, around, along: {}; fibres as wide as described",
            meshes.join(", ")
        )
    }

    /// The FREEs of the checks, between the nodes; none where the map has a single node.
    pub fn check_points(&self, map: &FreeMap) -> Vec<LoadedFree> {
        free_sweep::check_points(map, self.checks, self.seed)
    }

    /// The path of one FREE through pressures (Pa, rising, the first zero). `told` is called after each state and says whether to go
    /// on.
    ///
    /// # Errors
    /// [`SolidError`] where there is no such solid, where the path is lost or stopped.
    pub fn path(
        &self,
        node: &LoadedFree,
        pressures: &[f64],
        told: &mut dyn FnMut() -> bool,
    ) -> Result<FreePath, SolidError> {
        self.path_seen(node, pressures, told, &mut |_, _, _| true)
    }

    /// The same path, its states being shown to `seen` with the solver; see [`SolidSolver::free_path_seen`].
    ///
    /// # Errors
    /// Those of [`SolidSweep::path`].
    pub fn path_seen<'a>(
        &self,
        node: &LoadedFree,
        pressures: &[f64],
        told: &mut dyn FnMut() -> bool,
        seen: &'a mut (dyn FnMut(&SolidSolver, &SolidState, &FreeState) -> bool + 'a),
    ) -> Result<FreePath, SolidError> {
        self.solver(&node.free)?.free_path_seen(node.load, pressures, section_limit(node), told, seen)
    }

    /// Computes the paths of the map that are missing and belong to `shard`; see [`crate::FreeSweep::fill`]. Progress is told in
    /// states. A stop takes effect after the state being sought; the path it belongs to is then left.
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
        let steps = map.pressures.len();
        free_sweep::fill(map, &check_points, shard, (run, steps), finished, &|node, pressures, told| {
            self.path(node, pressures, &mut || told.step()).map_err(|error| match error {
                SolidError::Stopped => None,
                error => Some(PathError::Solid(error)),
            })
        })
    }
}

/// Limit pressure (Pa) of the FREE's section, where there is one: found in milliseconds, it says how far a solid's pressure may be
/// prescribed.
fn section_limit(node: &LoadedFree) -> Option<f64> {
    let mut solver = SectionSolver::new(&node.free, SectionMesh::default()).ok()?;
    solver.limit_pressure(node.load).ok()?
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FreeSweep, section::tests::free};
    use actuator::{EndLoad, PathEnd};
    use std::sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
    };

    /// 60 mm of the paper's tube: the middle fifth is two diameters from the caps.
    fn short(angle: f64) -> Free {
        let mut free = free(angle);
        free.tube.length = 60e-3;
        free
    }

    /// Coarse, for what does not ask for accuracy.
    const COARSE: SolidSweep = SolidSweep { elements: Some([1, 12, 45]), checks: 1, seed: 3 };

    fn path(free: &Free, pressures: &[f64]) -> FreePath {
        COARSE.path(&(*free).into(), pressures, &mut || true).unwrap()
    }

    #[test]
    fn meshes_follow_tube_and_winding() {
        let mut paper = free(30.0);
        paper.tube.length = 130e-3;
        let at = |paper: Free, angle: f64| SolidSweep::usual_mesh(&paper.at(angle.to_radians(), 1.0));
        assert_eq!(at(paper, 30.0), SolidMesh { radial: 2, ..SolidMesh::new(24, 90) });
        assert_eq!(at(paper, 80.0), at(paper, 30.0));
        // At 10 deg an edge along the fibre would be 8.4 mm long.
        assert_eq!(at(paper, 10.0).along, 180);
        for fibres in [1, 2, 3, 4, 5, 7, 24] {
            paper.winding.fibres = fibres;
            let around = at(paper, 30.0).around;
            assert!(around.is_multiple_of(2 * fibres as usize) && (24..=96).contains(&around), "{around}");
        }
        paper.tube.length = 5e-3;
        assert_eq!(at(paper, 89.0).along, 10);
    }

    #[test]
    fn a_path_stops_at_its_greatest_pressure_and_passes_none() {
        // The closed form of a long tube at 60 deg has its limit at 52.5 kPa; caps 60 mm apart hold it longer.
        let free = short(60.0);
        let path = path(&free, &[0.0, 2e4, 4e4, 5.1e4, 9e4]);
        assert_eq!(path.end, PathEnd::LimitPoint);
        let limit = path.limit_pressure().unwrap();
        let section = section_limit(&free.into()).unwrap();
        assert!(limit > section && limit < 1.3 * section, "{limit} against {section}");
        assert!(path.states.windows(2).all(|pair| pair[1].pressure > pair[0].pressure));
        assert!(path.states.iter().all(|state| state.residual < 1e-8));
        for pressure in [2e4, 4e4, 5.1e4] {
            assert!(path.states.iter().any(|state| (state.pressure / pressure - 1.0).abs() < 1e-9));
        }
        // Of all enclosed volumes about the limit point none is in equilibrium with more.
        let mut solver = COARSE.solver(&free).unwrap();
        let (mut state, mut greatest) = (solver.rest(), 0.0f64);
        let volume = std::f64::consts::PI * free.tube.inner_radius.powi(2) * free.tube.length;
        for i in 1..60 {
            state =
                solver.inflate(&state, &[volume * (1.0 + 0.05 * f64::from(i))], &mut |_, _| true).unwrap();
            if state.load().pressure < 0.999 * greatest {
                break;
            }
            greatest = greatest.max(state.load().pressure);
        }
        assert!(state.load().pressure < greatest, "no limit point was passed");
        // One of the volumes, 5 % of that at rest apart, lies within 1e-3 of the top.
        assert!(limit >= greatest * (1.0 - 1e-9) && limit < 1.001 * greatest, "{limit} against {greatest}");
    }

    #[test]
    fn the_states_shown_are_those_of_the_path() {
        // To a limit point, with a pressure that the limit state takes the place of.
        let free = short(60.0);
        let limit = path(&free, &[0.0, 9e4]).limit_pressure().unwrap();
        for pressures in [vec![0.0, 2e4, 4e4], vec![0.0, 4e4, limit * (1.0 - 1e-8), 9e4]] {
            let mut shown = vec![];
            let found = COARSE
                .path_seen(&free.into(), &pressures, &mut || true, &mut |solver, state, report| {
                    assert_eq!((state.load().pressure, state.residual()), (report.pressure, report.residual));
                    assert_eq!(solver.deformation(state).stretch_total, report.axial_stretch);
                    shown.push(*report);
                    true
                })
                .unwrap();
            assert_eq!((&found.states, &found), (&shown, &path(&free, &pressures)));
        }
        // A viewer who has seen enough ends the path.
        let mut seen = 0;
        let stopped = COARSE.path_seen(&free.into(), &[0.0, 2e4, 4e4], &mut || true, &mut |_, _, _| {
            seen += 1;
            seen < 2
        });
        assert_eq!((stopped.unwrap_err(), seen), (SolidError::Stopped, 2));
    }

    #[test]
    fn without_a_safe_pressure_the_limit_point_is_found_all_the_same() {
        let free = short(60.0);
        let limit = path(&free, &[0.0, 9e4]).limit_pressure().unwrap();
        let mut solver = COARSE.solver(&free).unwrap();
        let blind = solver.free_path(EndLoad::NONE, &[0.0, 3e4, 9e4], None, &mut || true).unwrap();
        assert!((blind.limit_pressure().unwrap() / limit - 1.0).abs() < 1e-4, "{blind:?}");
    }

    #[test]
    fn the_middle_of_a_tube_is_its_section() {
        let mut free = short(30.0);
        // What descriptions have.
        free.winding.fibre.diameter = 0.15e-3;
        let pressures = [0.0, 2e4, 4e4];
        let solid = SolidSweep::default().path(&free.into(), &pressures, &mut || true).unwrap();
        assert_eq!((solid.end, solid.states.len()), (PathEnd::Range, 3));
        let mut section = SectionSolver::new(&free, FreeSweep::default().mesh).unwrap();
        let section = section.path(&pressures, 0).unwrap();
        for (ours, theirs) in solid.states.iter().zip(&section.states) {
            let middle = ours.middle.unwrap();
            let strain = theirs.axial_stretch - 1.0;
            // What remains is the mesh.
            assert!((middle.axial_stretch - theirs.axial_stretch).abs() <= 0.005 * strain.abs() + 1e-12);
            assert!((ours.expansion - theirs.expansion).abs() < 2e-4, "{ours:?} {theirs:?}");
            let twist = theirs.twist_per_length;
            assert!(
                (middle.twist_per_length - twist).abs() <= 0.003 * twist.abs() + 1e-12,
                "{ours:?} {theirs:?}"
            );
        }
        // The caps do not let the ends turn.
        let (last, middle) = (solid.states[2], solid.states[2].middle.unwrap());
        assert!(last.twist_per_length.abs() < 0.99 * middle.twist_per_length.abs());
    }

    #[test]
    fn a_sector_stands_for_the_whole() {
        let mut free = short(30.0);
        free.tube.length = 20e-3;
        let sweep = SolidSweep { elements: Some([1, 12, 10]), ..SolidSweep::default() };
        let sector = sweep.path(&free.into(), &[0.0, 3e4], &mut || true).unwrap().states[1];
        let mut whole = SolidSolver::new(&Specimen::from(&free), sweep.mesh(&free)).unwrap();
        assert!(whole.unknowns() > 5 * sweep.solver(&free).unwrap().unknowns());
        let whole = whole.free_path(EndLoad::NONE, &[0.0, 3e4], None, &mut || true).unwrap().states[1];
        for (a, b) in sector.deformation().into_iter().zip(whole.deformation()) {
            assert!((a - b).abs() < 1e-7 * a.abs(), "{sector:?} {whole:?}");
        }
    }

    #[test]
    fn shards_make_the_same_map_and_a_stop_leaves_whole_paths() {
        let sweep = SolidSweep { elements: Some([1, 12, 10]), checks: 1, seed: 3 };
        let angles: Vec<f64> = [25.0f64, 40.0].map(f64::to_radians).to_vec();
        let empty = || {
            let axes = MapAxis::of_angles_and_moduli(angles.clone(), vec![0.393e6]);
            sweep.empty_map(short(30.0).into(), axes, vec![1e4, 2e4], Default::default()).unwrap()
        };
        let (stop, told) = (AtomicBool::new(false), Mutex::new(Vec::new()));
        let mut whole = empty();
        assert!(whole.settings.contains("1 x 12 x 10") && whole.pressures.len() == 3);
        let tell = |done, of| told.lock().unwrap().push((done, of));
        let run = |jobs| Run { jobs, progress: &tell, stop: &stop };
        let report = sweep.fill(&mut whole, Shard::WHOLE, &run(2), &mut |_, _| {}).unwrap();
        assert_eq!((report.computed, report.left, report.failed.len()), (3, 0, 0));
        let mut steps = std::mem::take(&mut *told.lock().unwrap());
        steps.sort_unstable();
        assert_eq!(steps, (0..=9).map(|done| (done, 9)).collect::<Vec<_>>());

        let mut parts = empty();
        for index in 0..2 {
            sweep.fill(&mut parts, Shard { index, count: 2 }, &run(1), &mut |_, _| {}).unwrap();
        }
        assert_eq!(parts, whole);

        // Stopped in the middle of the second path.
        let stopping =
            Run { jobs: 1, progress: &|done, _| stop.store(done >= 4, Ordering::Relaxed), stop: &stop };
        let mut part = empty();
        let report = sweep.fill(&mut part, Shard::WHOLE, &stopping, &mut |_, _| {}).unwrap();
        assert_eq!((report.computed, report.left, report.failed.len()), (1, 2, 0));
        assert_eq!(part.paths[0], whole.paths[0]);
        stop.store(false, Ordering::Relaxed);
        sweep.fill(&mut part, Shard::WHOLE, &run(2), &mut |_, _| {}).unwrap();
        assert_eq!(part, whole);
    }

    #[test]
    fn meshes_and_windings_that_make_no_solid_are_refused() {
        let message = |elements, angle: f64, fibres| {
            let mut free = short(30.0);
            free.winding.fibres = fibres;
            let sweep = SolidSweep { elements, ..SolidSweep::default() };
            let axes = MapAxis::of_angles_and_moduli(vec![angle.to_radians()], vec![0.4e6]);
            sweep.empty_map(free.into(), axes, vec![1e4], Default::default()).unwrap_err().to_string()
        };
        assert!(message(Some([1, 10, 10]), 30.0, 6).contains("even number for each fibre"));
        assert!(message(Some([0, 12, 10]), 30.0, 6).contains("at least one through the wall"));
        assert!(message(None, 0.0, 6).contains("rings that never reach the caps"));
        // Fibres along the tube are fine.
        let along = path(&short(90.0), &[0.0, 5e3]);
        assert!(along.states[1].axial_stretch < 1.0 && along.states[1].twist_per_length.abs() < 1e-6);
    }
}
