//! `freeact material`: fits to tests of rubber and thread, what it writes, and what it says of bad input.

use freeact_tests::{Outcome, freeact};
use std::{fs, path::Path};

fn run(folder: &Path, line: &str) -> Outcome {
    let arguments = line.split_whitespace().map(|word| match word.strip_prefix('@') {
        Some(name) => folder.join(name).into_os_string(),
        None => word.into(),
    });
    freeact(arguments)
}

/// Mooney-Rivlin rubber, 2 (l - l3^2/l)(c10 + c01 l2^2), by the textbook's formulas, with compression.
fn mooney_rivlin(c10: f64, c01: f64) -> String {
    let mut text = String::from("mode,stretch,stress_mpa\n");
    for i in 0..=20 {
        let l = 0.7 + 0.1 * f64::from(i);
        text += &format!("uniaxial,{l},{}\n", 2.0 * (l - l.powi(-2)) * (c10 + c01 / l));
        let l = 0.9 + 0.05 * f64::from(i);
        text += &format!("equibiaxial,{l},{}\n", 2.0 * (l - l.powi(-5)) * (c10 + c01 * l * l));
        let l = 1.0 + 0.08 * f64::from(i);
        text += &format!("planar,{l},{}\n", 2.0 * (l - l.powi(-3)) * (c10 + c01));
    }
    text
}

#[test]
fn a_fit_goes_from_tests_to_a_description() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    fs::write(folder.join("tests.csv"), mooney_rivlin(0.15, 0.02)).expect("written");
    let found =
        run(folder, "material --test @tests.csv --model mooney-rivlin --out @out --json").succeeded().json();
    let fit = &found["rubber"]["fits"][0];
    let value = |name: &str| fit["parameters"][name]["value"].as_f64().expect(name);
    // Written with all digits: what is lost is the fit's own.
    assert!((value("c10_mpa") - 0.15).abs() < 1e-7 && (value("c01_mpa") - 0.02).abs() < 1e-7, "{fit:#}");
    assert!((fit["young_modulus_mpa"].as_f64().expect("E") - 1.02).abs() < 1e-6);
    assert!(fit["held_out_relative_rms"].as_f64().expect("several modes") < 1e-6);
    assert!(fit["modes"]["planar"]["stiffness_positive"][1].is_null());
    for name in ["mooney-rivlin.svg", "mooney-rivlin.png", "mooney-rivlin.toml"] {
        assert!(folder.join("out").join(name).metadata().expect(name).len() > 50, "{name}");
    }
    let table = fs::read_to_string(folder.join("out/mooney-rivlin.toml")).expect("the table");
    let description = format!(
        "kind = \"free\"\nlength_mm = 130\ninner_diameter_mm = 9.52\nwall_mm = 0.8\nwinding_angle_deg = 30\nfibres = 6\n\
         fibre_ea_newton = 644\n{table}"
    );
    fs::write(folder.join("free.toml"), description).expect("written");
    let text = run(folder, "inspect @free.toml").succeeded().stdout;
    assert!(text.contains("Mooney-Rivlin, c10 0.1500, c01 0.02000 MPa"), "{text}");
}

#[test]
fn all_models_are_compared_and_the_right_one_is_best() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    fs::write(folder.join("tests.csv"), mooney_rivlin(0.15, 0.02)).expect("written");
    let found = run(folder, "material --test @tests.csv --model all --terms 2 --json").succeeded().json();
    let names: Vec<&str> = found["rubber"]["fits"]
        .as_array()
        .expect("fits")
        .iter()
        .filter_map(|fit| fit["model"].as_str())
        .collect();
    assert_eq!(names.len(), 9, "{names:?}");
    // Two Ogden terms of exponents 2 and -2 are the same rubber.
    let best = found["rubber"]["best"].as_str().expect("a best");
    assert!(["mooney-rivlin", "ogden-2"].contains(&best), "{best}");
    let text = run(folder, "material --test @tests.csv --model all --terms 2").succeeded().stdout;
    for words in
        ["mode left out (%)", "Drucker-stable from", "21 uniaxial, 21 equibiaxial, 21 planar", "[elastomer]"]
    {
        assert!(text.contains(words), "no {words} in\n{text}");
    }
}

#[test]
fn hardness_and_thread_give_the_numbers_of_the_paper() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    let text = run(folder, "material --shore-a 30.8").succeeded().stdout;
    assert!(text.contains("E = 1.180 MPa, mu = 0.3934 MPa"), "{text}");
    let mut pull = String::from("extension_mm,force_n\n");
    for i in 0..12 {
        let extension = 0.1 * f64::from(i);
        pull += &format!("{extension},{}\n", 644.0 * extension / 50.0 + 0.02 * f64::from(i % 3));
    }
    fs::write(folder.join("pull.csv"), pull).expect("written");
    let found = run(folder, "material --fibre @pull.csv --fibre-length-mm 50 --json").succeeded().json();
    let [low, high] = [0, 1].map(|i| found["fibre"]["ci95"][i].as_f64().expect("an end"));
    assert!(low < 644.0 && 644.0 < high && high - low < 10.0, "{found:#}");
}

#[test]
fn bad_input_is_answered_in_words() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    let head = "mode,stretch,stress_mpa\n";
    let good = mooney_rivlin(0.15, 0.02);
    for (name, text) in [
        ("good.csv", good.clone()),
        ("empty.csv", String::new()),
        ("head.csv", head.into()),
        ("mode.csv", format!("{head}uniaxial,1.1,0.1\nbiaxial,1.2,0.2\n")),
        ("number.csv", format!("{head}uniaxial,1.1,0.1\nuniaxial,long,0.2\n")),
        ("blank.csv", format!("{head}uniaxial,1.1,\n")),
        ("percent.csv", format!("{head}uniaxial,-20,0.1\n")),
        ("sign.csv", format!("{head}uniaxial,0.8,0.1\n")),
        ("column.csv", "mode,strain,stress_mpa\nuniaxial,0.1,0.1\n".into()),
        ("few.csv", format!("{head}uniaxial,1.1,0.1\nuniaxial,1.2,0.17\n")),
        ("ragged.csv", format!("{head}uniaxial,1.1,0.1\nuniaxial,1.2\n")),
        ("pull.csv", "extension_mm,force_n\n0,0\n1,2\n".into()),
        ("still.csv", "strain,force_n\n0.01,1\n0.01,2\n".into()),
    ] {
        fs::write(folder.join(name), text).expect("written");
    }
    let cases: &[(&str, i32, &[&str])] = &[
        ("material", 2, &["--test"]),
        ("material --test @nothing.csv", 5, &["nothing.csv", "No such file"]),
        ("material --test @good.csv --model jelly", 2, &["jelly", "mooney-rivlin"]),
        ("material --test @good.csv --terms 7", 2, &["--terms"]),
        ("material --test @good.csv --terms 0", 2, &["--terms"]),
        ("material --shore-a 100", 2, &["--shore-a 100", "below 100"]),
        ("material --shore-a -3", 2, &["--shore-a -3"]),
        ("material --shore-a 30 --out @out", 2, &["--test"]),
        ("material --test @empty.csv", 5, &["empty.csv", "mode,stretch,stress_mpa"]),
        ("material --test @head.csv", 5, &["head.csv", "has no rows"]),
        ("material --test @mode.csv", 5, &["mode.csv:3: column `mode`", "biaxial", "planar"]),
        ("material --test @number.csv", 5, &["number.csv:3: column `stretch`", "`long` is not a number"]),
        ("material --test @blank.csv", 5, &["blank.csv:2: column `stress_mpa`", "is empty"]),
        ("material --test @percent.csv", 5, &["percent.csv:2: column `stretch`", "1 + strain"]),
        ("material --test @sign.csv", 5, &["sign.csv:2: column `stress_mpa`", "tension is positive"]),
        ("material --test @column.csv", 5, &["column.csv:1: column `stretch` is missing"]),
        ("material --test @few.csv --terms 3", 4, &["few.csv", "6 constants", "2 points"]),
        ("material --test @ragged.csv", 5, &["ragged.csv:3"]),
        ("material --fibre @pull.csv", 2, &["--fibre-length-mm"]),
        ("material --fibre @pull.csv --fibre-length-mm 0", 2, &["--fibre-length-mm 0"]),
        ("material --fibre @still.csv", 4, &["still.csv", "2 constants"]),
        ("material --test @good.csv --out @good.csv/x", 5, &["good.csv"]),
    ];
    for (line, code, fragments) in cases {
        let outcome = run(folder, line);
        println!("{line}: {}", outcome.stderr.trim());
        assert_eq!(outcome.code, *code, "{line}: {outcome:?}");
        assert!(!outcome.stderr.contains("panicked"), "{}", outcome.stderr);
        let message = outcome.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        for fragment in *fragments {
            assert!(message.contains(fragment), "{line}: no \"{fragment}\" in:\n{}", outcome.stderr);
        }
    }
}
