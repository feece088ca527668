use crate::{
    BendingSweep, CapSweep, ModuleError, ModuleLine, ModuleSolver, ModuleSweepError, RodModule, RodSettings,
    Run, SectionMesh, Shard, SolidModule, SolidModuleSettings, TipLoad,
    free_map::next_fraction,
    module_fill::{Filling, FinishedRow},
    module_line::spread,
    pressure_axes::check_axes,
};
use actuator::{FreePath, Limits, Module, ModuleMap, ModuleSymmetry};

/// How the map of a module is computed: rods with section laws tabulated from the section's finite elements, or solids.
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
    /// Solids that take the place of the rods and their laws; `None` for rods. A state then takes seconds, a thread half a gigabyte of
    /// memory (four FREEs of 175 mm by the usual mesh).
    pub solids: Option<SolidModuleSettings>,
    /// How bending and shear stiffness are computed; `None` takes those of the bare tube, 3 mu I and mu A.
    pub bending: Option<BendingSweep>,
    /// How it is found what their caps do to the rods' stretch and twist; `None` for sections that reach from plate to plate.
    pub caps: Option<CapSweep>,
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
            solids: None,
            bending: Some(BendingSweep::default()),
            caps: Some(CapSweep::default()),
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
    pub error: ModuleError,
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
        check_axes(module.frees.len(), &pressures)?;
        if let Some(settings) = self.solids {
            SolidModule::new(&module, settings)?;
        }
        let paths = self.free_paths(&module, &pressures)?;
        let mut map = ModuleMap {
            module,
            limits,
            parameters: match self.solids {
                Some(_) => SolidModule::map_parameters(),
                None => RodModule::map_parameters(),
            },
            pressures,
            states: Vec::new(),
            checks: Vec::new(),
            limit_pressures: paths.iter().map(FreePath::limit_pressure).collect(),
            settings: String::new(),
            source,
        };
        map.settings = self.settings(&map.module);
        map.states = vec![None; map.node_count()];
        Ok(map)
    }

    /// The settings in words, as they stand in the map.
    pub fn settings(&self, module: &Module) -> String {
        let alike = if self.use_symmetry { "; of nodes alike by symmetry one computed" } else { "" };
        let model = match self.solids {
            Some(settings) => settings.describe(module),
            None => self.rods_in_words(),
        };
        format!("{model}{alike}; {} checks, seed {}", self.checks, self.seed)
    }

    fn rods_in_words(&self) -> String {
        let SectionMesh { radial, under_fibre, between_fibres } = self.mesh;
        format!(
            "{}; section laws tabulated from half a fibre pitch of {radial} elements through the wall, {under_fibre} under half \
             a fibre, {between_fibres} beside it, threads spread over all of the surface{}; bending and shear {}",
            self.rods.describe(),
            match self.caps {
                Some(sweep) =>
                    format!(", with the ends that solids of {} outer radii have between caps", sweep.length),
                None => String::new(),
            },
            match self.bending {
                Some(sweep) => format!("tabulated from solids at {} pressures", sweep.planes),
                None => "of the bare tube, 3 mu I and mu A".to_owned(),
            }
        )
    }

    /// Motions that carry the module, its axes (Pa) and its loads into themselves, where they are used, but the one that moves nothing.
    fn symmetries(&self, module: &Module, axes: &[Vec<f64>]) -> Vec<ModuleSymmetry> {
        let TipLoad { force, moment } = self.solids.map_or(self.rods.tip_load, |solids| solids.tip_load);
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

    /// Puts what symmetry makes of the states of a map into its nodes that are empty.
    pub fn spread(&self, map: &mut ModuleMap) {
        spread(&self.symmetries(&map.module, &map.pressures), map);
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
        check_axes(map.module.frees.len(), &map.pressures)?;
        let expected = map.node_count();
        if map.states.len() != expected {
            return Err(ModuleSweepError::Shape { expected, found: map.states.len() });
        }
        self.spread(map);
        let own = self.lines(map, shard).into_iter();
        let (lines, there): (Vec<ModuleLine>, Vec<ModuleLine>) = own.partition(|line| line.is_missing(map));
        let states = |lines: &[ModuleLine]| lines.iter().map(|line| line.pressures.len()).sum::<usize>();
        let (already, all) = (states(&there), states(&there) + states(&lines));
        (run.progress)(already, all);
        let mut report = ModuleSweepReport { rows_left: lines.len(), ..Default::default() };
        if lines.is_empty() {
            return Ok(report);
        }
        let (module, pressures) = (map.module.clone(), map.pressures.clone());
        let filling = Filling { map, report: &mut report, done: already, all, finished };
        match self.solids {
            Some(settings) => {
                // Threads beyond one a line go to the FREEs.
                let threads = (run.jobs / lines.len()).max(1);
                let settings = SolidModuleSettings { threads, ..settings };
                filling.fill(&lines, &|| Ok(SolidModule::new(&module, settings)?), run)?;
            }
            None => match self.rod_module(&module, &pressures, run)? {
                Some(rods) => filling.fill(&lines, &|| Ok(rods.clone()), run)?,
                None => return Ok(report),
            },
        }
        self.spread(map);
        // In the order of the points, whichever thread was first.
        let checks = self.check_pressures(map);
        map.checks.sort_by_key(|check| checks.iter().position(|pressures| *pressures == check.pressures));
        Ok(report)
    }
}

#[cfg(test)]
#[path = "module_map_tests.rs"]
mod tests;
