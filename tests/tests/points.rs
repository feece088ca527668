//! Finished points of sweeps: kept through Ctrl-C, shared between maps and between programs that run at once, never thrown away
//! unasked.
#![cfg(unix)]

use actuator::PointStore;
use freeact_tests::{Outcome, data, freeact, freeact_in, program};
use std::{
    fs,
    path::Path,
    process::{Child, Command, Stdio},
    thread::sleep,
    time::Duration,
};

/// Twelve paths and two checks.
const SWEEP: &str = "--winding-angles 20:70:10 --shear-moduli-mpa 0.2,0.4 --pressure-step-kpa 20 --interpolation-tolerance 1 --checks 2 --jobs 1";

fn line(more: &str) -> String {
    format!("map --of {} {more}", data("actuators/buffinton-2020.toml").display())
}

fn map(folder: &Path, more: &str) -> Outcome {
    freeact_in(folder, &line(more))
}

fn start(folder: &Path, more: &str) -> Child {
    let line = line(more);
    let words = line.split_whitespace().map(|word| word.replace('@', &format!("{}/", folder.display())));
    Command::new(program()).args(words).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Starts a sweep and ends it by a signal as soon as some points are stored. Its exit code.
fn ended(folder: &Path, more: &str, signal: &str) -> Option<i32> {
    let mut run = start(folder, more);
    while points(folder, "a.map.points") < 2 {
        assert_eq!(run.try_wait().unwrap(), None, "it ended before");
        sleep(Duration::from_millis(1));
    }
    assert!(Command::new("kill").args([signal, &run.id().to_string()]).status().unwrap().success());
    run.wait().unwrap().code()
}

/// Number of points in a store; none where there is no such folder.
fn points(folder: &Path, name: &str) -> usize {
    let directory = folder.join(name);
    if directory.exists() { PointStore::open(&directory).unwrap().len() } else { 0 }
}

/// Points found and computed.
fn counts(outcome: Outcome) -> (u64, u64) {
    let told = outcome.succeeded().json();
    (told["points_found"].as_u64().unwrap(), told["points_computed"].as_u64().unwrap())
}

fn undisturbed(folder: &Path) -> Vec<u8> {
    map(folder, &format!("{SWEEP} --out @whole.map")).succeeded();
    fs::read(folder.join("whole.map")).unwrap()
}

#[test]
fn an_interrupted_sweep_keeps_its_map_and_its_points() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let whole = undisturbed(folder);
    let sweep = format!("{SWEEP} --out @a.map");
    assert_eq!(ended(folder, &sweep, "-INT"), Some(130));
    let told = freeact_in(folder, "inspect @a.map --json").succeeded().json();
    let (kept, stored) = (told["computed"].as_u64().unwrap(), points(folder, "a.map.points"));
    assert!((2..12).contains(&kept) && stored == kept as usize, "{kept} nodes, {stored} points");
    let refused = map(folder, &sweep);
    assert!(refused.code == 4 && refused.message().contains("give --resume"), "{refused:?}");
    assert_eq!(counts(map(folder, &format!("{sweep} --resume --json"))), (kept, 14 - kept));
    assert!(fs::read(folder.join("a.map")).unwrap() == whole && !folder.join("a.map.points").exists());

    // The map alone is enough, too, and so are the points.
    for name in ["a.map", "a.map.points"] {
        fs::remove_file(folder.join("a.map")).unwrap();
        assert_eq!(ended(folder, &sweep, "-INT"), Some(130));
        match name {
            "a.map" => fs::remove_dir_all(folder.join("a.map.points")).unwrap(),
            _ => fs::remove_file(folder.join("a.map")).unwrap(),
        }
        assert!(counts(map(folder, &format!("{sweep} --resume --json"))).0 >= 2);
        assert!(fs::read(folder.join("a.map")).unwrap() == whole && !folder.join("a.map.points").exists());
    }
}

#[test]
fn what_a_killed_sweep_left_is_neither_passed_over_nor_removed_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let whole = undisturbed(folder);
    let sweep = format!("{SWEEP} --out @a.map");
    let nothing = map(folder, &format!("{sweep} --resume"));
    assert!(nothing.code == 4 && nothing.message().contains("no map to resume"), "{nothing:?}");
    assert_eq!(ended(folder, &sweep, "-KILL"), None);
    let stored = points(folder, "a.map.points");
    let refused = |more: &str, wanted: &str| {
        let outcome = map(folder, more);
        assert!(outcome.code == 4 && outcome.message().contains(wanted), "{outcome:?}");
        assert_eq!(points(folder, "a.map.points"), stored);
    };
    refused(&sweep, &format!("holds {stored} finished points of this sweep; give --resume"));
    // Another pressure makes every path another.
    let other = sweep.replace("step-kpa 20", "step-kpa 35");
    refused(&other, "finished points of another sweep");
    refused(&format!("{other} --resume"), "finished points of another sweep");

    // A smaller sweep takes its share; the rest stays for who wants it.
    let fewer = sweep.replace("20:70:10", "20").replace("0.2,0.4", "0.2");
    assert_eq!(counts(map(folder, &format!("{fewer} --resume --json"))), (1, 0));
    assert_eq!(points(folder, "a.map.points"), stored, "points of others are gone");
    fs::remove_file(folder.join("a.map")).unwrap();
    assert_eq!(counts(map(folder, &format!("{sweep} --resume --json"))), (stored as u64, 14 - stored as u64));
    assert!(fs::read(folder.join("a.map")).unwrap() == whole && !folder.join("a.map.points").exists());
}

#[test]
fn a_named_store_serves_other_maps_and_several_programs_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let whole = undisturbed(folder);
    let parts: Vec<Child> = (1..=2)
        .map(|part| start(folder, &format!("{SWEEP} --shard {part}/2 --store @store --out @{part}.map")))
        .collect();
    for mut part in parts {
        assert_eq!(part.wait().unwrap().code(), Some(0));
    }
    freeact_in(folder, "merge @1.map @2.map --out @merged.map").succeeded();
    assert!(fs::read(folder.join("merged.map")).unwrap() == whole, "the merged map differs");
    assert_eq!((points(folder, "store"), fs::read_dir(folder.join("store")).unwrap().count()), (14, 2));

    // Nothing is left to compute of the same sweep; of a finer one, what is new.
    assert_eq!(counts(map(folder, &format!("{SWEEP} --store @store --out @again.map --json"))), (14, 0));
    assert!(fs::read(folder.join("again.map")).unwrap() == whole);
    let finer = SWEEP.replace("0.2,0.4", "0.2,0.3,0.4").replace("--checks 2", "--checks 0");
    assert_eq!(counts(map(folder, &format!("{finer} --store @store --out @finer.map --json"))), (12, 6));
    map(folder, &format!("{finer} --out @alone.map")).succeeded();
    assert!(fs::read(folder.join("finer.map")).unwrap() == fs::read(folder.join("alone.map")).unwrap());
    // What differs in anything is computed.
    let solid = "--winding-angles 20 --pressure-max-kpa 5 --fidelity solid --elements 1,12,90 --store @store --out @solid.map --json";
    assert_eq!(counts(map(folder, solid)), (0, 1));
    assert_eq!(counts(map(folder, solid)), (1, 0));
}

#[test]
fn damage_in_a_store_is_told_and_computed_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let whole = undisturbed(folder);
    let sweep = format!("{SWEEP} --store @store --out @a.map --json");
    map(folder, &sweep).succeeded();
    let log = fs::read_dir(folder.join("store")).unwrap().next().unwrap().unwrap().path();
    let mut bytes = fs::read(&log).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&log, bytes).unwrap();
    let outcome = map(folder, &sweep);
    assert!(
        outcome.message().contains("warning: ") && outcome.message().contains("damaged at byte"),
        "{outcome:?}"
    );
    let (found, computed) = counts(outcome);
    assert!(found > 0 && computed > 0 && found + computed == 14, "{found} found, {computed} computed");
    assert!(fs::read(folder.join("a.map")).unwrap() == whole);
    let nowhere = freeact([
        "map",
        "--of",
        &data("actuators/buffinton-2020.toml").display().to_string(),
        "--store",
        &log.display().to_string(),
        "--out",
        &folder.join("b.map").display().to_string(),
    ]);
    assert!(nowhere.code == 5 && nowhere.message().contains(&log.display().to_string()), "{nowhere:?}");
}
