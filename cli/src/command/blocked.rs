use super::solve::rotation;
use crate::{
    blocked_report::Report,
    exit::Exit,
    failure::{Failure, Outcome},
    interrupt, output,
    progress::Progress,
    sweep,
    values::{Values, numbers},
};
use actuator::{
    Description, Free, Module, PoseChart, Rig, TipPose,
    units::{KPA, MM},
};
use fe::{BendingSweep, BlockedForces, BlockedSweep, ModuleSweepError, Run};
use std::path::PathBuf;

/// Compute blocked forces: what a FREE or a module gives to a plate that is held
///
/// The tip plate is held at a pose, by default that of rest, and the wrench of the FREEs on it is computed over their pressures: force, and
/// moment about the plate's centre, in the base frame. A positive fz pushes the plate away from the base; mz is positive like a twist.
/// Weights of plate and payload are not in it.
///
/// Of a module without spacers the wrenches are all sums of one of each FREE; with spacers the whole is solved at every combination
/// of pressures. Beside them stands the zonotope of Bruder et al. (2018), the set made linear at the pose, and how far it is off. Of a FREE
/// force and torque are those of its section, at the stretch and twist that a pose along its axis gives.
///
/// Into --out go wrenches.csv, blocked.json (generators, corners, outlines, areas) and pictures of the sets.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact blocked --of data/modules/buffinton-2020-60lr.toml --out blocked
  freeact blocked --of data/modules/buffinton-2020-30lr.toml --out pulled --pose-mm 0,0,180 --rotation 0.998,0,0,-0.06
  freeact blocked --of data/actuators/buffinton-2020.toml --out blocked --pressure-max-kpa 60 --steps 30")]
pub struct Blocked {
    /// Description of a FREE or a module
    #[arg(long, value_name = "FREE_OR_MODULE.toml")]
    of: PathBuf,

    /// Directory for the table, the sets and the pictures
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    /// Where the centre of the tip plate is held, in the base frame (default: at rest)
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    pose_mm: Option<[f64; 3]>,

    /// How the plate is turned: quaternion from its frame to the base frame, by less than half a turn (default: not)
    #[arg(long, value_name = "W,X,Y,Z", value_parser = rotation, allow_hyphen_values = true)]
    rotation: Option<[f64; 4]>,

    /// Greatest pressure, one for all or one per FREE (default: the description's)
    #[arg(long, value_name = "KPA", allow_hyphen_values = true)]
    pressure_max_kpa: Option<Values>,

    /// Steps from zero to the greatest pressure of each FREE (default: 20, or as many as make about 2500 combinations)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    steps: Option<u64>,

    /// Bending and shear of a module's FREEs: what decides where they buckle, and what they give where the plate is shifted or turned
    #[arg(long, value_enum, default_value_t = Bending::Tube)]
    bending: Bending,
}

/// Where bending and shear stiffness come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Bending {
    /// 3 mu I and mu A of the bare tube: quick; calls FREEs unstable that pull more than mu A
    Tube,
    /// Solids under pressure, as for a module's map: seconds to minutes more; what stability is to be judged by
    Solids,
}

/// More combinations than this are a slip of the pen.
const MOST_STATES: usize = 200_000;
/// Most steps by default.
const USUAL_STEPS: usize = 20;
/// Stretch of the plate's distance that is taken for a slip of units.
const HEIGHTS: std::ops::RangeInclusive<f64> = 0.5..=2.0;

impl Blocked {
    pub fn run(self, json: bool) -> Outcome {
        let rig = Rig::read(&self.of)?;
        let count = rig.frees().len();
        let greatest = self.greatest(&rig.limits.pressure_max)?;
        let steps = self
            .steps
            .map_or_else(|| (sweep::usual_nodes(count).max(2) - 1).min(USUAL_STEPS), |steps| steps as usize);
        let combinations = (0..count).try_fold(1usize, |all, _| all.checked_mul(steps + 1));
        if combinations.is_none_or(|all| all > MOST_STATES) {
            return Err(Failure::usage(format!(
                "--steps {steps}: that makes more than {MOST_STATES} combinations of {count} pressures; take fewer"
            )));
        }
        let axis = |top: &f64| (0..=steps).map(|i| top * i as f64 / steps as f64).collect();
        let pressures: Vec<Vec<f64>> = greatest.iter().map(axis).collect();
        let length = match &rig.description {
            Description::Free(free) => free.tube.length,
            Description::Module(module) => module.length(),
        };
        let pose = self.pose(length)?;
        let forces = match &rig.description {
            Description::Free(free) => self.free(free, &pose, pressures)?,
            Description::Module(module) => {
                // Before the work, not missed after it.
                output::make_directory(&self.out)?;
                self.module(module, &pose, pressures)?
            }
        };
        output::make_directory(&self.out)?;
        let report = Report::new(&rig.name, &pose, &forces);
        let files = report.write(&self.out)?;
        match json {
            true => output::print_json(&report.json(&files)),
            false => output::print(&report.text(&self.out, &files)),
        }
        Ok(if forces.states.iter().all(Option::is_some) { Exit::Done } else { Exit::NotConverged })
    }

    /// Greatest pressure of each FREE, Pa.
    fn greatest(&self, own: &[f64]) -> Result<Vec<f64>, Failure> {
        let Some(Values(given)) = &self.pressure_max_kpa else { return Ok(own.to_vec()) };
        if let Some(wrong) = given.iter().find(|kpa| **kpa <= 0.0) {
            return Err(Failure::usage(format!("--pressure-max-kpa: {wrong} is not positive")));
        }
        match given.len() {
            1 => Ok(vec![given[0] * KPA; own.len()]),
            count if count == own.len() => Ok(given.iter().map(|kpa| kpa * KPA).collect()),
            count => Err(Failure::usage(format!(
                "--pressure-max-kpa: {count} pressures for {} FREEs; give one, or one for each",
                own.len()
            ))),
        }
    }

    fn pose(&self, length: f64) -> Result<TipPose, Failure> {
        let position = self.pose_mm.map_or([0.0, 0.0, length], |mm| mm.map(|mm| mm * MM));
        if !HEIGHTS.contains(&(position[2] / length)) {
            return Err(Failure::usage(format!(
                "--pose-mm: the plate would be {} mm above the base of a module {} mm long; give a height between half and twice that",
                position[2] / MM,
                length / MM
            )));
        }
        let turned = self.rotation.unwrap_or([1.0, 0.0, 0.0, 0.0]);
        TipPose::from_parts(position, turned).ok_or_else(|| Failure::usage("--rotation: no direction"))
    }

    fn free(
        &self,
        free: &Free,
        pose: &TipPose,
        mut pressures: Vec<Vec<f64>>,
    ) -> Result<BlockedForces, Failure> {
        let chart = PoseChart::from_pose(pose, 0.0);
        let aside = pose.position.x.hypot(pose.position.y);
        if aside > 1e-9 * free.tube.length || chart.bend[0].hypot(chart.bend[1]) > 1e-9 {
            return Err(Failure::usage(format!(
                "{}: a single FREE's blocked force is that of its section: hold it on its axis (--pose-mm 0,0,Z, --rotation W,0,0,Z), or \
                 describe it as a module of one FREE",
                self.of.display()
            )));
        }
        let length = free.tube.length;
        let held = [pose.position.z / length, chart.twist / length];
        BlockedSweep::free(free, held, pressures.swap_remove(0)).map_err(|error| self.failed(error))
    }

    fn module(
        &self,
        module: &Module,
        pose: &TipPose,
        pressures: Vec<Vec<f64>>,
    ) -> Result<BlockedForces, Failure> {
        let bending = (self.bending == Bending::Solids).then(BendingSweep::default);
        let sweep = BlockedSweep { bending, ..BlockedSweep::default() };
        let progress = Progress::bar("wrenches");
        let told = |done: usize, total: usize| progress.at(done, total);
        let run = Run { jobs: sweep::processors(), progress: &told, stop: interrupt::flag() };
        let chart = PoseChart::from_pose(pose, 0.0);
        let forces = sweep.module(module, &chart, pressures, &run).map_err(|error| self.failed(error))?;
        forces.ok_or_else(Failure::interrupted)
    }

    fn failed(&self, error: ModuleSweepError) -> Failure {
        Failure::new(Exit::NotConverged, error).about(&self.of)
    }
}
