//! `freeact workspace` end to end: its files, its volume and its boundary, which `freeact solve` can reach but not pass.

use freeact_tests::{Table, data, freeact, freeact_in};
use std::{ffi::OsString, fs, path::Path};

/// The 30 degree LR module's model, fitted from the reference map.
fn fitted_model(folder: &Path) {
    let map = data("maps/buffinton-2020-30lr.map");
    freeact([OsString::from("fit"), map.into(), "--out".into(), folder.join("m.model").into()]).succeeded();
}

#[test]
fn the_boundary_is_reached_and_not_passed() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fitted_model(folder.path());
    let line = "workspace --model @m.model --out @new/set --steps 8 --cells 32 --json";
    let value = freeact_in(folder.path(), line).succeeded().json();
    let out = folder.path().join("new/set");
    assert_eq!(value["simulated"], true);
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let volume = number(&value["volume_mm3"]);
    // 6486 mm^3 at four times the steps and twice the cells; the change from half as fine covers the difference.
    assert!((volume - 6486.0).abs() < number(&value["volume_error_mm3"]), "{}", value["volume_mm3"]);
    assert!(number(&value["volume_error_mm3"]) < 0.03 * volume, "{}", value["volume_error_mm3"]);
    assert_eq!(value["levels"].as_array().map(Vec::len), Some(3));
    assert_eq!(value["check"]["outside"], 0, "{}", value["check"]);
    let reach = value["reach"].as_array().expect("directions");
    assert_eq!(reach.len(), 72);
    assert!(reach.iter().all(|side| (22.0..31.0).contains(&number(&side["reach_mm"]))));

    let points = Table::read(&out.join("points.csv"));
    assert_eq!(points.rows.len(), 7usize.pow(4));
    for row in &points.rows {
        for (axis, column) in [("x", "x_mm"), ("y", "y_mm"), ("z", "z_mm")] {
            let ends: Vec<f64> =
                value["extent"][axis]["mm"].as_array().expect("ends").iter().map(number).collect();
            let at = points.number(row, column);
            assert!(ends[0] - 0.05 < at && at < ends[1] + 0.05, "{axis} {at} {ends:?}");
        }
        assert!(points.number(row, "manipulability_mm3_per_kpa3") > 0.0);
        assert!(points.number(row, "condition_number") >= 1.0);
    }

    // The highest and the lowest facets over some places: half a millimetre farther nothing is reached, as much nearer it is.
    let boundary = Table::read(&out.join("boundary.csv"));
    let at = |row: &Vec<String>| ["x_mm", "y_mm", "z_mm"].map(|column| boundary.number(row, column));
    for place in [[0.0, 0.0], [12.0, 3.0], [-5.0, 14.0], [-16.0, -2.0]] {
        let here = boundary.rows.iter().map(at);
        let here: Vec<_> = here.filter(|at| (at[0] - place[0]).hypot(at[1] - place[1]) < 1.0).collect();
        let height = |at: &&[f64; 3]| (at[2] * 1e6) as i64;
        for (facet, up) in [(here.iter().max_by_key(height), 1.0), (here.iter().min_by_key(height), -1.0)] {
            let [x, y, z] = *facet.expect("a facet");
            let solve = |by: f64| {
                let line = format!("solve --json --model @m.model --target-mm {x},{y},{}", z + up * by);
                freeact_in(folder.path(), &line).json()["status"].clone()
            };
            assert_eq!(solve(0.5), "unreachable", "{x} {y} {z} {up}");
            assert_eq!(solve(-0.5), "reached", "{x} {y} {z} {up}");
        }
    }

    for stem in ["workspace-xy", "workspace-xz", "workspace-yz", "workspace-reach"] {
        let svg = fs::read_to_string(out.join(format!("{stem}.svg"))).expect(stem);
        assert!(svg.contains("simulated") && !svg.contains("NaN"), "{stem}");
        assert_eq!(&fs::read(out.join(format!("{stem}.png"))).expect(stem)[1..4], b"PNG");
    }
    for name in ["points.vtu", "boundary.vtu"] {
        let text = fs::read_to_string(out.join(name)).expect(name);
        assert!(text.starts_with("<?xml") && text.ends_with("</VTKFile>\n") && text.contains("p4"), "{name}");
    }
    let cases = Table::read(&out.join("cases.csv"));
    assert_eq!(cases.rows.len(), 5 * 61);
}

#[test]
fn threads_change_nothing() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fitted_model(folder.path());
    for jobs in ["1", "3"] {
        let line =
            format!("workspace --model @m.model --out @{jobs} --steps 4 --cells 16 --points 2 --jobs {jobs}");
        let told = freeact_in(folder.path(), &line).succeeded().stdout;
        assert!(told.contains("volume") && told.contains("cm³"), "{told}");
    }
    for name in ["points.csv", "boundary.csv", "reach.csv", "boundary.vtu", "workspace-xy.svg"] {
        let read = |jobs: &str| fs::read(folder.path().join(jobs).join(name)).expect(name);
        assert!(read("1") == read("3"), "{name}");
    }
}

#[test]
fn what_has_no_reachable_set_is_refused_in_words() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fitted_model(folder.path());
    let map = data("maps/buffinton-2020.map");
    freeact([OsString::from("fit"), map.into(), "--out".into(), folder.path().join("f.model").into()])
        .succeeded();
    for (line, code, words) in [
        ("--model @f.model", 2, "is the model of a single FREE"),
        ("--model @m.model --steps 6", 2, "give a multiple of four"),
        ("--model @m.model --steps 400", 2, "steps of each pressure: 400; give 1 to"),
        ("--model @m.model --points 200", 2, "more than 2000000 points"),
        ("--model @m.model --limit-margin-kpa 80", 4, "least pressure"),
        ("--model @missing.model", 5, "missing.model"),
    ] {
        let outcome = freeact_in(folder.path(), &format!("workspace --out @set {line}"));
        assert_eq!(outcome.code, code, "{line}: {outcome:?}");
        assert!(outcome.message().contains(words), "{line}: {outcome:?}");
        assert!(!folder.path().join("set").exists(), "{line}");
    }
}
