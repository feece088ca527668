use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    goal, interrupt, output,
    plot::{Chart, Mark, Series, thin},
    progress::Progress,
    report::Page,
    run_statistics::RunStatistics,
    solve_log,
    table::{duration, short},
};
use actuator::units::{KPA, MM};
use control::{Bounds, Solver};
use record::{FindingKind, Log, SolveRecord, read_mcap};
use rom::Model;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Points that a curve of the report is drawn with.
const POINTS: usize = 1500;

/// Compute every solve of a log again and compare bit for bit
///
/// The model is the one attached to the log, or the one given with --model (then the answers may differ, and how many do is
/// told). Prints errors, limits and times; --html writes them as a page with plots. Exit code 1 when a solve differs.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  freeact replay run.mcap --html run.html")]
pub struct Replay {
    /// The log
    #[arg(value_name = "RUN.mcap")]
    log: PathBuf,

    /// Another model than the attached one
    #[arg(long, value_name = "X.model")]
    model: Option<PathBuf>,

    /// A report: one page that needs nothing else
    #[arg(long, value_name = "REPORT.html")]
    html: Option<PathBuf>,
}

/// What a second computation of a log came to.
pub struct Replayed {
    /// How the run went.
    pub statistics: RunStatistics,
    /// Times (s) of the solves that came out otherwise.
    pub different: Vec<f64>,
}

impl Replay {
    pub fn run(self, json: bool) -> Outcome {
        let log = read_mcap(&self.log, None).map_err(Failure::file)?;
        let model = match (&self.model, &log.model) {
            (Some(path), _) => Model::read(path)?,
            (None, Some(bytes)) => Model::from_bytes(&self.log.join("model"), bytes)?,
            (None, None) => {
                return Err(Failure::usage(format!(
                    "{}: no model is attached to this log; give the one it was made with by --model",
                    self.log.display()
                )));
            }
        };
        // Of a model that cannot be steered, its own file is to blame.
        goal::module_of(&model, self.model.as_deref().unwrap_or(&self.log))?;
        let replayed = recompute(&log, &model, &self.log)?;
        if let Some(html) = &self.html {
            page(&log, &replayed)?.save(html)?;
        }
        if json {
            let mut value = replayed.statistics.json();
            value["identical"] = json!(replayed.different.is_empty());
            value["different"] = json!(replayed.different.len());
            value["first_difference_s"] = json!(replayed.different.first());
            output::print_json(&value);
        } else {
            // That a run without sensors recorded nothing measured is no news.
            let news = log.findings.list.iter().filter(|finding| finding.kind != FindingKind::NotRecorded);
            let findings: String = news.map(|finding| format!("  {}\n", finding.message)).collect();
            output::print(&format!(
                "{}: {}\n  {}\n{}{findings}",
                self.log.display(),
                replayed.statistics.summary(),
                replayed.verdict(),
                replayed.statistics.table()
            ));
        }
        Ok(match replayed.different.is_empty() {
            _ if interrupt::is_asked() => Exit::Interrupted,
            true => Exit::Done,
            false => Exit::Disagrees,
        })
    }
}

impl Replayed {
    /// Whether the log was met, in a sentence.
    pub fn verdict(&self) -> String {
        match self.different.first() {
            None => format!("all {} solves came out again bit for bit", self.statistics.solves()),
            Some(first) => format!(
                "{} of {} solves came out otherwise, first at {} s: another model, another program version or a damaged log",
                self.different.len(),
                self.statistics.solves(),
                short(*first)
            ),
        }
    }
}

/// Computes the solves of a log again.
pub fn recompute(log: &Log, model: &Model, path: &Path) -> Result<Replayed, Failure> {
    if log.solves.is_empty() {
        return Err(Failure::file(format!(
            "{}: there are no solves in this log to compute again; logs of `freeact track` have them on the topic /solve",
            path.display()
        )));
    }
    let steered = goal::module_of(model, path)?;
    let tip = steered.tip();
    let mut solver = Solver::new(&tip);
    let mut replayed = Replayed { statistics: RunStatistics::default(), different: Vec::new() };
    let progress = Progress::bar("replaying");
    for solve in &log.solves {
        if interrupt::is_asked() {
            break;
        }
        let input = solve_log::input(solve).map_err(|message| {
            Failure::file(format!("{}: {message}; it was not written by this program", path.display()))
        })?;
        if !solve_log::is_same(solve, &solver.solve(&input)) {
            replayed.different.push(solve.time);
        }
        replayed.statistics.add(solve);
        progress.at(replayed.statistics.solves(), log.solves.len());
    }
    Ok(replayed)
}

/// The report of a run.
pub fn page(log: &Log, replayed: &Replayed) -> Result<Page, Failure> {
    let statistics = &replayed.statistics;
    let mut page = Page::new(
        &format!("Run \"{}\"", log.recording.name),
        &format!(
            "{} solves over {}",
            log.solves.len(),
            duration(log.solves.last().map_or(0.0, |solve| solve.time))
        ),
    );
    page.lead(&format!("{}; {}.", statistics.summary(), replayed.verdict()));
    page.section("Errors and pressures");
    page.figures(&charts(&log.solves))?;
    page.section("Numbers");
    let json = statistics.json();
    let number = |name: &str| json[name].as_f64().map_or("–".into(), short);
    let rows = [
        ("distance from the target, rms (mm)", "position_error_rms_mm"),
        ("distance from the target, worst (mm)", "position_error_max_mm"),
        ("angle from the target, rms (°)", "rotation_error_rms_deg"),
        ("angle from the target, worst (°)", "rotation_error_max_deg"),
        ("least distance of a pressure to a limit (kPa)", "limit_margin_min_kpa"),
        ("solves held by a bound", "held_by_a_bound"),
    ];
    let mut rows: Vec<Vec<String>> =
        rows.iter().map(|(what, name)| vec![(*what).to_owned(), number(name)]).collect();
    for (what, name) in [("median", "median"), ("99 % below", "p99"), ("worst", "max")] {
        rows.push(vec![
            format!("time of a solve, {what} (µs)"),
            json["time_us"][name].as_f64().map_or("–".into(), short),
        ]);
    }
    page.table(&["<", "value"], &rows);
    page.section("The log");
    let counts = log.message_counts.iter().map(|(topic, count)| vec![topic.clone(), count.to_string()]);
    page.table(&["<topic", "messages"], &counts.collect::<Vec<_>>());
    for finding in log.findings.list.iter().filter(|finding| finding.kind != FindingKind::NotRecorded) {
        page.paragraph(&finding.message);
    }
    Ok(page)
}

/// Charts of a run, each with what it shows.
pub fn charts(solves: &[SolveRecord]) -> Vec<(Chart, String)> {
    let against_time = |value: &dyn Fn(&SolveRecord) -> f64| {
        thin(solves.iter().map(|solve| (solve.time, value(solve))).collect(), POINTS)
    };
    let error = Chart::new("Distance from the target", "time (s)", "distance (µm)").with(Series::new(
        "",
        Mark::Line,
        against_time(&|solve| solve.position_residual * 1e6),
    ));
    let mut pressures = Chart::new("Pressures and their bounds", "time (s)", "pressure (kPa)");
    let frees = solves.first().map_or(0, |solve| solve.pressure_max.len());
    let at = |list: &[f64], free: usize| list.get(free).map_or(f64::NAN, |pressure| pressure / KPA);
    for free in 0..frees {
        let points = against_time(&|solve| at(&solve.pressure, free));
        pressures = pressures.with(Series::new(format!("FREE {}", free + 1), Mark::Line, points));
    }
    let least = |list: &[f64]| list.iter().copied().fold(f64::INFINITY, f64::min) / KPA;
    let of_bounds = |value: fn(&Bounds) -> &Vec<f64>| {
        against_time(&|solve| solve_log::input(solve).map_or(f64::NAN, |input| least(value(&input.bounds))))
    };
    pressures = pressures
        .with(Series::new("highest allowed", Mark::Dashed, of_bounds(|bounds| &bounds.upper)).coloured(6))
        .with(Series::new("limit", Mark::Dashed, of_bounds(|bounds| &bounds.limit)).coloured(1));
    let view = |title: &str, (across, i): (&str, usize), (up, j): (&str, usize)| {
        let path = |position: &dyn Fn(&SolveRecord) -> [f64; 3]| {
            solves.iter().map(|solve| (position(solve)[i] / MM, position(solve)[j] / MM)).collect()
        };
        let chart = Chart::new(title, across, up);
        Chart { equal_axes: true, ..chart }
            .with(Series::new("predicted", Mark::Line, path(&|solve| solve.predicted_position)))
            .with(Series::new("wanted", Mark::Dashed, path(&|solve| solve.target_position)))
    };
    let times = Chart::new("Time of a solve", "time (s)", "time of a solve (µs)").with(Series::new(
        "",
        Mark::Dots,
        against_time(&|solve| solve.duration * 1e6),
    ));
    vec![
        (error, "How far the model's pose stays from what was wanted.".into()),
        (pressures, "Of the FREEs' bounds and limit pressures the lowest is drawn; the limit is where a FREE gives way or the model ends.".into()),
        (view("Path seen along the axis", ("x (mm)", 0), ("y (mm)", 1)), "Base frame, millimetres.".into()),
        (view("Path from the side", ("x (mm)", 0), ("z (mm)", 2)), "Base frame, millimetres.".into()),
        (times, "Wall time, as measured when the log was made.".into()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        command::{fit::fit, track::Run},
        map_file::{MapFile, samples},
        report::check_tags,
    };
    use control::{Blend, Preference, Trajectory, Waypoint};

    #[test]
    fn a_run_is_met_by_its_own_model_and_by_no_other() {
        let directory = tempfile::tempdir().unwrap();
        let out = directory.path().join("run.mcap");
        let model = fit(&MapFile::Module(samples::smooth_module_map(1.0))).unwrap();
        let at = |time: f64, x: f64| Waypoint { time, position: [x, 0.002, 0.178], rotation: None };
        let waypoints = vec![at(0.0, 0.0), at(0.3, 0.006), at(0.5, 0.003)];
        let trajectory = Trajectory::new(waypoints, 50.0, Blend::Linear, 0.175).unwrap();
        let run = Run {
            model_path: Path::new("m"),
            from: None,
            preference: Preference::LeastChange,
            margin: 0.0,
            out: &out,
        };
        let statistics = run.follow(&model, &trajectory).unwrap();
        assert_eq!((statistics.solves(), statistics.exit()), (trajectory.len(), Exit::Done));
        assert!(statistics.worst_position() < 1e-5);

        let log = read_mcap(&out, None).unwrap();
        let attached = Model::from_bytes(&out, log.model.as_deref().unwrap()).unwrap();
        assert_eq!(attached, model);
        let replayed = recompute(&log, &attached, &out).unwrap();
        assert!(replayed.different.is_empty(), "{}", replayed.verdict());
        let html = page(&log, &replayed).unwrap().html();
        check_tags(&html);
        assert!(html.contains("bit for bit") && html.contains("/tip/pose_predicted"));

        let softer = fit(&MapFile::Module(samples::smooth_module_map(1.001))).unwrap();
        assert_eq!(recompute(&log, &softer, &out).unwrap().different.len(), trajectory.len());
    }
}
