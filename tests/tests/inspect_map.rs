//! `inspect` of a FREE's map: its columns in Parquet as a data frame reads them, its charts and the choice of what they show.

use freeact_tests::{data, freeact_in, project};
use std::{fs, path::Path, process::Command};

fn map_of_walls(folder: &Path) {
    let of = data("actuators/buffinton-2020.toml");
    let of = of.display();
    let axes = "--winding-angles 20:70:10 --axis wall_mm=0.6,0.8 --pressure-step-kpa 10 --checks 0";
    freeact_in(folder, &format!("map --of {of} {axes} --out @walls.map")).succeeded();
}

#[test]
fn columns_are_the_same_in_parquet_and_csv() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    map_of_walls(folder);
    freeact_in(folder, "inspect @walls.map --csv --out @walls.csv --parquet @walls.parquet").succeeded();
    let csv = fs::read_to_string(folder.join("walls.csv")).expect("CSV");
    assert!(csv.contains("limit point") && csv.contains("beyond limit"), "{csv}");
    let outcome = freeact_in(folder, "inspect @walls.map --parquet @no/walls.parquet");
    assert!(outcome.code == 5 && outcome.message().contains("walls.parquet"), "{outcome:?}");
    let of = data("actuators/buffinton-2020.toml");
    let outcome = freeact_in(folder, &format!("inspect {} --parquet @none.parquet", of.display()));
    assert!(
        outcome.code == 2 && outcome.message().contains("--parquet applies to maps and recordings"),
        "{outcome:?}"
    );
    assert!(!folder.join("none.parquet").exists());

    let Some(python) = std::env::var_os("FREEACT_PYTHON") else {
        eprintln!("SKIPPED: set FREEACT_PYTHON to a Python with tests/python/requirements.txt installed");
        return;
    };
    let script = project().join("tests/python/read_parquet.py");
    let files = ["walls.parquet", "walls.csv"].map(|name| folder.join(name));
    let run = Command::new(python).arg(script).args(files).output().expect("runs");
    let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success() && out.contains("buffinton-2020"), "{out}\n{err}");
    assert!(out.contains(&format!("{} rows of", csv.lines().count() - 1)), "{out}");
}

#[test]
fn charts_stand_at_the_description_or_at_what_is_chosen() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    map_of_walls(folder);
    freeact_in(folder, "inspect @walls.map --plot @all").succeeded();
    freeact_in(folder, "inspect @walls.map --plot @thin --axis wall_mm=0.6 --at-kpa 10,30").succeeded();
    let read = |path: &str| fs::read_to_string(folder.join(path)).expect(path);
    let over = read("all/twist-over-winding-angle.svg");
    assert!(
        over.contains("wall 0.8 mm") && over.contains("from hoop") && over.contains("limit ahead"),
        "{over}"
    );
    assert!(read("all/twist-by-wall.svg").contains("winding angle 30° from hoop"));
    for name in ["sensitivity-of-twist", "design-space-twist-by-wall", "limit-pressure-by-wall"] {
        assert!(fs::read(folder.join(format!("all/{name}.png"))).expect(name).starts_with(b"\x89PNG"));
    }
    assert!(read("thin/twist-over-winding-angle.svg").contains("wall 0.6 mm"));
    assert!(!folder.join("thin/twist-by-wall.svg").exists());

    for (flags, words) in [
        ("--plot @no --axis wall_mm=0.7", "wall_mm: 0.7 is not in the map, which has 0.6000, 0.8000"),
        ("--plot @no --axis fibres=4", "--axis fibres: the map has no such axis"),
        ("--plot @no --at-kpa 11", "none of the map's pressures is 11.00 kPa"),
        ("--at-kpa 10", "give one of them"),
    ] {
        let outcome = freeact_in(folder, &format!("inspect @walls.map {flags}"));
        assert!(outcome.code == 2 && outcome.message().contains(words), "{flags}: {outcome:?}");
        assert!(!folder.join("no").exists());
    }
}
