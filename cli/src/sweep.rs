//! Sweeps of finite elements, told of, their points kept as they come, and stopped by Ctrl-C.

use crate::{
    exit::Exit, failure::Failure, interrupt, path_sweep::PathSweep, point_key, points::Points,
    progress::Progress, table::short,
};
use actuator::{
    EndLoad, Free, FreeMap, FreePath, LoadedFree, MapAxis, Module, ModuleMap, ModuleState, Rig, units::KPA,
};
use fe::{
    CapsReport, FreeSweep, FreeSweepError, FreeSweepReport, ModuleSweep, ModuleSweepError, ModuleSweepReport,
    Run, Shard,
};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a sweep did. Points are paths of a FREE, rows and checks of a module.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Swept {
    /// Points of this part that were there before.
    pub found: usize,
    /// Points computed now.
    pub computed: usize,
    /// States or paths that were not found, and why.
    pub failed: Vec<String>,
    /// What was done about caps, where sections are corrected for them.
    pub caps: Option<CapsReport>,
}

/// How a sweep is run.
pub struct Sweeping<'a> {
    /// The part to compute.
    pub shard: Shard,
    /// Threads.
    pub jobs: usize,
    /// Where finished points are looked for and kept.
    pub points: Option<&'a Mutex<Points>>,
}

impl Sweeping<'_> {
    /// All of it, on every processor, with no points from before and none for later.
    pub fn whole() -> Self {
        Sweeping { shard: Shard::WHOLE, jobs: processors(), points: None }
    }

    fn points(&self) -> Option<MutexGuard<'_, Points>> {
        self.points.map(|points| points.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Puts stored paths into a FREE's map. Gives how many of this part are there then.
    pub fn recall_paths(&self, sweep: &impl PathSweep, map: &mut FreeMap) -> Result<usize, Failure> {
        let (checks, nodes) = (sweep.check_points(map), map.paths.len());
        let (mut there, mut points) = (0, self.points());
        for row in (0..nodes + checks.len()).filter(|row| self.shard.owns(*row)) {
            let (node, is_there) = match row.checked_sub(nodes) {
                None => (map.at(&map.coordinates(row)).map_err(Failure::file)?, map.paths[row].is_some()),
                Some(check) => (checks[check], map.checks.iter().any(|(node, _)| *node == checks[check])),
            };
            let key = sweep.key(map, &node).map_err(Failure::file)?;
            let stored: Option<FreePath> = points.as_mut().and_then(|points| points.find(key, !is_there));
            there += usize::from(is_there || stored.is_some());
            let Some(path) = stored else { continue };
            match map.paths.get_mut(row) {
                Some(place) => *place = Some(path),
                None => map.checks.push((node, path)),
            }
        }
        Ok(there)
    }

    /// Computes what is missing of a FREE's map and of the store.
    pub fn paths<S: PathSweep>(&self, sweep: &S, map: &mut FreeMap) -> Result<Swept, Failure> {
        let found = self.recall_paths(sweep, map)?;
        let bar = Progress::bar(&format!("computing {}", S::STEPS));
        let told = |done, total| bar.at(done, total);
        let run = Run { jobs: self.jobs, progress: &told, stop: interrupt::flag() };
        let empty = FreeMap { paths: vec![None; map.paths.len()], checks: vec![], ..map.clone() };
        let mut finished = |node: &LoadedFree, path: &FreePath| {
            if let Some(mut points) = self.points() {
                points.keep(sweep.key(&empty, node), path);
            }
        };
        let (report, caps) = sweep.fill(map, self.shard, &run, &mut finished).map_err(Failure::file)?;
        Ok(Swept { found, computed: report.computed, failed: failed_paths(&report, map), caps })
    }

    /// Puts stored states into a module's map. Gives how many points of this part are there then.
    pub fn recall_rows(&self, sweep: &ModuleSweep, map: &mut ModuleMap) -> Result<usize, Failure> {
        let (mut there, mut points) = (0, self.points());
        for line in sweep.lines(map, self.shard) {
            let is_there = !line.is_missing(map);
            let key = point_key::row(sweep, map, &line.pressures).map_err(Failure::file)?;
            let stored: Option<Vec<ModuleState>> =
                points.as_mut().and_then(|points| points.find(key, !is_there));
            let stored = stored.filter(|states| states.len() == line.pressures.len());
            there += usize::from(is_there || stored.is_some());
            for (place, state) in stored.into_iter().flatten().enumerate() {
                line.put(place, state, map);
            }
        }
        sweep.spread(map);
        Ok(there)
    }

    /// Computes what is missing of a module's map and of the store.
    pub fn rows(&self, sweep: &ModuleSweep, map: &mut ModuleMap) -> Result<Swept, Failure> {
        let found = self.recall_rows(sweep, map)?;
        let bar = Progress::bar("computing states");
        let told = |done, total| bar.at(done, total);
        let run = Run { jobs: self.jobs, progress: &told, stop: interrupt::flag() };
        let (empty, mut computed) = (ModuleMap { states: vec![], checks: vec![], ..map.clone() }, 0);
        let mut finished = |pressures: &[Vec<f64>], states: &[ModuleState]| {
            computed += 1;
            if let Some(mut points) = self.points() {
                points.keep(point_key::row(sweep, &empty, pressures), &states);
            }
        };
        let report = sweep.fill(map, self.shard, &run, &mut finished);
        let report = report.map_err(|error| Failure::new(Exit::NotConverged, error))?;
        Ok(Swept { found, computed, failed: failed_states(&report), caps: None })
    }
}

/// Where on the axes of a map a FREE lies, in words.
pub fn place(node: &LoadedFree, map: &FreeMap) -> String {
    let of = |axis: &MapAxis| {
        let value = axis.parameter.of(node)?;
        Some(format!("{} = {}", axis.parameter.name(), short(value / axis.parameter.unit())))
    };
    map.axes.iter().rev().filter_map(of).collect::<Vec<_>>().join(", ")
}

fn failed_paths(report: &FreeSweepReport, map: &FreeMap) -> Vec<String> {
    let failed = report.failed.iter().map(|failed| format!("{}: {}", place(&failed.node, map), failed.error));
    failed.collect()
}

/// Threads that this machine runs at once.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Limit pressure (Pa) of a FREE, where it has one.
fn limit_pressure(free: &Free) -> Result<Option<f64>, Failure> {
    let limit = fe::SectionSolver::new(free, fe::SectionMesh::default())
        .and_then(|mut solver| solver.limit_pressure(EndLoad::NONE));
    limit.map_err(|error| Failure::new(Exit::NotConverged, error))
}

/// Pressures per FREE that make a map of about 2500 nodes.
pub fn usual_nodes(frees: usize) -> usize {
    match frees {
        0..=1 => 41,
        2 => 21,
        3 => 11,
        4 => 7,
        5 => 5,
        _ => 4,
    }
}

/// Share of a limit pressure up to which a module is mapped: nearer to it the poses change ever faster.
const BELOW_LIMIT: f64 = 0.9;

/// What computes a module's map, and the empty map: `nodes` pressures of each FREE from zero to `greatest` (Pa), but no nearer to the
/// FREE's limit pressure than nine tenths of it, placed as a spline likes them.
pub fn plan_module(
    rig: &Rig,
    module: &Module,
    greatest: &[f64],
    nodes: &[usize],
    sweep: &ModuleSweep,
) -> Result<ModuleMap, Failure> {
    let mut pressures: Vec<Vec<f64>> = Vec::new();
    let mut known: Vec<(Free, Option<f64>)> = Vec::new();
    for ((placed, greatest), nodes) in module.frees.iter().zip(greatest).zip(nodes) {
        // Neither length nor hand changes the limit pressure.
        let mut alike = placed.free;
        alike.tube.length = 1.0;
        alike.winding.handedness = actuator::Handedness::Right;
        let limit = match known.iter().find(|(free, _)| *free == alike) {
            Some((_, limit)) => *limit,
            None => {
                let limit = limit_pressure(&alike).map_err(|failure| failure.about(&rig.path))?;
                known.push((alike, limit));
                limit
            }
        };
        let greatest = limit.map_or(*greatest, |limit| greatest.min(BELOW_LIMIT * limit));
        pressures.push(rom::recommended_pressure_nodes(greatest, limit, *nodes));
    }
    let source = (rig.name.clone(), rig.text.clone());
    let planned = sweep.empty_map(module.clone(), rig.limits.clone(), pressures, source);
    planned.map_err(|error| match error {
        ModuleSweepError::Solids(error) => Failure::refused(error.to_string()).about(&rig.path),
        error => Failure::file(error).about(&rig.path),
    })
}

fn failed_states(report: &ModuleSweepReport) -> Vec<String> {
    let failed = report.failed.iter().map(|failed| {
        let pressures: Vec<String> = failed.pressures.iter().map(|pressure| short(pressure / KPA)).collect();
        format!("at {} kPa: {}", pressures.join(", "), failed.error)
    });
    failed.collect()
}

/// An empty map of a FREE over the given axes (SI).
pub fn plan_free(
    sweep: &FreeSweep,
    rig: &Rig,
    axes: Vec<MapAxis>,
    pressures: Vec<f64>,
) -> Result<FreeMap, Failure> {
    let source = (rig.name.clone(), rig.text.clone());
    let planned = sweep.empty_map(rig.frees()[0].into(), axes, pressures, source);
    planned.map_err(|error| unplanned(error, rig))
}

/// Why a sweep cannot be begun: the axes were given on the command line, the FREE in a file.
pub fn unplanned(error: FreeSweepError, rig: &Rig) -> Failure {
    match error {
        FreeSweepError::Axis { .. } | FreeSweepError::Parameter(_) => Failure::usage(error.to_string()),
        _ => Failure::file(error).about(&rig.path),
    }
}
