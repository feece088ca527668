//! Blocked forces of FREEs and modules, from the command line.

use freeact_tests::{Outcome, Table, data, freeact_in};
use std::{f64::consts::PI, fs, path::Path};

/// A FREE of 48 degrees from the axis and 5 mm to its threads, which are nearly inextensible.
const FREE: &str = r#"kind = "free"
name = "stiff"
length_mm = 100.0
inner_diameter_mm = 8.4
wall_mm = 0.8
winding_angle_deg = 42.0
handedness = "left"
fibres = 6
fibre_ea_newton = 64400.0
fibre_diameter_mm = 5.0
[elastomer]
model = "neo-hookean"
shear_modulus_mpa = 0.1
[limits]
pressure_max_kpa = 50.0
"#;

/// Three FREEs that do not know of each other.
const MODULE: &str = r#"kind = "module"
name = "three"
spacers = 0
[defaults]
length_mm = 120.0
inner_diameter_mm = 9.0
wall_mm = 1.0
winding_angle_deg = 50.0
fibres = 6
fibre_ea_newton = 644.0
[defaults.elastomer]
model = "neo-hookean"
shear_modulus_mpa = 0.3
[[free]]
position_mm = [10.0, 0.0]
[[free]]
position_mm = [-5.0, 8.66]
handedness = "left"
[[free]]
position_mm = [-5.0, -8.66]
winding_angle_deg = 30.0
[limits]
pressure_max_kpa = [40.0, 40.0, 30.0]
"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fs::write(folder.path().join("free.toml"), FREE).expect("written");
    fs::write(folder.path().join("module.toml"), MODULE).expect("written");
    folder
}

fn run(folder: &Path, line: &str) -> Outcome {
    let outcome = freeact_in(folder, line);
    println!("{line}:\n{}{}", outcome.stdout, outcome.stderr);
    outcome
}

fn close(value: &serde_json::Value, expected: f64, relative: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value - expected).abs() <= relative * expected.abs(), "{value} instead of {expected}");
}

#[test]
fn a_stiff_free_gives_what_virtual_work_says() {
    let folder = folder();
    let at = folder.path();
    let found = run(at, "blocked --of @free.toml --out @out --steps 5 --json").succeeded().json();
    let per_kpa = &found["generators"][0]["per_kpa"];
    let (radius, cot) = (5e-3f64, 1.0 / 48f64.to_radians().tan());
    // On the tip's plate; contracting, and a left-handed FREE turns it counter-clockwise. What is left is the threads' own stretch.
    close(&per_kpa["fz_n"], 1e3 * PI * radius.powi(2) * (1.0 - 2.0 * cot * cot), 3e-3);
    close(&per_kpa["mz_nmm"], 1e6 * 2.0 * PI * radius.powi(3) * cot, 3e-3);
    let table = Table::read(&at.join("out/wrenches.csv"));
    let columns = ["p1_kpa", "fx_n", "fy_n", "fz_n", "mx_nmm", "my_nmm", "mz_nmm", "status"];
    assert_eq!(table.columns, columns);
    assert_eq!(table.rows.len(), 6);
    for (step, row) in table.rows.iter().enumerate() {
        let pressure = table.number(row, "p1_kpa");
        assert_eq!(pressure, 10.0 * step as f64);
        let linear = per_kpa["fz_n"].as_f64().expect("a number") * pressure;
        assert!((table.number(row, "fz_n") - linear).abs() <= 0.01 * linear.abs());
        assert_eq!(row[7], "section");
    }
    // Held shorter, it pulls less by its rubber; held at its own turn, it gives less torque.
    let shorter = run(at, "blocked --of @free.toml --out @out --pose-mm 0,0,99 --json").succeeded().json();
    assert!(shorter["without_pressure"]["fz_n"].as_f64().expect("a number") > 0.01);
    for file in ["fz-mz.svg", "fz-mz.png", "blocked.json"] {
        assert!(at.join("out").join(file).exists(), "{file}");
    }
}

#[test]
fn a_module_without_spacers_is_the_sum_of_its_frees() {
    let folder = folder();
    let at = folder.path();
    let text = run(at, "blocked --of @module.toml --out @out --steps 4").succeeded().stdout;
    for words in ["FREE 3, linear, 30.00 kPa", "linear misses by at most", "fz-mz", "mx-my"] {
        assert!(text.contains(words), "{words}");
    }
    let found: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(at.join("out/blocked.json")).expect("JSON")).expect("JSON");
    assert_eq!((&found["states"], &found["not_found"]), (&125.into(), &0.into()));
    assert_eq!(found["corners"].as_array().map(Vec::len), Some(8));
    let table = Table::read(&at.join("out/wrenches.csv"));
    let row = |pressures: [f64; 3]| {
        let names = ["p1_kpa", "p2_kpa", "p3_kpa"];
        let is = |row: &&Vec<String>| names.map(|name| table.number(row, name)) == pressures;
        table.rows.iter().find(is).expect("such pressures")
    };
    let force = |pressures, name| table.number(row(pressures), name);
    for name in ["fz_n", "mx_nmm", "my_nmm", "mz_nmm"] {
        let alone =
            force([40.0, 0.0, 0.0], name) + force([0.0, 40.0, 0.0], name) + force([0.0, 0.0, 30.0], name);
        let all = force([40.0, 40.0, 30.0], name);
        assert!((all - alone).abs() < 1e-6 * (1.0 + alone.abs()), "{name}: {all} {alone}");
    }
    // The force of FREE 1 acts at its place: my = -x fz. Its mirror image turns the other way.
    let first = [40.0, 0.0, 0.0];
    assert!((force(first, "my_nmm") + 10.0 * force(first, "fz_n")).abs() < 1e-6);
    assert!((force(first, "mz_nmm") + force([0.0, 40.0, 0.0], "mz_nmm")).abs() < 1e-6);
    let shadow = found["shadows"]
        .as_array()
        .expect("a list")
        .iter()
        .find(|shadow| shadow["components"] == serde_json::json!(["fz_n", "mz_nmm"]));
    let shadow = shadow.expect("fz-mz");
    let generator = |free: usize, name: &str| {
        let generator = &found["generators"][free];
        let top = generator["pressure_max_kpa"].as_f64().expect("a number");
        top * generator["per_kpa"][name].as_f64().expect("a number")
    };
    let pairs = [(0, 1), (0, 2), (1, 2)].map(|(a, b)| {
        (generator(a, "fz_n") * generator(b, "mz_nmm") - generator(b, "fz_n") * generator(a, "mz_nmm")).abs()
    });
    close(&shadow["linear_area"], pairs.iter().sum(), 1e-9);
    close(&shadow["reachable_area"], shadow["linear_area"].as_f64().expect("a number"), 0.1);
    assert!(!at.join("out/fx-fy.svg").exists(), "straight FREEs give no force across");
    assert!(at.join("out/fz-mz.png").exists() && at.join("out/mx-my.svg").exists());
}

#[test]
fn a_plate_may_be_held_elsewhere_and_spacers_tie() {
    let folder = folder();
    let at = folder.path();
    let line = "blocked --of @module.toml --out @out --pose-mm 3,0,121 --rotation 0.999,0.02,0,0.03 --steps 2 --pressure-max-kpa 10 --json";
    let found = run(at, line).succeeded().json();
    assert_eq!(found["frees_are"], "independent");
    assert!(at.join("out/fx-fy.svg").exists());
    let module = data("modules/buffinton-2020-30lr.toml").display().to_string();
    let line = format!("blocked --of {module} --out @tied --steps 1 --json");
    let found = run(at, &line).succeeded().json();
    assert_eq!((&found["frees_are"], &found["states"]), (&"tied by spacers".into(), &16.into()));
    // Opposite hands at equal pressures: no torque at the last corner.
    let table = Table::read(&at.join("tied/wrenches.csv"));
    let last = table.rows.last().expect("rows");
    assert!(table.number(last, "mz_nmm").abs() < 1e-6 && table.number(last, "fz_n").abs() > 0.1);
}

#[test]
fn what_cannot_be_held_is_refused_in_words() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("broken.toml"), MODULE.replace("wall_mm = 1.0", "wall_mm = -1.0")).expect("written");
    fs::copy(data("maps/buffinton-2020-30lr.map"), at.join("module.map")).expect("copied");
    let cases: &[(&str, i32, &str)] = &[
        ("blocked --of @module.map --out @x", 5, "a description is a TOML file"),
        ("blocked --of @free.toml --out @x --pose-mm a,0,100", 2, "numbers like 5,-3,178"),
        ("blocked --of @module.toml", 2, "--out"),
        ("blocked --of @nothing.toml --out @x", 5, "No such file"),
        ("blocked --of @broken.toml --out @x", 5, "must be positive"),
        ("blocked --of @module.toml --out @x --pose-mm 0,0,3", 2, "half and twice"),
        ("blocked --of @module.toml --out @x --pose-mm 0,0", 2, "3 are needed"),
        ("blocked --of @module.toml --out @x --pose-mm 0,0,nan", 2, "not a number"),
        ("blocked --of @module.toml --out @x --rotation 0,0,0,0", 2, "no direction"),
        ("blocked --of @module.toml --out @x --pressure-max-kpa 10,20", 2, "2 pressures for 3 FREEs"),
        ("blocked --of @module.toml --out @x --pressure-max-kpa -5", 2, "not positive"),
        ("blocked --of @module.toml --out @x --steps 0", 2, "--steps"),
        ("blocked --of @module.toml --out @x --steps 900", 2, "take fewer"),
        ("blocked --of @free.toml --out @x --pose-mm 5,0,100", 2, "hold it on its axis"),
        ("blocked --of @free.toml --out @x --rotation 0.9,0.1,0,0", 2, "hold it on its axis"),
    ];
    for (line, code, words) in cases {
        let outcome = run(at, line);
        assert_eq!(outcome.code, *code, "{line}");
        assert!(outcome.message().contains(words), "{line}: no \"{words}\" in {}", outcome.message());
        assert!(!at.join("x").exists(), "{line}: a folder was made");
    }
}
