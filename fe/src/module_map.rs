use crate::{
    BendingLaw, BendingSweep, ConstantBending, Equilibrium, ModuleLine, ModuleSweepError, RodError, RodLaw,
    RodModule, RodSettings, Run, SectionMesh, SectionSolver, SectionTable, Shard, TableError, TableGrid,
    TipLoad, free_map::next_fraction,
};
use actuator::{
    Free, FreePath, Handedness, Limits, MapParameter, Module, ModuleMap, ModuleState, ModuleSymmetry,
    PAYLOAD_STEP, payload_curvature, units::KPA,
};
use std::f64::consts::TAU;
use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicUsize, Ordering},
};

/// How the map of a module is computed: rods with section laws tabulated from the section's finite elements.
///
/// The unit of work is a row, the line of nodes along the last FREE's pressure ([`ModuleLine`]): its first node is followed from rest,
/// the others one from the other, so that the map depends neither on the number of threads nor on the sharding. Every check is followed
/// from rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModuleSweep {
    /// Mesh of the sections.
    pub mesh: SectionMesh,
    /// Fineness of the rods, factor on their bending stiffness.
    pub rods: RodSettings,
    /// How bending and shear stiffness are computed; `None` takes those of the bare tube, 3 mu I and mu A.
    pub bending: Option<BendingSweep>,
    /// Whether of nodes that a symmetry of the module carries into each other only the first is computed.
    pub use_symmetry: bool,
    /// Number of states at random pressures, for a fit to be judged by.
    pub checks: usize,
    /// Chooses where the checks lie.
    pub seed: u64,
}

impl Default for ModuleSweep {
    /// A section mesh of two elements through the wall, three around, whose torque is within 0.1 % of the next finer ones (a
    /// table asks for hundreds of states). Twenty elements a FREE, 60 checks.
    fn default() -> Self {
        let mesh = SectionMesh { radial: 2, under_fibre: 1, between_fibres: 2 };
        ModuleSweep {
            mesh,
            rods: RodSettings::default(),
            bending: Some(BendingSweep::default()),
            use_symmetry: true,
            checks: 60,
            seed: 1,
        }
    }
}

/// A state that was not found; its node stays empty.
#[derive(Clone, Debug)]
pub struct FailedState {
    /// Pressures, Pa.
    pub pressures: Vec<f64>,
    /// Why.
    pub error: RodError,
}

/// What a sweep of a module did.
#[derive(Clone, Debug, Default)]
pub struct ModuleSweepReport {
    /// States computed now, checks among them.
    pub computed: usize,
    /// Of these, states that are not stable (buckled).
    pub buckled: usize,
    /// Rows that were to be computed but are not, because a stop was asked for.
    pub rows_left: usize,
    /// States that were not found.
    pub failed: Vec<FailedState>,
}

/// Told of each row, or check, all of whose states were found: their pressures (Pa), and the states.
type FinishedRow<'a> = dyn FnMut(&[Vec<f64>], &[ModuleState]) + Send + 'a;

/// What a FREE's section depends on: neither its length nor, but for the mirror, its hand. Its threads are spread over all of the
/// surface: in a FREE that others turn against its own sense under pressure they are pulled tight, and narrow ones cut into the
/// wall, which bulges between them in a snap (0.15 mm: from 10 rad/m at 40 kPa in a 40 degree FREE). A module's states there would
/// hang on a width that nobody measures. The price is 4 to 6 % more twist of a free FREE at 20 degrees, 1.5 % at 60.
fn section_of(free: &Free) -> Free {
    let mut section = *free;
    section.tube.length = 1.0;
    section.winding.handedness = Handedness::Right;
    section.winding.fibre.diameter = TAU * section.tube.outer_radius();
    section
}

/// The first FREE whose section is the same as that of each FREE.
fn first_alike(module: &Module) -> Vec<usize> {
    let sections: Vec<Free> = module.frees.iter().map(|placed| section_of(&placed.free)).collect();
    sections.iter().map(|own| sections.iter().position(|other| other == own).unwrap_or_default()).collect()
}

/// Parameters whose slopes each state of a map carries, in this order.
const PARAMETERS: [MapParameter; 3] =
    [MapParameter::Payload, MapParameter::BendingStiffness, MapParameter::PayloadCurvature];

/// The state of an equilibrium, with how its pose departs from its slope at a payload, from the module that carries one.
fn with_payload_curvature(found: &Equilibrium, loaded: &RodModule) -> Result<ModuleState, RodError> {
    let mut state = found.state.clone();
    let heavy = loaded.solve_from(found, &found.pressures)?.state.chart.to_array();
    let (light, slope) = (state.chart.to_array(), state.slopes[0]);
    let step = PAYLOAD_STEP;
    state
        .slopes
        .push(std::array::from_fn(|k| (heavy[k] - light[k] - slope[k] * step) / payload_curvature(step)));
    Ok(state)
}

fn check_axes(module: &Module, pressures: &[Vec<f64>]) -> Result<(), ModuleSweepError> {
    for free in 0..module.frees.len().max(pressures.len()) {
        let error = |problem: &str| Err(ModuleSweepError::Axis { free, problem: problem.to_owned() });
        let Some(axis) = pressures.get(free) else { return error("are missing; give nodes for every FREE") };
        if free >= module.frees.len() {
            return error("there is no such FREE in the module");
        }
        let rising = axis.windows(2).all(|pair| pair[1] > pair[0]) && axis.iter().all(|p| p.is_finite());
        if axis.len() < 2 || axis[0] != 0.0 || !rising {
            let nodes: Vec<String> = axis.iter().map(|p| (p / KPA).to_string()).collect();
            return error(&format!("must be two or more, rising from zero, not {}", nodes.join(", ")));
        }
    }
    Ok(())
}

impl ModuleSweep {
    /// An empty map of a module over pressures (Pa, rising from zero) of each FREE, with the limit pressures of its FREEs.
    /// `source` is name and text of the description.
    ///
    /// # Errors
    /// [`ModuleSweepError`] where an axis or a FREE makes no sense.
    pub fn empty_map(
        &self,
        module: Module,
        limits: Limits,
        pressures: Vec<Vec<f64>>,
        source: (String, String),
    ) -> Result<ModuleMap, ModuleSweepError> {
        check_axes(&module, &pressures)?;
        let paths = self.free_paths(&module, &pressures)?;
        let mut map = ModuleMap {
            module,
            limits,
            parameters: PARAMETERS.to_vec(),
            pressures,
            states: Vec::new(),
            checks: Vec::new(),
            limit_pressures: paths.iter().map(FreePath::limit_pressure).collect(),
            settings: self.settings(),
            source,
        };
        map.states = vec![None; map.node_count()];
        Ok(map)
    }

    /// The settings in words, as they stand in the map.
    pub fn settings(&self) -> String {
        let SectionMesh { radial, under_fibre, between_fibres } = self.mesh;
        format!(
            "{}; section laws tabulated from half a fibre pitch of {radial} elements through the wall, {under_fibre} under half \
             a fibre, {between_fibres} beside it, threads spread over all of the surface; bending and shear {}{}; {} checks, seed {}",
            self.rods.describe(),
            match self.bending {
                Some(sweep) => format!("tabulated from solids at {} pressures", sweep.planes),
                None => "of the bare tube, 3 mu I and mu A".to_owned(),
            },
            if self.use_symmetry { "; of nodes alike by symmetry one computed" } else { "" },
            self.checks,
            self.seed
        )
    }

    /// Free path of each FREE as if right-handed; FREEs of one section share it.
    fn free_paths(&self, module: &Module, pressures: &[Vec<f64>]) -> Result<Vec<FreePath>, ModuleSweepError> {
        let alike = first_alike(module);
        let mut paths: Vec<FreePath> = Vec::with_capacity(alike.len());
        for (free, first) in alike.into_iter().enumerate() {
            let path = if first < free {
                paths[first].clone()
            } else {
                SectionSolver::new(&section_of(&module.frees[free].free), self.mesh)
                    .and_then(|mut solver| solver.path(&pressures[free], 8))
                    .map_err(|source| ModuleSweepError::Section { free, source })?
            };
            paths.push(path);
        }
        Ok(paths)
    }

    /// Section law of each FREE, tabulated up to its greatest pressure or its limit pressure; FREEs of one section share it.
    ///
    /// # Errors
    /// [`ModuleSweepError`] where a section cannot be solved or the tabulation was stopped.
    pub fn section_laws(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Vec<Arc<SectionTable>>, ModuleSweepError> {
        let alike = first_alike(module);
        let paths = self.free_paths(module, pressures)?;
        let mut laws: Vec<Arc<SectionTable>> = Vec::with_capacity(alike.len());
        for (free, first) in alike.iter().copied().enumerate() {
            if first < free {
                laws.push(laws[first].clone());
                continue;
            }
            let users = alike.iter().zip(pressures).filter(|(other, _)| **other == free);
            let top = users.flat_map(|(_, axis)| axis).fold(0.0f64, |top, pressure| top.max(*pressure));
            let top = paths[free].limit_pressure().map_or(top, |limit| top.min(limit));
            let section = section_of(&module.frees[free].free);
            let mut solver = SectionSolver::new(&section, self.mesh)
                .map_err(|source| ModuleSweepError::Section { free, source })?;
            let grid = TableGrid::for_free(&section, &paths[free], top);
            let provider = move |p: f64, stretch: f64, twist: f64| solver.respond(p, stretch, twist).ok();
            let table = SectionTable::tabulate(grid, &provider, run)
                .map_err(|source| ModuleSweepError::Table { free, source })?;
            laws.push(Arc::new(table));
        }
        Ok(laws)
    }

    /// Bending law of each FREE up to the greatest pressure of its section law; FREEs of one section share it. `None` where the run
    /// was stopped.
    ///
    /// # Errors
    /// [`ModuleSweepError::Bending`] where a FREE's solids cannot be solved.
    pub fn bending_laws(
        &self,
        module: &Module,
        sections: &[Arc<SectionTable>],
        run: &Run<'_>,
    ) -> Result<Option<Vec<Arc<dyn BendingLaw>>>, ModuleSweepError> {
        let mut laws: Vec<Arc<dyn BendingLaw>> = Vec::with_capacity(sections.len());
        for (free, first) in first_alike(module).into_iter().enumerate() {
            let own = &module.frees[free].free;
            let law = match self.bending {
                _ if first < free => laws[first].clone(),
                None => Arc::new(ConstantBending::of_bare_tube(own)),
                Some(sweep) => {
                    let top = sections[free].grid().pressures.iter().fold(0.0f64, |top, p| top.max(*p));
                    let found = sweep.tabulate(own, top, run);
                    match found.map_err(|source| ModuleSweepError::Bending { free, source })? {
                        None => return Ok(None),
                        Some(table) => Arc::new(table),
                    }
                }
            };
            laws.push(law);
        }
        Ok(Some(laws))
    }

    /// Motions that carry the module, its axes (Pa) and its loads into themselves, where they are used, but the one that moves nothing.
    fn symmetries(&self, module: &Module, axes: &[Vec<f64>]) -> Vec<ModuleSymmetry> {
        let TipLoad { force, moment } = self.rods.tip_load;
        let keeps = |motion: &ModuleSymmetry| motion.vector(force) == force && motion.turns(moment) == moment;
        let all = module.symmetries().into_iter().filter(|motion| self.use_symmetry && !motion.is_identity());
        all.filter(|motion| motion.carry(axes) == axes && keeps(motion)).collect()
    }

    /// The units of work of a part: lines of nodes, of those that symmetry carries into each other one, and checks.
    pub fn lines(&self, map: &ModuleMap, shard: Shard) -> Vec<ModuleLine> {
        let symmetries = self.symmetries(&map.module, &map.pressures);
        let lines = ModuleLine::all(map, &symmetries, &self.check_pressures(map)).into_iter().enumerate();
        lines.filter(|(index, _)| shard.owns(*index)).map(|(_, line)| line).collect()
    }

    /// Puts the states of a line into a map, with what symmetry makes of them.
    pub fn put(&self, line: &ModuleLine, states: Vec<ModuleState>, map: &mut ModuleMap) {
        let symmetries = self.symmetries(&map.module, &map.pressures);
        for (place, state) in states.into_iter().enumerate().take(line.pressures.len()) {
            line.put(place, state, &symmetries, map);
        }
    }

    /// Pressures (Pa) of the checks: evenly distributed over the box of the map.
    pub fn check_pressures(&self, map: &ModuleMap) -> Vec<Vec<f64>> {
        let mut state = self.seed;
        let mut one = |axis: &Vec<f64>| axis.last().copied().unwrap_or_default() * next_fraction(&mut state);
        (0..self.checks).map(|_| map.pressures.iter().map(&mut one).collect()).collect()
    }

    /// Computes the states of the map (rows of nodes, then checks) that are missing and belong to `shard`.
    ///
    /// `finished` is told each row all of whose states were found, pressures (Pa) and states, from the thread that found them,
    /// which then begins another: no more rows than there are threads are begun and not told of. `run.progress` counts states,
    /// those that the map held already among them. A stop asked for by `run` takes effect after the rows being followed. States
    /// that are not found are reported and stay empty.
    ///
    /// # Errors
    /// [`ModuleSweepError`] where the map does not fit its own axes or its sections cannot be solved.
    pub fn fill(
        &self,
        map: &mut ModuleMap,
        shard: Shard,
        run: &Run<'_>,
        finished: &mut FinishedRow<'_>,
    ) -> Result<ModuleSweepReport, ModuleSweepError> {
        check_axes(&map.module, &map.pressures)?;
        let expected = map.node_count();
        if map.states.len() != expected {
            return Err(ModuleSweepError::Shape { expected, found: map.states.len() });
        }
        let symmetries = self.symmetries(&map.module, &map.pressures);
        ModuleLine::spread(&symmetries, map);
        let own = self.lines(map, shard).into_iter();
        let (lines, there): (Vec<ModuleLine>, Vec<ModuleLine>) = own.partition(|line| line.is_missing(map));
        let states = |lines: &[ModuleLine]| lines.iter().map(|line| line.pressures.len()).sum::<usize>();
        let (already, all) = (states(&there), states(&there) + states(&lines));
        (run.progress)(already, all);
        let mut report = ModuleSweepReport { rows_left: lines.len(), ..Default::default() };
        if lines.is_empty() {
            return Ok(report);
        }
        let laws = match self.section_laws(&map.module, &map.pressures, run) {
            Err(ModuleSweepError::Table { source: TableError::Stopped, .. }) => return Ok(report),
            laws => laws?,
        };
        let bending = match self.bending_laws(&map.module, &laws, run)? {
            None => return Ok(report),
            Some(bending) => bending,
        };
        let laws = laws.into_iter().zip(bending).map(|(section, bending)| RodLaw { section, bending });
        let rods = RodModule::new(&map.module, laws.collect(), self.rods)?;
        let rest = rods.rest()?;
        let mut loaded = map.module.clone();
        loaded.tip.payload += PAYLOAD_STEP;
        let loaded = RodModule::new(&loaded, rods.laws(), self.rods)?;

        let next = AtomicUsize::new(0);
        let results = Mutex::new((&mut *map, &mut report, already, finished));
        std::thread::scope(|scope| {
            for _ in 0..run.jobs.clamp(1, lines.len()) {
                scope.spawn(|| {
                    while !run.is_stopped() {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        let Some(line) = lines.get(index) else { break };
                        let mut last = rest.clone();
                        let follow = |pressures: &Vec<f64>| {
                            last = rods.solve_from(&last, pressures)?;
                            with_payload_curvature(&last, &loaded)
                        };
                        let found: Vec<Result<ModuleState, RodError>> =
                            line.pressures.iter().map(follow).collect();
                        let mut results = results.lock().unwrap_or_else(PoisonError::into_inner);
                        let (map, report, done, finished) = &mut *results;
                        if let Ok(states) = found.iter().map(Result::as_ref).collect::<Result<Vec<_>, _>>() {
                            finished(&line.pressures, &states.into_iter().cloned().collect::<Vec<_>>());
                        }
                        for (place, state) in found.into_iter().enumerate() {
                            match state {
                                Ok(state) => {
                                    report.computed += 1;
                                    report.buckled += usize::from(state.negative_pivots > 0);
                                    line.put(place, state, &symmetries, map);
                                }
                                Err(error) => {
                                    let pressures = line.pressures[place].clone();
                                    report.failed.push(FailedState { pressures, error });
                                }
                            }
                        }
                        report.rows_left -= 1;
                        *done += line.pressures.len();
                        (run.progress)(*done, all);
                    }
                });
            }
        });
        // In the order of the points, whichever thread was first.
        let checks = self.check_pressures(map);
        map.checks.sort_by_key(|check| checks.iter().position(|pressures| *pressures == check.pressures));
        Ok(report)
    }
}

#[cfg(test)]
#[path = "module_map_tests.rs"]
mod tests;
