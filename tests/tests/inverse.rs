//! From a module's map to pressures for its tip: fit, predict, solve, track, replay, all through the binary.

use freeact_tests::{Table, data, freeact, project};
use std::{
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Arguments from words and paths: a word that begins with `@` is a file in `folder`.
fn run(folder: &Path, line: &str) -> freeact_tests::Outcome {
    freeact(line.split_whitespace().map(|word| match word.strip_prefix('@') {
        Some(name) => folder.join(name).into_os_string(),
        None => OsString::from(word),
    }))
}

/// The 30 degree LR module's model, fitted from the reference map.
fn fitted_model(folder: &Path) {
    let map = data("maps/buffinton-2020-30lr.map");
    freeact([OsString::from("fit"), map.into(), "--out".into(), folder.join("m.model").into()]).succeeded();
}

/// Evenly scattered pressures in kPa: a Weyl sequence in four dimensions, the same on every machine.
fn scattered_pressures(count: usize, greatest: f64) -> Vec<[f64; 4]> {
    let roots = [2f64.sqrt(), 3f64.sqrt(), 5f64.sqrt(), 7f64.sqrt()];
    (1..=count).map(|n| roots.map(|root| greatest * (n as f64 * root).fract())).collect()
}

fn write_pressures(path: &Path, pressures: &[[f64; 4]]) {
    let rows = pressures.iter().map(|p| format!("{},{},{},{}\n", p[0], p[1], p[2], p[3]));
    fs::write(path, "p1_kpa,p2_kpa,p3_kpa,p4_kpa\n".to_owned() + &rows.collect::<String>()).expect("written");
}

#[test]
fn two_hundred_reachable_targets_are_reached() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fitted_model(folder.path());
    let sought = scattered_pressures(200, 50.0);
    write_pressures(&folder.path().join("sought.csv"), &sought);
    run(folder.path(), "predict --model @m.model --pressures @sought.csv --out @poses.csv").succeeded();
    let poses = Table::read(&folder.path().join("poses.csv"));
    assert_eq!(poses.rows.len(), sought.len());

    let mut found = Vec::new();
    for (index, row) in poses.rows.iter().enumerate() {
        let at = |column: &str| poses.number(row, column);
        let mut line =
            format!("solve --json --model @m.model --target-mm {},{},{}", at("x_mm"), at("y_mm"), at("z_mm"));
        // Every second target asks for its rotation too, which leaves no choice among pressures.
        if index % 2 == 1 {
            line += &format!(" --rotation {},{},{},{}", at("qw"), at("qx"), at("qy"), at("qz"));
        }
        let answer = run(folder.path(), &line).succeeded().json();
        assert_eq!(answer["status"], "reached", "target {index}: {answer}");
        assert!(
            answer["position_error_mm"].as_f64().is_some_and(|error| error < 0.2),
            "target {index}: {answer}"
        );
        let pressures = answer["pressures_kpa"].as_array().expect("pressures");
        let pressures: Vec<f64> = pressures.iter().filter_map(serde_json::Value::as_f64).collect();
        assert!(
            pressures.len() == 4 && pressures.iter().all(|p| (0.0..=50.0).contains(p)),
            "target {index}: {answer}"
        );
        found.push([pressures[0], pressures[1], pressures[2], pressures[3]]);
    }

    // The solver's own word is not enough: the pressures go through the model once more.
    write_pressures(&folder.path().join("found.csv"), &found);
    run(folder.path(), "predict --model @m.model --pressures @found.csv --out @again.csv").succeeded();
    let again = Table::read(&folder.path().join("again.csv"));
    for (index, (row, target)) in again.rows.iter().zip(&poses.rows).enumerate() {
        let off = |column: &str| again.number(row, column) - poses.number(target, column);
        let distance = off("x_mm").hypot(off("y_mm")).hypot(off("z_mm"));
        assert!(distance < 0.2, "target {index}: {distance} mm off at {:?}", found[index]);
    }
}

#[test]
fn a_target_out_of_reach_gets_its_nearest_pose() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fitted_model(folder.path());
    let outcome = run(folder.path(), "solve --json --model @m.model --target-mm 0,0,400");
    assert_ne!(outcome.code, 0, "an unreachable target is no success");
    let answer = outcome.json();
    assert_eq!(answer["status"], "unreachable", "{answer}");
    assert!(answer["position_error_mm"].as_f64().is_some_and(|error| error > 100.0), "{answer}");
    assert!(answer["pressures_kpa"].as_array().is_some_and(|p| p.len() == 4), "{answer}");
    assert!(answer["reason"].as_str().is_some_and(|reason| !reason.is_empty()), "{answer}");
}

#[test]
fn impossible_targets_are_refused_in_words() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fitted_model(folder.path());
    for line in [
        "solve --model @m.model --target-mm nan,0,175",
        "solve --model @m.model --target-mm 0,175",
        "solve --model @m.model --target-mm 0,0,175 --rotation 0,0,0,0",
        "solve --model @m.model --target-mm 0,0,175 --from-kpa 1,2",
        "solve --model @m.model --target-mm 0,0,175 --prefer speed",
    ] {
        let outcome = run(folder.path(), line);
        assert!(outcome.code > 0 && outcome.code != 101, "{line}: {outcome:?}");
        assert!(outcome.stderr.len() > 20, "{line}: {outcome:?}");
    }
}

/// A path, tracked into a log: the poses along straight lines between four sets of pressures.
///
/// Straight lines between the poses of those four alone would leave the reachable set: it is curved, and pressures do not
/// go below zero. The pressures keep 6 kPa above that, and waypoints so near each other that a chord stays inside too.
fn tracked(folder: &Path) -> freeact_tests::Outcome {
    fitted_model(folder);
    let corners = [[10.0; 4], [32.0, 10.0, 6.0, 10.0], [22.0, 24.0, 6.0, 6.0], [6.0, 14.0, 28.0, 14.0]];
    let between = |index: usize| -> [f64; 4] {
        let (leg, part) = ((index / 10).min(2), index as f64 / 10.0 - (index / 10).min(2) as f64);
        std::array::from_fn(|free| corners[leg][free] + part * (corners[leg + 1][free] - corners[leg][free]))
    };
    write_pressures(&folder.join("corners.csv"), &(0..=30).map(between).collect::<Vec<_>>());
    run(folder, "predict --model @m.model --pressures @corners.csv --out @poses.csv").succeeded();
    let poses = Table::read(&folder.join("poses.csv"));
    let mut waypoints = "t_s,x_mm,y_mm,z_mm\n".to_owned();
    for (index, row) in poses.rows.iter().enumerate() {
        let at = |column: &str| poses.number(row, column);
        waypoints += &format!("{},{},{},{}\n", 0.1 * index as f64, at("x_mm"), at("y_mm"), at("z_mm"));
    }
    fs::write(folder.join("w.csv"), waypoints).expect("written");
    run(folder, "track --json --model @m.model --waypoints @w.csv --rate-hz 50 --out @run.mcap").succeeded()
}

#[test]
fn a_tracked_path_is_replayed_bit_for_bit() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let tracked = tracked(folder.path()).json();
    let answer = run(folder.path(), "replay @run.mcap --html @report.html --json").succeeded().json();
    assert_eq!(answer["identical"], true, "{answer}");
    assert!(answer["solves"].as_u64().is_some_and(|solves| solves > 100), "{answer}");
    let map = data("maps/buffinton-2020.map");
    freeact([OsString::from("fit"), map.into(), "--out".into(), folder.path().join("f.model").into()])
        .succeeded();
    let other = run(folder.path(), "replay @run.mcap --model @f.model");
    assert!(other.code > 0 && other.stderr.contains("f.model: is the model of a single FREE"), "{other:?}");
    for run in [&tracked, &answer] {
        assert_eq!(run["reached"], run["solves"], "{run}");
        assert_eq!(run["not_reached"].as_array().map(Vec::len), Some(0), "{run}");
        assert!(run["position_error_max_mm"].as_f64().is_some_and(|error| error < 0.2), "{run}");
    }
    let page = fs::read_to_string(folder.path().join("report.html")).expect("a report");
    assert!(
        page.contains("<svg") && !page.contains("http://") || page.contains("http://www.w3.org"),
        "a page with pictures"
    );
}

#[test]
fn track_tells_when_and_why_targets_are_missed() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fitted_model(folder.path());
    // From rest to a bend that needs 20 kPa, in 20 ms: at 200 kPa/s that takes 100 ms. Later, far out of reach.
    write_pressures(&folder.path().join("p.csv"), &[[10.0; 4], [32.0, 10.0, 6.0, 10.0]]);
    run(folder.path(), "predict --model @m.model --pressures @p.csv --out @poses.csv").succeeded();
    let poses = Table::read(&folder.path().join("poses.csv"));
    let at = |row: usize| {
        let number = |column: &str| poses.number(&poses.rows[row], column);
        format!("{},{},{}", number("x_mm"), number("y_mm"), number("z_mm"))
    };
    let (rest, bend) = (at(0), at(1));
    let path = format!(
        "t_s,x_mm,y_mm,z_mm\n0,{rest}\n0.4,{rest}\n0.42,{bend}\n0.8,{bend}\n0.82,0,0,400\n1,0,0,400\n"
    );
    fs::write(folder.path().join("w.csv"), path).expect("written");
    let line = "track --model @m.model --waypoints @w.csv --rate-hz 50 --out @run.mcap";
    let outcome = run(folder.path(), line);
    assert_eq!(outcome.code, 3, "{outcome:?}");
    for words in ["not reached (s)", "0.420 to 0.", "0.820 to 1.000", "_rate_up", "pressure_rate_kpa_s"] {
        assert!(outcome.stdout.contains(words), "{words} is not in\n{}", outcome.stdout);
    }
    let answer = run(folder.path(), &format!("{line} --json")).json();
    let missed = answer["not_reached"].as_array().expect("stretches of missed targets");
    assert_eq!(missed.len(), 2, "{answer}");
    let held = |index: usize, part: &str| {
        let bounds = missed[index]["held_by"].as_array().expect("bounds");
        bounds.iter().any(|bound| bound.as_str().is_some_and(|bound| bound.contains(part)))
    };
    assert!(held(0, "_rate_up") && held(1, "_max"), "{answer}");
    assert!(missed[0]["to_s"].as_f64().is_some_and(|end| end < 0.7), "{answer}");
}

#[test]
fn a_path_barely_out_of_reach_is_not_left_for_another_branch() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fitted_model(folder.path());
    write_pressures(&folder.path().join("p.csv"), &[[0.0; 4], [30.0, 5.0, 0.0, 5.0]]);
    run(folder.path(), "predict --model @m.model --pressures @p.csv --out @poses.csv").succeeded();
    let poses = Table::read(&folder.path().join("poses.csv"));
    // The straight line between the two leaves the reachable set by a tenth of a millimetre; there are pressures that reach
    // its points, but they twist the module by two hundred degrees, and the tip is millimetres off on the way.
    let mut waypoints = "t_s,x_mm,y_mm,z_mm\n".to_owned();
    for (row, time) in poses.rows.iter().zip([0, 8]) {
        let at = |column: &str| poses.number(row, column);
        waypoints += &format!("{time},{},{},{}\n", at("x_mm"), at("y_mm"), at("z_mm"));
    }
    fs::write(folder.path().join("w.csv"), waypoints).expect("written");
    let line = "track --json --model @m.model --waypoints @w.csv --rate-hz 50 --out @run.mcap";
    let outcome = run(folder.path(), line);
    assert_eq!(outcome.code, 3, "{outcome:?}");
    let answer = outcome.json();
    assert!(answer["position_error_max_mm"].as_f64().is_some_and(|error| error < 0.15), "{answer}");
    let again = run(folder.path(), "replay @run.mcap --json").succeeded().json();
    assert_eq!(again["identical"], true, "{again}");
}

/// Set by the script of all checks, which installs the readers: a Python that has them.
#[test]
fn other_programs_read_the_log() {
    let Some(python) = std::env::var_os("FREEACT_PYTHON").map(PathBuf::from) else {
        println!("skipped: set FREEACT_PYTHON to a Python with tests/python/requirements.txt installed");
        return;
    };
    let folder = tempfile::tempdir().expect("a scratch folder");
    tracked(folder.path());
    let script = project().join("tests/python/read_mcap.py");
    let output =
        Command::new(python).arg(script).arg(folder.path().join("run.mcap")).output().expect("Python runs");
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    for topic in [
        "/free_1/pressure_command",
        "/free_4/pressure_command",
        "/tip/target",
        "/tip/pose_predicted",
        "/solve",
    ] {
        assert!(text.contains(topic), "{topic} is not in:\n{text}");
    }
}
