use crate::{
    base_model,
    exit::Exit,
    failure::{Failure, Outcome},
    identify_report, interrupt, output,
    progress::Progress,
    recordings,
    table::duration,
};
use actuator::{Description, Rig};
use identify::{
    FreeMechanics, IdentifyError, ModuleMechanics, Options, Watch, identify_free, identify_module,
};
use record::Recording;
use rom::{Model, ModelContent};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};

/// Find out from recordings what a model of a rig lacks
///
/// The model from the description alone is calibrated within its own tolerances; then physical effects (lag of the supply,
/// hysteresis, payload, stiffness, ...) are tried one by one and kept only if they improve the prediction of recordings that
/// took no part in the fit (--holdout). A single FREE needs no --holdout: it is judged by parts of its loading and unloading that
/// each fit leaves out.
///
/// Leaves in DIR: identify.json, report.html, corrected.model, and base.map and base.model, which a second run reuses.
#[derive(clap::Args)]
#[command(after_help = "Example:
  freeact identify --rig rig.toml --recordings 1.csv,2.csv,3.csv --holdout 4.csv --out found")]
pub struct Identify {
    /// Description of the rig
    #[arg(long, value_name = "RIG.toml")]
    rig: PathBuf,

    /// Recordings to fit, CSV or MCAP
    #[arg(long, value_name = "A,B,..", value_delimiter = ',', required = true)]
    recordings: Vec<PathBuf>,

    /// Recordings to judge on; they take no part in the fit
    #[arg(long, value_name = "C,..", value_delimiter = ',')]
    holdout: Vec<PathBuf>,

    /// Directory for the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    /// The model of the rig (default: computed from the description)
    #[arg(long, value_name = "X.model")]
    model: Option<PathBuf>,
}

impl Identify {
    pub fn run(self, json: bool) -> Outcome {
        let start = Instant::now();
        let rig = Rig::read(&self.rig)?;
        self.check_overlap()?;
        let fit = load(&self.recordings, &rig)?;
        let held_out = load(&self.holdout, &rig)?;
        if held_out.is_empty() && matches!(rig.description, Description::Module(_)) {
            return Err(Failure::usage(
                "--holdout is missing: give at least one recording of another kind that takes no part in the fit, or the \
                 errors would be told on fitted data",
            ));
        }
        // Before the minutes that a base map takes.
        if !held_out.is_empty() && matches!(rig.description, Description::Free(_)) {
            return Err(holdout_of_a_free());
        }
        check_recordings(&rig, &fit, &held_out)?;
        output::make_directory(&self.out)?;
        let base = match &self.model {
            Some(path) => Model::read(path)?,
            None => base_model::of(&rig, &self.out)?,
        };
        let outcome = identified(&rig, base, &fit, &held_out, &self.out, start)?;
        match json {
            true => output::print_json(&serde_json::json!(outcome.verdict)),
            false => output::print(&format!(
                "{}\n  {} holds identify.json, report.html and corrected.model; {}\n",
                identify_report::text(&outcome.verdict),
                self.out.display(),
                duration(outcome.verdict.seconds)
            )),
        }
        Ok(Exit::Done)
    }

    fn check_overlap(&self) -> Result<(), Failure> {
        let real = |path: &PathBuf| path.canonicalize().unwrap_or_else(|_| path.clone());
        match self.holdout.iter().find(|held| self.recordings.iter().any(|fit| real(fit) == real(held))) {
            None => Ok(()),
            Some(both) => Err(Failure::usage(format!(
                "{} is in --recordings and in --holdout; a held-out recording must take no part in the fit",
                both.display()
            ))),
        }
    }
}

/// What would be refused after the base map, of what can be told before it.
fn check_recordings(rig: &Rig, fit: &[Recording], held_out: &[Recording]) -> Result<(), Failure> {
    if let Some(both) = held_out.iter().find(|held| fit.iter().any(|fit| fit.name == held.name)) {
        let recording = both.name.clone();
        return Err(Failure::usage(IdentifyError::Overlap { recording }.to_string()));
    }
    let has_no_pose = |recording: &&Recording| (0..recording.len()).all(|i| recording.pose(i).is_none());
    let of_module = matches!(rig.description, Description::Module(_));
    match fit.iter().chain(held_out).find(has_no_pose).filter(|_| of_module) {
        None => Ok(()),
        Some(blind) => Err(Failure::file(format!(
            "recording \"{}\" holds no pose of the tip, so that there is nothing to compare a model with; name the columns or \
             the topic of the pose in [recordings] of {}, or leave the recording out",
            blind.name,
            rig.path.display()
        ))),
    }
}

fn holdout_of_a_free() -> Failure {
    Failure::usage(
        "--holdout is for modules: a single FREE has few points, and is judged by parts of its own recordings that each \
         fit leaves out; give all of them by --recordings",
    )
}

fn load(paths: &[PathBuf], rig: &Rig) -> Result<Vec<Recording>, Failure> {
    paths.iter().map(|path| recordings::read(path, rig).map(|loaded| loaded.recording)).collect()
}

/// Identifies what the base model of a rig lacks, and leaves the results in a directory.
pub fn identified(
    rig: &Rig,
    base: Model,
    fit: &[Recording],
    held_out: &[Recording],
    directory: &Path,
    start: Instant,
) -> Result<identify::Outcome, Failure> {
    let wheel = Progress::wheel("identifying");
    let tell = |line: &str| wheel.say(line);
    let watch = Watch { tell: &tell, stop: interrupt::flag() };
    let options = Options::default();
    let found = match (&base.content, &rig.description) {
        (ModelContent::Module(model), Description::Module(module)) => {
            let mechanics = ModuleMechanics::new(model, model.parameters(), module);
            identify_module(&mechanics, fit, held_out, &options, &watch)
        }
        (ModelContent::Free(_), Description::Free(_)) if !held_out.is_empty() => {
            return Err(holdout_of_a_free());
        }
        (ModelContent::Free(model), Description::Free(free)) => {
            identify_free(&FreeMechanics::new(model, *free), fit, &options.tolerances, &watch)
        }
        _ => {
            return Err(Failure::usage(format!(
                "{}: the model is of another kind of actuator than the rig describes",
                rig.path.display()
            )));
        }
    };
    drop(wheel);
    let mut found = found.map_err(|error| match error {
        IdentifyError::Stopped => Failure::interrupted(),
        error => Failure::file(error).about(&rig.path),
    })?;
    found.verdict.seconds = start.elapsed().as_secs_f64();
    let text = format!("{:#}\n", serde_json::json!(found.verdict));
    output::save(&directory.join("identify.json"), text.as_bytes())?;
    identify_report::page(&rig.name, &found)?.save(&directory.join("report.html"))?;
    let corrected = Model { effects: found.chain.clone(), ..base };
    corrected.write(&directory.join("corrected.model"))?;
    Ok(found)
}
