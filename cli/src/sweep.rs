//! Sweeps of finite elements, told of, saved as they go, and stopped by Ctrl-C.

use crate::{failure::Failure, interrupt, map_file::MapFile, progress::Progress, table::short};
use actuator::{Free, FreeMap, Rig, units::DEG, units::MPA};
use fe::{FreeSweep, FreeSweepReport, Run, Shard};
use std::{
    path::Path,
    time::{Duration, Instant},
};

/// Time between two savings of an unfinished map.
const SAVE_EVERY: Duration = Duration::from_secs(3);

/// What a sweep did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Swept {
    /// States or paths that were not found, and why.
    pub failed: Vec<String>,
}

/// How a sweep is run.
pub struct Sweeping<'a> {
    /// The part to compute.
    pub shard: Shard,
    /// Threads.
    pub jobs: usize,
    /// Where the unfinished map is saved.
    pub save: Option<&'a Path>,
}

impl Sweeping<'_> {
    /// All of it, on every processor, saved nowhere.
    pub fn whole() -> Self {
        Sweeping { shard: Shard::WHOLE, jobs: processors(), save: None }
    }

    /// Computes what is missing of a FREE's map.
    pub fn free(&self, sweep: &FreeSweep, map: &mut FreeMap) -> Result<Swept, Failure> {
        let bar = Progress::bar("computing paths");
        let told = |done, total| bar.at(done, total);
        let run = Run { jobs: self.jobs, progress: &told, stop: interrupt::flag() };
        let mut saver = Saver::new(self.save);
        let mut checkpoint = |map: &FreeMap| saver.save(|| MapFile::Free(map.clone()));
        let report = sweep.fill(map, self.shard, &run, &mut checkpoint).map_err(Failure::file)?;
        saver.outcome?;
        Ok(told_of(&report))
    }
}

/// Saves a map now and then; the first failure to do so is kept for the end.
struct Saver<'a> {
    path: Option<&'a Path>,
    last: Instant,
    outcome: Result<(), Failure>,
}

impl<'a> Saver<'a> {
    fn new(path: Option<&'a Path>) -> Self {
        Saver { path, last: Instant::now(), outcome: Ok(()) }
    }

    fn save(&mut self, map: impl FnOnce() -> MapFile) {
        if let Some(path) = self.path.filter(|_| self.last.elapsed() >= SAVE_EVERY && self.outcome.is_ok()) {
            self.outcome = map().write(path);
            self.last = Instant::now();
        }
    }
}

fn told_of(report: &FreeSweepReport) -> Swept {
    let failed = report.failed.iter().map(|failed| {
        let angle = short(failed.free.winding.angle_from_hoop() / DEG);
        let modulus = short(failed.free.elastomer.shear_modulus() / MPA);
        format!("{angle}° from the hoop, {modulus} MPa: {}", failed.error)
    });
    Swept { failed: failed.collect() }
}

/// Threads that this machine runs at once.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Limit pressure (Pa) of a FREE, where it has one.
pub fn limit_pressure(free: &Free) -> Result<Option<f64>, Failure> {
    let path = fe::SectionSolver::new(free, fe::SectionMesh::default())
        .and_then(|mut solver| solver.path(&[0.0], 0));
    path.map(|path| path.limit_pressure())
        .map_err(|error| Failure::new(crate::exit::Exit::NotConverged, error))
}

/// An empty map of a FREE over the given axes (SI).
pub fn plan_free(
    sweep: &FreeSweep,
    rig: &Rig,
    free: Free,
    [angles, moduli, pressures]: [Vec<f64>; 3],
) -> Result<FreeMap, Failure> {
    let source = (rig.name.clone(), rig.text.clone());
    let planned = sweep.empty_map(free, angles, moduli, pressures, source);
    planned.map_err(|error| Failure::file(error).about(&rig.path))
}
