//! States of a solid map as files for ParaView: written, read by meshio, refused where there are none.

use actuator::{Fidelity, FreeMap, artefact};
use freeact_tests::{data, describe_free, freeact, freeact_in, project};
use std::{fs, path::Path, process::Command};

/// Of the FREE, mm.
const LENGTH: f64 = 30.0;

/// Names of the files in a folder, sorted.
fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn states_are_solved_again_and_written() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    describe_free(folder, LENGTH);
    let axes = "--winding-angles 30,50 --pressure-max-kpa 40 --pressure-step-kpa 20 --checks 0";
    let solid = "--fidelity solid --elements 1,12,20";
    freeact_in(folder, &format!("map --of @free.toml {axes} {solid} --out @solid.map")).succeeded();

    let outcome = freeact_in(folder, "inspect @solid.map --vtu @states").succeeded();
    assert!(outcome.stdout.contains("by solid") && outcome.stderr.is_empty(), "{outcome:?}");
    assert_eq!(outcome.stdout.matches("path.pvd: 3 states, as in the map").count(), 2, "{outcome:?}");
    assert_eq!(files(&folder.join("states")), ["30-deg-0.393-mpa", "50-deg-0.393-mpa"]);
    let mut all = vec!["path.pvd".to_owned()];
    all.extend((0..3).flat_map(|i| ["-fibres", ""].map(|part| format!("state-00{i}{part}.vtu"))));
    assert_eq!(files(&folder.join("states/30-deg-0.393-mpa")), all);
    let collection = folder.join("states/50-deg-0.393-mpa/path.pvd");
    let text = fs::read_to_string(&collection).expect("a collection");
    assert_eq!(text.matches("<DataSet").count(), 6);
    assert!(text.contains("timestep=\"40\" part=\"1\" file=\"state-002-fibres.vtu\""), "{text}");
    read_by_meshio(&collection);

    // One state of one path, for programs; the table as CSV is not disturbed.
    let line = "inspect @solid.map --vtu @one --winding-angle 50 --at-kpa 20";
    let value = freeact_in(folder, &format!("{line} --json")).succeeded().json();
    let path = &value["vtu"]["paths"][0];
    assert_eq!((value["vtu"]["paths"].as_array().map(Vec::len), &path["difference"]), (Some(1), &().into()));
    let state = &path["states"][0];
    assert_eq!((path["states"].as_array().map(Vec::len), &state["state"]), (Some(1), &1.into()), "{value}");
    let strain = |name: &str| state[name].as_f64().expect(name);
    assert!((strain("pressure_kpa") - 20.0).abs() < 1e-9, "{value}");
    assert!(strain("greatest_log_strain") >= strain("mid_greatest_log_strain"), "{value}");
    assert!((1e-2..0.3).contains(&strain("mid_greatest_log_strain")), "{value}");
    let written = files(&folder.join("one/50-deg-0.393-mpa"));
    assert_eq!(written, ["path.pvd", "state-001-fibres.vtu", "state-001.vtu"]);
    let plain = freeact_in(folder, "inspect @solid.map --csv").succeeded().stdout;
    let beside = freeact_in(folder, &format!("{line} --csv")).succeeded();
    assert!(beside.stdout == plain && beside.stderr.contains("1 states"), "{beside:?}");

    // Told where a file cannot be written.
    fs::write(folder.join("taken"), "").expect("writes");
    let outcome = freeact_in(folder, "inspect @solid.map --vtu @taken");
    assert!(outcome.code == 5 && outcome.message().contains("taken"), "{outcome:?}");
    for (flags, words) in [
        ("--winding-angle 40", "--winding-angle: 40 is not in the map, which has 30.00, 50.00"),
        ("--shear-modulus-mpa 1", "--shear-modulus-mpa: 1 is not in the map, which has 0.3930"),
        ("--at-kpa 30", "no path has a state at 30.00 kPa; there are states at 0, 20.00, 40.00"),
    ] {
        let outcome = freeact_in(folder, &format!("inspect @solid.map --vtu @none {flags}"));
        assert!(outcome.code == 2 && outcome.message().contains(words), "{flags}: {outcome:?}");
        assert!(!folder.join("none").exists(), "{flags}");
    }
}

fn read_by_meshio(collection: &Path) {
    let Some(python) = std::env::var_os("FREEACT_PYTHON") else {
        eprintln!("SKIPPED: set FREEACT_PYTHON to a Python with tests/python/requirements.txt installed");
        return;
    };
    let script = project().join("tests/python/read_vtu.py");
    let run = Command::new(python).arg(script).arg(collection).output().expect("runs");
    let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{out}\n{err}");
    assert!(out.contains("40 kPa: 240 hexahedra") && out.contains("3 states read by meshio"), "{out}");
}

#[test]
fn a_map_that_is_not_what_comes_out_is_told() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    describe_free(folder, LENGTH);
    let mesh = "--fidelity solid --pressure-max-kpa 20 --pressure-step-kpa 20 --checks 0 --out @solid.map";
    freeact_in(folder, &format!("map --of @free.toml --elements 1,12,10 {mesh}")).succeeded();
    // A map in the file is the number of its kind, 0, and the FREE's map. One of another mesh under this one's name:
    let path = folder.join("solid.map");
    let (kind, mut map): (u8, FreeMap) = artefact::read(&path, artefact::MAP).expect("a map of a FREE");
    assert_eq!(map.fidelity, Fidelity::Solid { elements: Some([1, 12, 10]) });
    map.fidelity = Fidelity::Solid { elements: Some([1, 12, 15]) };
    artefact::write(&path, artefact::MAP, &(kind, map)).expect("writes");
    let outcome = freeact_in(folder, "inspect @solid.map --vtu @states");
    assert_eq!(outcome.code, 1, "{outcome:?}");
    assert!(outcome.message().contains("the path differs from the map"), "{outcome:?}");
    assert!(!outcome.stdout.contains("as in the map"), "{outcome:?}");
}

#[test]
fn what_holds_no_solid_is_refused() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    let cases = [
        ("maps/buffinton-2020.map", 4, "make one by `freeact map --fidelity solid`"),
        ("maps/buffinton-2020-30lr.map", 4, "of single FREEs only"),
        ("actuators/buffinton-2020.toml", 2, "applies to solid maps only"),
    ];
    for (file, code, words) in cases {
        let file = data(file).to_string_lossy().into_owned();
        let outcome = freeact(["inspect", &file, "--vtu", &folder.join("x").to_string_lossy()]);
        assert!(outcome.code == code && outcome.message().contains(words), "{file}: {outcome:?}");
        assert!(!folder.join("x").exists() && outcome.stdout.is_empty(), "{file}: {outcome:?}");
    }
    let alone = freeact(["inspect", &data("maps/buffinton-2020.map").to_string_lossy(), "--at-kpa", "20"]);
    assert!(alone.code == 2 && alone.message().contains("--vtu"), "{alone:?}");
}
