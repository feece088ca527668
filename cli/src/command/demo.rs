use crate::{
    command::{fit::fit, identify::identified, replay, track::Run},
    content::Content,
    exit::Exit,
    failure::{Failure, Outcome},
    goal, identify_report, interrupt,
    map_file::MapFile,
    output, simulated_rig,
    sweep::{self, Sweeping},
    table::{Table, duration, short},
};
use actuator::{
    Description, MapAxis, Rig,
    units::{DEG, GRAM, KPA, MM, MPA},
};
use control::{Blend, Preference, SolveInput, Solver, Status, Target, Trajectory, Waypoint};
use fe::{FreeSweep, ModuleSweep};
use record::{LogHeader, Recording, Storage};
use rom::{Model, PoseEvaluation, PoseModel};
use serde_json::json;
use std::{
    path::{Path, PathBuf},
    time::Instant,
};

/// Everything once, on a small case, from nothing
///
/// Maps the single FREE of Buffinton et al. 2020 and its 30 degree module by finite elements, fits models, finds pressures for
/// targets, follows a path, replays its log bit for bit, and finds out from simulated recordings what was put into a rig.
/// Takes well under a minute and leaves all files and pictures in DIR.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  freeact demo --out freeact-demo")]
pub struct Demo {
    /// Directory for the files
    #[arg(long, value_name = "DIR", default_value = "freeact-demo")]
    out: PathBuf,
}

const FREE_TEXT: &str = include_str!("../../../data/actuators/buffinton-2020.toml");
const MODULE_TEXT: &str = include_str!("../../../data/modules/buffinton-2020-30lr.toml");

/// Pressures per FREE of the small module map, and the greatest, Pa.
const NODES: usize = 5;
const GREATEST: f64 = 50.0 * KPA;
/// Targets to find pressures for.
const TARGETS: usize = 25;
/// The path: a circle of this radius (m), once in this time (s), solved this often a second.
const CIRCLE: (f64, f64, f64) = (3.0 * MM, 4.0, 50.0);

/// What was done, for the closing table.
struct Done {
    what: &'static str,
    result: String,
    files: &'static str,
    seconds: f64,
}

impl Demo {
    pub fn run(self, json: bool) -> Outcome {
        let start = Instant::now();
        output::make_directory(&self.out)?;
        let mut done: Vec<Done> = Vec::new();
        let mut last = Instant::now();
        let mut tell = |what: &'static str, files: &'static str, result: String| -> Result<(), Failure> {
            if interrupt::is_asked() {
                return Err(Failure::interrupted());
            }
            let seconds = last.elapsed().as_secs_f64();
            last = Instant::now();
            if !json {
                output::print(&format!("{what}: {result} ({})\n", duration(seconds)));
            }
            done.push(Done { what, result, files, seconds });
            Ok(())
        };
        let file = |name: &str| self.out.join(name);

        output::save(&file("free.toml"), FREE_TEXT.as_bytes())?;
        let result = free_map(&file("free.map"))?;
        tell("map a FREE", "free.map", result)?;
        let result = free_model(&self.out)?;
        tell("fit the FREE", "free.model, pictures/*", result)?;

        output::save(&file("module.toml"), MODULE_TEXT.as_bytes())?;
        let rig = Rig::parse(&file("module.toml"), MODULE_TEXT.to_owned())?;
        let result = module_map(&rig, &file("module.map"))?;
        tell("map a module", "module.map", result)?;
        let (model, result) = module_model(&self.out)?;
        tell("fit the module", "module.model, pictures/*", result)?;
        tell("solve for targets", "", solve(&model, &file("module.model"))?)?;
        let result = follow(&model, &self.out)?;
        tell("follow a circle", "circle.mcap", result)?;
        let (identical, result) = replayed(&self.out)?;
        tell("replay its log", "circle.html", result)?;

        let recordings = simulate(&rig, &model, &self.out)?;
        let injected = format!(
            "{} recordings; put in: a supply that lags by {} s and {} g on the tip plate",
            recordings.len(),
            simulated_rig::TIME_CONSTANT,
            short(simulated_rig::PAYLOAD / GRAM)
        );
        tell("simulate a rig", "rig/*.mcap", injected)?;
        let (found, result) = find(&rig, &model, &recordings, &file("rig"))?;
        tell("find what it lacks", "rig/report.html", result)?;

        let seconds = start.elapsed().as_secs_f64();
        if json {
            let steps = done.iter().map(
                |d| json!({ "what": d.what, "result": d.result, "files": d.files, "seconds": d.seconds }),
            );
            output::print_json(&json!({
                "out": self.out, "steps": steps.collect::<Vec<_>>(), "replay_identical": identical,
                "verdict": found.verdict.verdict, "effects": found.verdict.effects, "seconds": seconds,
            }));
        } else {
            let mut table = Table::new(["<step", "time", "<files", "<result"]);
            for step in &done {
                table.row([step.what.into(), duration(step.seconds), step.files.into(), step.result.clone()]);
            }
            output::print(&format!(
                "\nWhat was found out about the simulated rig\n\n{}\nWhat was done\n\n{}\n  all in {}, in {}\n",
                identify_report::text(&found.verdict),
                table.text(),
                self.out.display(),
                duration(seconds)
            ));
        }
        Ok(if identical { Exit::Done } else { Exit::Disagrees })
    }
}

fn free_map(path: &Path) -> Result<String, Failure> {
    let rig = Rig::parse(Path::new("free.toml"), FREE_TEXT.to_owned())?;
    let sweep = FreeSweep::default();
    let angles = (1..=8).map(|i| f64::from(i) * 10.0 * DEG).collect();
    let moduli = vec![0.1965 * MPA, 0.393 * MPA, 0.786 * MPA];
    let pressures = (0..=14).map(|i| f64::from(i) * 5.0 * KPA).collect();
    let axes = MapAxis::of_angles_and_moduli(angles, moduli);
    let mut map = sweep::plan_free(&sweep, &rig, axes, pressures)?;
    Sweeping::whole().paths(&sweep, &mut map)?;
    let states: usize = map.paths.iter().flatten().map(|path| path.states.len()).sum();
    let limit = |i: usize| {
        map.path(i, 1).and_then(|path| path.limit_pressure()).map_or("none".into(), |p| short(p / KPA))
    };
    let result = format!(
        "{} paths, {states} states; limit pressure {} kPa at 20°, {} kPa at 70°",
        map.paths.iter().flatten().count(),
        limit(1),
        limit(6)
    );
    MapFile::Free(map).write(path)?;
    Ok(result)
}

fn free_model(directory: &Path) -> Result<String, Failure> {
    let map = MapFile::read(&directory.join("free.map"))?;
    let model = fit(&map)?;
    model.write(&directory.join("free.model"))?;
    let pictures = directory.join("pictures");
    output::make_directory(&pictures)?;
    for (stem, chart) in map.charts() {
        chart.write(&pictures, &stem)?;
    }
    let errors = model.as_free().map(|free| free.errors().held_out).unwrap_or_default();
    Ok(format!(
        "on {} states never fitted: stretch within {}, twist within {} %",
        errors.axial_stretch.count,
        short(errors.axial_stretch.worst),
        short(100.0 * errors.twist_per_length.worst)
    ))
}

fn module_map(rig: &Rig, path: &Path) -> Result<String, Failure> {
    let Description::Module(module) = &rig.description else {
        return Err(Failure::refused("the demonstration's module is not one"));
    };
    let sweep = ModuleSweep { checks: 20, ..ModuleSweep::default() };
    let frees = module.frees.len();
    let mut map = sweep::plan_module(rig, module, &vec![GREATEST; frees], &vec![NODES; frees], &sweep)?;
    let swept = Sweeping::whole().rows(&sweep, &mut map)?;
    if let Some(failed) = swept.failed.first() {
        return Err(Failure::new(Exit::NotConverged, format!("the module's map: {failed}")));
    }
    let result = format!(
        "{} states of {} FREEs up to {} kPa",
        map.node_count(),
        module.frees.len(),
        short(GREATEST / KPA)
    );
    MapFile::Module(map).write(path)?;
    Ok(result)
}

fn module_model(directory: &Path) -> Result<(Model, String), Failure> {
    let map = MapFile::read(&directory.join("module.map"))?;
    let model = fit(&map)?;
    model.write(&directory.join("module.model"))?;
    for (stem, chart) in map.charts() {
        chart.write(&directory.join("pictures"), &stem)?;
    }
    let errors = model.as_module().map(|module| module.errors().clone()).unwrap_or_default();
    let result = format!(
        "on {} states never fitted: position within {} mm, rotation within {}°",
        errors.position.count,
        short(errors.position.worst / MM),
        short(errors.rotation.worst / DEG)
    );
    Ok((model, result))
}

/// Pressures for targets that are poses of scattered pressures.
fn solve(model: &Model, path: &Path) -> Result<String, Failure> {
    let steered = goal::module_of(model, path)?;
    let tip = steered.tip();
    let frees = model.frees();
    let mut solver = Solver::new(&tip);
    let mut into = PoseEvaluation::new(frees, 0);
    let (mut reached, mut worst, mut times) = (0, 0.0f64, Vec::new());
    for n in 1..=TARGETS {
        // A Weyl sequence: evenly scattered, the same every time.
        let share = |free: usize| (n as f64 * (2.0 + free as f64).sqrt()).fract();
        let pressures: Vec<f64> = tip
            .domain()
            .iter()
            .enumerate()
            .map(|(free, (low, high))| low + share(free) * (high - low))
            .collect();
        tip.evaluate(&pressures, &mut into).map_err(|error| Failure::refused(error.to_string()))?;
        let target = Target::at(into.chart.to_pose().position.into());
        let start = Instant::now();
        let solution = solver.solve(&SolveInput::new(target, steered.bounds(0.0)?));
        times.push(start.elapsed().as_secs_f64());
        reached += usize::from(solution.status == Status::Reached);
        worst = worst.max(solution.answer.map_or(f64::INFINITY, |answer| answer.position_error));
    }
    times.sort_by(f64::total_cmp);
    Ok(format!(
        "{reached} of {TARGETS} reached, off by {} mm at most; median {}",
        short(worst / MM),
        duration(times[TARGETS / 2])
    ))
}

fn follow(model: &Model, directory: &Path) -> Result<String, Failure> {
    let model_path = directory.join("module.model");
    let steered = goal::module_of(model, &model_path)?;
    let tip = steered.tip();
    // About the pose in the middle of the pressures, so that the circle is inside the workspace.
    let middle: Vec<f64> = tip.domain().iter().map(|(low, high)| 0.5 * (low + high)).collect();
    let mut into = PoseEvaluation::new(model.frees(), 0);
    tip.evaluate(&middle, &mut into).map_err(|error| Failure::refused(error.to_string()))?;
    let centre = into.chart.to_pose().position;
    let (radius, period, rate) = CIRCLE;
    let corner = |i: u32| {
        let share = f64::from(i) / 48.0;
        let (sine, cosine) = (std::f64::consts::TAU * share).sin_cos();
        Waypoint {
            time: share * period,
            position: [centre.x + radius * cosine, centre.y + radius * sine, centre.z],
            rotation: None,
        }
    };
    let waypoints: Vec<Waypoint> = (0..=48).map(corner).collect();
    let trajectory =
        Trajectory::new(waypoints, rate, Blend::Linear, steered.length()).map_err(Failure::file)?;
    let out = directory.join("circle.mcap");
    let run = Run {
        model_path: &model_path,
        from: None,
        preference: Preference::LeastChange,
        margin: 0.0,
        out: &out,
    };
    let statistics = run.follow(model, &trajectory)?;
    Ok(format!(
        "{}, off by {} mm at most; median {}",
        statistics.summary(),
        short(statistics.worst_position() / MM),
        duration(statistics.median_time())
    ))
}

fn replayed(directory: &Path) -> Result<(bool, String), Failure> {
    let path = directory.join("circle.mcap");
    let log = record::read_mcap(&path, None).map_err(Failure::file)?;
    let model = Model::from_bytes(&path, log.model.as_deref().unwrap_or_default())?;
    let replayed = replay::recompute(&log, &model, &path)?;
    replay::page(&log, &replayed)?.save(&directory.join("circle.html"))?;
    for (i, (chart, _)) in replay::charts(&log.solves).iter().enumerate() {
        chart.write(&directory.join("pictures"), &format!("circle-{}", i + 1))?;
    }
    Ok((replayed.different.is_empty(), replayed.verdict()))
}

fn simulate(rig: &Rig, model: &Model, directory: &Path) -> Result<Vec<Recording>, Failure> {
    let directory = directory.join("rig");
    output::make_directory(&directory)?;
    output::save(&directory.join("rig.toml"), MODULE_TEXT.as_bytes())?;
    let Some(module) = model.as_module() else {
        return Err(Failure::refused("the demonstration's module is not one"));
    };
    let effects = simulated_rig::effects(model.frees());
    let mut recordings = Vec::new();
    for commands in simulated_rig::Commands::ALL {
        let recording = simulated_rig::record(commands, rig, module, &effects, GREATEST)?;
        let header = LogHeader::of(commands.name(), rig).map_err(Failure::file)?;
        let path = directory.join(commands.name()).with_extension("mcap");
        record::write_mcap(&path, &recording, &header, &Storage::default()).map_err(Failure::file)?;
        recordings.push(recording);
    }
    Ok(recordings)
}

fn find(
    rig: &Rig,
    model: &Model,
    recordings: &[Recording],
    directory: &Path,
) -> Result<(identify::Outcome, String), Failure> {
    // The last is of another kind than the others, and is judged on.
    let (fitted, held_out) = recordings.split_at(recordings.len() - 1);
    let found = identified(rig, model.clone(), fitted, held_out, directory, Instant::now())?;
    let names: Vec<String> = found
        .verdict
        .effects
        .iter()
        .map(|effect| {
            let numbers = effect
                .parameters
                .iter()
                .map(|(name, estimated)| format!("{name} {}", short(estimated.value)));
            format!("{} ({})", effect.name, numbers.collect::<Vec<_>>().join(", "))
        })
        .collect();
    let result = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
    Ok((found, format!("found: {result}")))
}
