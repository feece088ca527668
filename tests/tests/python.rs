//! The Python module: built, installed and compared with the program.

use freeact_tests::{freeact_in, images, project};
use std::{fmt::Write as _, fs, path::Path, process::Command};

fn run(command: &mut Command) -> String {
    let output = command.output().expect("Python runs");
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{text}");
    text
}

/// A Weyl sequence, the same on every machine: numbers from zero to one.
fn scattered(row: usize, column: usize) -> f64 {
    (row as f64 * [2f64, 3.0, 5.0, 7.0, 11.0][column].sqrt()).fract()
}

fn write(folder: &Path, name: &str, head: &str, row: impl Fn(usize) -> Vec<f64>) {
    let mut text = format!("{head}\n");
    for index in 1..=400 {
        let cells: Vec<String> = row(index).iter().map(|number| format!("{number:e}")).collect();
        text += &(cells.join(",") + "\n");
    }
    fs::write(folder.join(name), text).expect("written");
}

/// Commands over time, and what Rust makes of them.
fn steps(folder: &Path) {
    let model = images::module();
    let tip = model.as_module().expect("a module").tip_model();
    let chain = model.effects.of(4);
    let mut memory = vec![0.0; chain.memory()];
    let (mut steps, mut stepped) = ("step_s,p1_pa,p2_pa,p3_pa,p4_pa\n".to_owned(), String::new());
    stepped += "x,y,z,w,i,j,k,a,b,c,d,e,f\n";
    for row in 1..=300 {
        let step = 0.05 * scattered(row, 4);
        let mut pressures: Vec<f64> = (0..4).map(|free| 80e3 * scattered(row, free)).collect();
        let words: Vec<String> = pressures.iter().map(|pressure| format!("{pressure:e}")).collect();
        writeln!(steps, "{step:e},{}", words.join(",")).expect("text");
        chain.supply(&mut memory, step, &mut pressures);
        let mut cells = vec![String::new(); 13];
        if let Ok(found) = tip.evaluate(&chain, &mut memory, step, &pressures) {
            let numbers = found.pose.position.iter().chain(&found.pose.rotation).chain(&found.jacobian[3]);
            cells = numbers.map(|number| format!("{number:e}")).collect();
        }
        writeln!(stepped, "{}", cells.join(",")).expect("text");
    }
    fs::write(folder.join("steps.csv"), steps).expect("written");
    fs::write(folder.join("stepped.csv"), stepped).expect("written");
}

#[test]
fn the_python_module_answers_as_the_program() {
    let Some(python) = std::env::var_os("FREEACT_PYTHON") else {
        println!("skipped: set FREEACT_PYTHON to a Python with tests/python/requirements.txt installed");
        return;
    };
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = scratch.path();
    images::module().write(&folder.join("module.model")).expect("written");
    images::free().write(&folder.join("free.model")).expect("written");
    let map = project().join("data/maps/buffinton-2020-30lr.map");
    fs::copy(map, folder.join("m.map")).expect("copied");
    freeact_in(folder, "fit @m.map --out @bars.model").succeeded();
    let pressures = |row| (0..4).map(|free| 66.0 * scattered(row, free)).collect();
    write(folder, "pressures.csv", "p1_kpa,p2_kpa,p3_kpa,p4_kpa", pressures);
    let state = |row| vec![100.0 * scattered(row, 0), 22.0 + 14.0 * scattered(row, 1), 0.393];
    write(folder, "states.csv", "p1_kpa,winding_angle_deg,shear_modulus_mpa", state);
    // Some rows are outside, which the program tells by its exit code.
    for line in [
        "predict --model @module.model --pressures @pressures.csv --out @poses.csv",
        "predict --model @free.model --pressures @states.csv --out @deformations.csv",
    ] {
        let outcome = freeact_in(folder, line);
        assert_eq!(outcome.code, 4, "{outcome:?}");
    }
    steps(folder);

    let (wheels, site) = (folder.join("wheels"), folder.join("site"));
    let mut build = Command::new(&python);
    build.args(["-m", "maturin", "build", "--quiet", "--release", "--locked", "--target-dir"]);
    build.arg(project().join("target/python")).arg("--out").arg(&wheels);
    run(build.current_dir(project().join("bindings/python")));
    let wheel = fs::read_dir(&wheels).expect("wheels").next().expect("one wheel").expect("an entry").path();
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--target"]);
    run(install.arg(&site).arg(wheel));
    assert!(site.join("freeact/py.typed").exists(), "its types are told");
    let mut evaluate = Command::new(&python);
    evaluate.arg(project().join("tests/python/evaluate_model.py")).arg(folder).env("PYTHONPATH", &site);
    let text = run(&mut evaluate);
    assert!(text.contains("400 poses, 400 deformations, 300 steps agree"), "{text}");
}
