//! Sweeps of finite elements, told of, saved as they go, and stopped by Ctrl-C.

use crate::{exit::Exit, failure::Failure, interrupt, map_file::MapFile, progress::Progress, table::short};
use actuator::{Free, FreeMap, LoadedFree, MapAxis, Module, ModuleMap, Rig, units::KPA};
use fe::{
    CappedSweep, CapsReport, FreeSweep, FreeSweepError, FreeSweepReport, ModuleSweep, ModuleSweepReport, Run,
    Shard, SolidSweep,
};
use std::{
    path::Path,
    time::{Duration, Instant},
};

/// Time between two savings of an unfinished map, where none is asked for; `map --help` says the same.
pub const SAVE_EVERY: Duration = Duration::from_secs(3);

/// What a sweep did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Swept {
    /// States or paths that were not found, and why.
    pub failed: Vec<String>,
    /// What was done about caps, where sections are corrected for them.
    pub caps: Option<CapsReport>,
}

/// Computes what is missing of a FREE's map, telling and saving it as it is told to.
type Fill<'a> = dyn FnMut(&Run<'_>, &mut dyn FnMut(&FreeMap)) -> Result<FreeSweepReport, FreeSweepError> + 'a;

/// How a sweep is run.
pub struct Sweeping<'a> {
    /// The part to compute.
    pub shard: Shard,
    /// Threads.
    pub jobs: usize,
    /// Where the unfinished map is saved, and the time between two savings.
    pub save: Option<(&'a Path, Duration)>,
}

impl Sweeping<'_> {
    /// All of it, on every processor, saved nowhere.
    pub fn whole() -> Self {
        Sweeping { shard: Shard::WHOLE, jobs: processors(), save: None }
    }

    /// Computes what is missing of a FREE's map.
    pub fn free(&self, sweep: &FreeSweep, map: &mut FreeMap) -> Result<Swept, Failure> {
        let report = self
            .paths("computing paths", &mut |run, checkpoint| sweep.fill(map, self.shard, run, checkpoint))?;
        Ok(told_of_free(&report, map))
    }

    /// Computes what is missing of a FREE's map by solids.
    pub fn solid(&self, sweep: &SolidSweep, map: &mut FreeMap) -> Result<Swept, Failure> {
        let report = self
            .paths("computing states", &mut |run, checkpoint| sweep.fill(map, self.shard, run, checkpoint))?;
        Ok(told_of_free(&report, map))
    }

    /// Computes what is missing of a FREE's map of sections between caps.
    pub fn capped(&self, sweep: &CappedSweep, map: &mut FreeMap) -> Result<Swept, Failure> {
        let mut caps = None;
        let report = self.paths("computing end effects", &mut |run, checkpoint| {
            let (report, done) = sweep.fill(map, self.shard, run, checkpoint)?;
            caps = Some(done);
            Ok(report)
        })?;
        Ok(Swept { caps, ..told_of_free(&report, map) })
    }

    fn paths(&self, what: &str, fill: &mut Fill<'_>) -> Result<FreeSweepReport, Failure> {
        let bar = Progress::bar(what);
        let told = |done, total| bar.at(done, total);
        let run = Run { jobs: self.jobs, progress: &told, stop: interrupt::flag() };
        let mut saver = Saver::new(self.save);
        let mut checkpoint = |map: &FreeMap| saver.save(|| MapFile::Free(map.clone()));
        let report = fill(&run, &mut checkpoint).map_err(Failure::file)?;
        saver.outcome?;
        Ok(report)
    }

    /// Computes what is missing of a module's map.
    pub fn module(&self, sweep: &ModuleSweep, map: &mut ModuleMap) -> Result<Swept, Failure> {
        let bar = Progress::bar("computing rows of states");
        let told = |done, total| bar.at(done, total);
        let run = Run { jobs: self.jobs, progress: &told, stop: interrupt::flag() };
        let mut saver = Saver::new(self.save);
        let mut checkpoint = |map: &ModuleMap| saver.save(|| MapFile::Module(map.clone()));
        let report = sweep.fill(map, self.shard, &run, &mut checkpoint);
        let report = report.map_err(|error| Failure::new(Exit::NotConverged, error))?;
        saver.outcome?;
        Ok(told_of_module(&report))
    }
}

/// Saves a map now and then; the first failure to do so is kept for the end.
struct Saver<'a> {
    save: Option<(&'a Path, Duration)>,
    last: Instant,
    outcome: Result<(), Failure>,
}

impl<'a> Saver<'a> {
    fn new(save: Option<(&'a Path, Duration)>) -> Self {
        Saver { save, last: Instant::now(), outcome: Ok(()) }
    }

    fn save(&mut self, map: impl FnOnce() -> MapFile) {
        if let Some((path, every)) = self.save
            && self.outcome.is_ok()
            && self.last.elapsed() >= every
        {
            self.outcome = map().write(path);
            self.last = Instant::now();
        }
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

fn told_of_free(report: &FreeSweepReport, map: &FreeMap) -> Swept {
    let failed = report.failed.iter().map(|failed| format!("{}: {}", place(&failed.node, map), failed.error));
    Swept { failed: failed.collect(), caps: None }
}

/// Threads that this machine runs at once.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Limit pressure (Pa) of a FREE, where it has one.
fn limit_pressure(free: &Free) -> Result<Option<f64>, Failure> {
    let path = fe::SectionSolver::new(free, fe::SectionMesh::default())
        .and_then(|mut solver| solver.path(&[0.0], 0));
    path.map(|path| path.limit_pressure()).map_err(|error| Failure::new(Exit::NotConverged, error))
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

/// What computes a module's map, and the empty map: `nodes` pressures per FREE from zero to `greatest` (Pa), but no nearer to the
/// FREE's limit pressure than nine tenths of it, placed as a spline likes them.
pub fn plan_module(
    rig: &Rig,
    module: &Module,
    greatest: &[f64],
    nodes: usize,
    sweep: &ModuleSweep,
) -> Result<ModuleMap, Failure> {
    let mut pressures: Vec<Vec<f64>> = Vec::new();
    let mut known: Vec<(Free, Option<f64>)> = Vec::new();
    for (placed, greatest) in module.frees.iter().zip(greatest) {
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
        pressures.push(rom::recommended_pressure_nodes(greatest, limit, nodes));
    }
    let source = (rig.name.clone(), rig.text.clone());
    let planned = sweep.empty_map(module.clone(), rig.limits.clone(), pressures, source);
    planned.map_err(|error| Failure::file(error).about(&rig.path))
}

fn told_of_module(report: &ModuleSweepReport) -> Swept {
    let failed = report.failed.iter().map(|failed| {
        let pressures: Vec<String> = failed.pressures.iter().map(|pressure| short(pressure / KPA)).collect();
        format!("at {} kPa: {}", pressures.join(", "), failed.error)
    });
    Swept { failed: failed.collect(), caps: None }
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
