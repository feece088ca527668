use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    goal, interrupt, output,
    progress::Progress,
    sweep,
    workspace_report::{self, failure},
};
use actuator::units::KPA;
use control::{ReachRun, ReachSettings, ReachableSet};
use rom::Model;
use std::path::PathBuf;

/// Compute the reachable set of a module's tip
///
/// All positions that pressures within the limits reach: points with their pressures, how well the tip can be steered there, the outer
/// boundary, the volume with its error, and pictures with the paper's cases as curves. The boundary is the true one, whether it comes from
/// pressures at their limits or, where the map is singular, from between them. The computation is done three times, each twice as fine; the
/// error is the change to the last. DIR receives points.csv, boundary.csv, reach.csv, cases.csv, points.vtu and boundary.vtu (for ParaView)
/// and pictures (SVG, PNG).
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact workspace --model module.model --out reachable
  freeact workspace --model module.model --out reachable --steps 24 --cells 96 --json")]
pub struct Workspace {
    /// The model of a module
    #[arg(long, value_name = "X.model")]
    model: PathBuf,

    /// Directory for the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    /// Steps along each pressure, a multiple of four; between them the map is taken as linear
    #[arg(long, value_name = "N", default_value = "16")]
    steps: usize,

    /// Cells of the lattice that measures the set, along each axis, a multiple of four
    #[arg(long, value_name = "N", default_value = "64")]
    cells: usize,

    /// Points in points.csv along each pressure, both ends among them
    #[arg(long, value_name = "N", default_value = "7", value_parser = clap::value_parser!(u64).range(2..=1000))]
    points: u64,

    /// Distance to keep from limit pressures, beyond the 2 % that the model keeps itself
    #[arg(long, value_name = "KPA", default_value = "0")]
    limit_margin_kpa: f64,

    /// Threads (default: one per processor); the results do not depend on them
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=4096))]
    jobs: Option<u64>,
}

impl Workspace {
    pub fn run(self, json: bool) -> Outcome {
        for (flag, given) in [("--steps", self.steps), ("--cells", self.cells)] {
            if given < 4 || given % 4 != 0 {
                return Err(Failure::usage(format!(
                    "{flag} {given}: give a multiple of four, as half and a quarter of it are computed, too"
                )));
            }
        }
        let model = Model::read(&self.model)?;
        let module = goal::module_of(&model, &self.model)?;
        let bounds = module.bounds(self.limit_margin_kpa * KPA)?;
        let jobs = self.jobs.map_or_else(sweep::processors, |jobs| jobs as usize);
        let finest = ReachSettings { steps: self.steps, cells: self.cells, jobs };
        finest.check(&bounds).map_err(failure)?;
        let points = workspace_report::points(&module, &bounds, self.points as usize)?;
        output::make_directory(&self.out)?;
        workspace_report::write_points(&points, &self.out)?;
        let bar = Progress::bar("reachable set");
        let mut levels = vec![];
        for part in [4, 2, 1] {
            bar.say(&format!("reachable set, {} steps a pressure", self.steps / part));
            let run =
                ReachRun { progress: &|done, total| bar.at(done, total), is_stopped: &interrupt::is_asked };
            let settings = ReachSettings { steps: self.steps / part, cells: self.cells / part, ..finest };
            let set = ReachableSet::compute(&|| module.tip(), &bounds, settings, &run).map_err(failure)?;
            levels.push((settings, set));
        }
        drop(bar);
        let report = workspace_report::Report::of(&module, &bounds, &points, &levels)?;
        report.write(&self.out)?;
        match json {
            true => output::print_json(&report.json(&self.out)),
            false => output::print(&report.text(&self.out)),
        }
        Ok(Exit::Done)
    }
}
