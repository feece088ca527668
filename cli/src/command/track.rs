use crate::{
    command::solve::Prefer,
    exit::Exit,
    failure::{Failure, Outcome},
    goal, interrupt, output,
    progress::Progress,
    run_statistics::RunStatistics,
    shape, solve_log,
};
use actuator::{Rig, units::KPA};
use control::{Blend, Tick, Tolerance, Tracker, Trajectory, read_waypoints};
use record::{LogHeader, LogWriter, Storage, TipTopic};
use rom::Model;
use serde_json::json;
use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

/// Time between two shapes in the log, s: enough for a viewer.
const SHAPE_EVERY: f64 = 0.1;

/// Follow waypoints with the tip of a module and log every solve
///
/// The waypoints are a CSV file with the columns t_s, x_mm, y_mm, z_mm and, if the rotation matters, qw, qx, qy, qz. Between
/// them the tip is led on straight lines. Each tick is solved from the last one within the pressure rate of the description.
/// The log is an MCAP file that ROS 2 tools read, with model and rig attached; `freeact replay` recomputes it bit for bit.
#[derive(clap::Args)]
#[command(after_help = "Example:
  freeact track --model module.model --waypoints path.csv --rate-hz 100 --out run.mcap")]
pub struct Track {
    /// The model of a module
    #[arg(long, value_name = "X.model")]
    model: PathBuf,

    /// Where the tip shall be, and when
    #[arg(long, value_name = "W.csv")]
    waypoints: PathBuf,

    /// Solves a second
    #[arg(long, value_name = "HZ", default_value = "100")]
    rate_hz: f64,

    /// The log
    #[arg(long, value_name = "RUN.mcap")]
    out: PathBuf,

    /// Pressures at the start (default: those that the first waypoint wants)
    #[arg(long, value_name = "P1,P2,..", allow_hyphen_values = true)]
    from_kpa: Option<crate::values::Values>,

    /// Which pressures to take where several reach the target
    #[arg(long, value_enum, default_value = "least-change")]
    prefer: Prefer,

    /// How to move between waypoints
    #[arg(long, value_enum, default_value = "linear")]
    blend: Motion,

    /// Distance to keep from limit pressures, beyond the 2 % that the model keeps itself
    #[arg(long, value_name = "KPA", default_value = "0")]
    limit_margin_kpa: f64,
}

/// A way to move between waypoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Motion {
    /// At constant speed
    Linear,
    /// From rest to rest
    RestToRest,
}

impl Track {
    pub fn run(self, json: bool) -> Outcome {
        let waypoints = read_waypoints(&self.waypoints).map_err(Failure::file)?;
        let blend = match self.blend {
            Motion::Linear => Blend::Linear,
            Motion::RestToRest => Blend::RestToRest,
        };
        let run = Run {
            model_path: &self.model,
            from: self.from_kpa.as_ref(),
            preference: self.prefer.into(),
            margin: self.limit_margin_kpa * KPA,
            out: &self.out,
        };
        let model = Model::read(&self.model)?;
        let length = goal::module_of(&model, &self.model)?.length();
        let trajectory = Trajectory::new(waypoints, self.rate_hz, blend, length)
            .map_err(|error| Failure::usage(error.to_string()))?;
        let statistics = run.follow(&model, &trajectory)?;
        if json {
            let mut value = statistics.json();
            value["out"] = json!(self.out);
            output::print_json(&value);
        } else {
            output::print(&format!(
                "{}: {}\n{}",
                self.out.display(),
                statistics.summary(),
                statistics.table()
            ));
        }
        Ok(if interrupt::is_asked() { Exit::Interrupted } else { statistics.exit() })
    }
}

/// What a run along a trajectory depends on.
pub struct Run<'a> {
    /// The model's file, for messages.
    pub model_path: &'a Path,
    /// Pressures at the start.
    pub from: Option<&'a crate::values::Values>,
    /// Choice among equals.
    pub preference: control::Preference,
    /// Distance to limit pressures, Pa.
    pub margin: f64,
    /// The log.
    pub out: &'a Path,
}

impl Run<'_> {
    /// Follows the trajectory, logs every tick, and says how it went.
    pub fn follow(&self, model: &Model, trajectory: &Trajectory) -> Result<RunStatistics, Failure> {
        let steered = goal::module_of(model, self.model_path)?;
        let from = goal::pressures(self.from, model.frees(), "--from-kpa")?;
        let tip = steered.tip();
        let mut tracker = Tracker::new(
            &tip,
            steered.bounds(self.margin)?,
            self.preference,
            Tolerance::default(),
            steered.pressure_rate(),
            from,
        )
        .map_err(|error| Failure::refused(error.to_string()))?;
        let rig_path = Path::new(&model.provenance.description_name).with_extension("toml");
        let rig = Rig::parse(&rig_path, model.provenance.description_text.clone())?;
        let name = self.out.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let mut header = LogHeader::of(name, &rig).map_err(Failure::file)?;
        header.model = model.to_bytes()?;
        let mut log = LogWriter::create(self.out, &header, &Storage::default()).map_err(Failure::file)?;
        let mut statistics = RunStatistics::default();
        let progress = Progress::bar("tracking");
        let mut broken = None;
        let mut next_shape = f64::NEG_INFINITY;
        let followed = control::track(&mut tracker, trajectory, |tick| {
            let shape_is_due = tick.time >= next_shape;
            if shape_is_due {
                next_shape = tick.time + SHAPE_EVERY;
            }
            let module = shape_is_due.then(|| steered.module());
            if let Err(error) = write(&mut log, &tick, module) {
                broken = Some(error);
                return ControlFlow::Break(());
            }
            statistics.add(&solve_log::record(&tick));
            progress.at(statistics.solves(), trajectory.len());
            if interrupt::is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        followed.map_err(|error| Failure::refused(error.to_string()))?;
        if let Some(error) = broken {
            return Err(Failure::file(error));
        }
        log.finish().map_err(Failure::file)?;
        Ok(statistics)
    }
}

/// Writes what a tick asked for and found.
fn write(
    log: &mut LogWriter,
    tick: &Tick,
    module: Option<&actuator::Module>,
) -> Result<(), record::RecordError> {
    for (free, pressure) in tick.command.iter().enumerate() {
        log.command(tick.time, free, *pressure)?;
    }
    let target = &tick.input.target;
    log.tip(tick.time, TipTopic::Target, target.position, target.rotation.unwrap_or([f64::NAN; 4]))?;
    if let Some(answer) = &tick.solution.answer {
        let pose = answer.pose();
        log.tip(tick.time, TipTopic::Predicted, pose.position.into(), pose.wxyz())?;
        if let Some(module) = module {
            log.shape(tick.time, &shape::of(module, &pose))?;
        }
    }
    log.solve(&solve_log::record(tick))
}
