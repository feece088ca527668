//! Closing the loop on recordings: real single FREEs (where they are at hand) and simulated rigs made by another model.

use freeact_tests::{data, freeact, measured};
use std::{ffi::OsString, path::Path};

fn identify(rig: &Path, recordings: &[OsString], holdout: &[OsString], out: &Path) -> serde_json::Value {
    let join = |files: &[OsString]| files.join(&OsString::from(","));
    let mut arguments: Vec<OsString> =
        vec!["identify".into(), "--rig".into(), rig.into(), "--recordings".into()];
    arguments.push(join(recordings));
    if !holdout.is_empty() {
        arguments.extend(["--holdout".into(), join(holdout)]);
    }
    arguments.extend(["--out".into(), out.into()]);
    freeact(arguments).succeeded();
    let text = std::fs::read_to_string(out.join("identify.json")).expect("identify.json");
    assert!(out.join("report.html").exists() && out.join("corrected.model").exists());
    serde_json::from_str(&text).expect("JSON")
}

fn names(answer: &serde_json::Value) -> Vec<&str> {
    let effects = answer["effects"].as_array().expect("effects");
    effects.iter().filter_map(|effect| effect["name"].as_str()).collect()
}

#[test]
fn real_frees_are_better_predicted_on_branches_that_took_no_part_in_the_fit() {
    let Some(folder) = measured("um-free") else {
        println!("skipped: the University of Michigan recordings are not at hand (FREEACT_MEASURED)");
        return;
    };
    let out = tempfile::tempdir().expect("a scratch folder");
    for specimen in ["free20", "free40", "free50", "free60"] {
        let recording = folder.join(format!("{specimen}-free-end.csv")).into_os_string();
        let answer =
            identify(&folder.join(format!("{specimen}.toml")), &[recording], &[], &out.path().join(specimen));
        let twist = |stage: &str| answer["held_out"][stage]["twist_rms_rad"].as_f64().expect("twist_rms_rad");
        println!(
            "{specimen}: {} -> {} -> {}, {:?}",
            twist("before"),
            twist("calibrated"),
            twist("after"),
            names(&answer)
        );
        assert!(twist("after") < twist("before"), "{specimen}: {answer}");
        if names(&answer).contains(&"hysteresis") {
            assert!(twist("after") < twist("calibrated"), "{specimen}: {answer}");
        }
    }
}

/// The practice rigs of data/rigs: simulated by a model of another kind, each with the effect of its name.
#[test]
fn practice_rigs_are_named() {
    for (rig, effect) in [
        ("null", None),
        ("stiffness", Some("stiffness")),
        ("lag", Some("supply_lag")),
        ("payload", Some("payload")),
    ] {
        let folder = data("rigs").join(format!("practice-{rig}"));
        let file = |name: &str| folder.join(name).into_os_string();
        let fit = ["1-staircase.mcap", "2-triangles.mcap", "3-setpoints.mcap", "4-holds.mcap"].map(file);
        let out = tempfile::tempdir().expect("a scratch folder");
        let answer = identify(&folder.join("rig.toml"), &fit, &[file("5-smooth.mcap")], out.path());
        let verdict = answer["verdict"].as_str().expect("a verdict");
        match effect {
            None => assert_eq!((verdict, names(&answer).len()), ("nothing missing", 0), "{answer}"),
            Some(effect) => {
                assert_eq!(verdict, "explained", "{rig}: {answer}");
                assert_eq!(names(&answer), [effect], "{rig}: {answer}");
            }
        }
    }
}
