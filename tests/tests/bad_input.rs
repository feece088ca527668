//! Every kind of bad input gets a sentence that says where it is wrong and what to do, an exit code, and no panic.

use freeact_tests::{Outcome, data, freeact};
use std::{fs, path::Path};

/// Checks the refusal: an exit code that is not success, every fragment in the message, and no panic.
#[track_caller]
fn refused(outcome: &Outcome, fragments: &[&str]) {
    assert!(outcome.code > 0 && outcome.code != 101, "exit code {}: {outcome:?}", outcome.code);
    assert!(!outcome.stderr.contains("panicked"), "{}", outcome.stderr);
    // Long messages are wrapped for the terminal: compare without the breaks.
    let message = outcome.stderr.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    for fragment in fragments {
        assert!(message.contains(fragment), "no \"{fragment}\" in:\n{}", outcome.stderr);
    }
}

fn run(folder: &Path, line: &str) -> Outcome {
    let arguments = line.split_whitespace().map(|word| match word.strip_prefix('@') {
        Some(name) => folder.join(name).into_os_string(),
        None => word.into(),
    });
    freeact(arguments)
}

#[test]
fn broken_descriptions() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let good = fs::read_to_string(data("actuators/buffinton-2020.toml")).expect("the paper's FREE");
    let module = fs::read_to_string(data("modules/buffinton-2020-30lr.toml")).expect("a module");
    let line_of =
        |text: &str, field: &str| text.lines().position(|line| line.starts_with(field)).expect(field) + 1;
    let wall = format!("x.toml:{}", line_of(&good, "wall_mm"));
    let angle = format!("x.toml:{}", line_of(&good, "winding_angle_deg"));
    let cases: &[(&str, String, &[&str])] = &[
        ("not TOML", good.replace("wall_mm = 0.8", "wall_mm = = 0.8"), &[&wall]),
        ("an empty file", String::new(), &["x.toml", "`kind`", "is missing"]),
        (
            "an unknown kind",
            good.replace("kind = \"free\"", "kind = \"tube\""),
            &["`kind`", "\"free\" or \"module\""],
        ),
        (
            "a negative wall",
            good.replace("wall_mm = 0.8", "wall_mm = -0.8"),
            &[&wall, "`wall_mm`", "must be positive"],
        ),
        (
            "a wall in metres misread",
            good.replace("wall_mm = 0.8", "wall_mm = 80"),
            &["`wall_mm`", "check the unit"],
        ),
        ("a missing field", good.replace("fibres =", "# fibres ="), &["`fibres`", "is missing"]),
        (
            "a misspelt field",
            good.replace("fibre_ea_newton", "fibre_ea_n"),
            &["`fibre_ea_newton`", "is missing"],
        ),
        (
            "an extra field",
            good.replace("fibres =", "colour = \"red\"\nfibres ="),
            &["`colour`", "not known here"],
        ),
        ("rings", good.replace("_deg = 30.0", "_deg = 0.0"), &[&angle, "between 1 and 89.5"]),
        (
            "text for a number",
            good.replace("_mm = 130.0", "_mm = \"long\""),
            &["`length_mm`", "must be a number"],
        ),
        ("not a number", good.replace("_mm = 130.0", "_mm = nan"), &["`length_mm`", "finite"]),
        ("half a fibre", good.replace("fibres = 6", "fibres = 6.5"), &["`fibres`", "whole number"]),
        ("an unknown rubber", good.replace("\"ogden\"", "\"jelly\""), &["`elastomer.model`", "neo-hookean"]),
        ("an unknown hand", good.replace("\"right\"", "\"both\""), &["`handedness`", "\"left\""]),
        (
            "FREEs through each other",
            module.replace("[-7.5, 7.5]", "[7.4, 7.5]"),
            &["position_mm", "overlaps"],
        ),
        ("an unknown freedom", module.replace("\"rz\"", "\"spin\""), &["tip.free_dof", "rx, ry, rz"]),
        (
            "a limit per FREE too few",
            module.replace("max_kpa = 50.0", "max_kpa = [50.0, 50.0]"),
            &["list of 4 numbers"],
        ),
        (
            "two numbers of gravity",
            module.replace("[0.0, 0.0, 1.0]", "[0.0, 1.0]"),
            &["base.gravity", "3 numbers"],
        ),
    ];
    for (what, text, fragments) in cases {
        assert!(*text != good && *text != module, "{what}: the case changes nothing");
        fs::write(folder.path().join("x.toml"), text).expect("written");
        let outcome = run(folder.path(), "map --of @x.toml --out @x.map");
        println!("{what}: {}", outcome.stderr.trim());
        refused(&outcome, fragments);
        assert!(!folder.path().join("x.map").exists(), "{what}: a map was written");
    }
}

#[test]
fn files_that_are_missing_or_of_another_kind() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).expect("written");
    write("text.map", b"this is not a map at all, only text");
    write("empty.model", b"");
    write("short.model", b"FREEmdl\0\x01\0\0");
    write("future.model", &[b"FREEmdl\0\xff\0\0\0".as_slice(), &[0; 40]].concat());
    write("wrong-sum.model", &[b"FREEmdl\0\x01\0\0\0".as_slice(), &[0; 40]].concat());
    write("text.mcap", b"this is not an mcap file either");
    write("cut.mcap", b"\x89MCAP0\r\n");
    write("pressures.csv", b"p1_kpa\n10\n");
    let cases: &[(&str, &[&str])] = &[
        ("map --of @nothing.toml --out @x.map", &["nothing.toml", "No such file"]),
        ("fit @nothing.map --out @x.model", &["nothing.map", "No such file"]),
        ("fit @text.map --out @x.model", &["text.map", "not a freeact map"]),
        (
            "predict --model @empty.model --pressures @pressures.csv --out @y.csv",
            &["empty.model", "not a freeact model"],
        ),
        ("predict --model @short.model --pressures @pressures.csv --out @y.csv", &["short.model", "header"]),
        ("predict --model @future.model --pressures @pressures.csv --out @y.csv", &["version 255", "newer"]),
        ("predict --model @wrong-sum.model --pressures @pressures.csv --out @y.csv", &["checksum"]),
        ("solve --model @text.map --target-mm 0,0,180", &["text.map", "not a freeact model"]),
        ("replay @text.mcap", &["text.mcap"]),
        ("replay @cut.mcap", &["cut.mcap"]),
        ("inspect @text.mcap", &["text.mcap"]),
        ("inspect @nothing.mcap", &["nothing.mcap"]),
    ];
    for (line, fragments) in cases {
        let outcome = run(folder.path(), line);
        println!("{line}: {}", outcome.stderr.trim());
        refused(&outcome, fragments);
    }
}

#[test]
fn broken_recordings() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let rig = fs::read_to_string(data("modules/buffinton-2020-30lr.toml")).expect("a module");
    fs::write(folder.path().join("rig.toml"), rig).expect("written");
    let header =
        "t_s,p1_command_kpa,p2_command_kpa,p3_command_kpa,p4_command_kpa,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    let row = |time: &str| format!("{time},1,1,1,1,0,0,175,1,0,0,0\n");
    let cases: &[(&str, String, &[&str])] = &[
        ("empty", String::new(), &["x.csv", "empty"]),
        ("no rows", header.to_owned(), &["x.csv"]),
        ("no time", header.replace("t_s", "when") + &row("0"), &["x.csv", "t_s"]),
        ("a word for a number", header.to_owned() + &row("0") + &row("soon"), &["x.csv:3", "t_s", "soon"]),
        ("time runs back", header.to_owned() + &row("0") + &row("2") + &row("1"), &["x.csv:4", "t_s"]),
        ("a short row", header.to_owned() + "0,1,1\n", &["x.csv:2"]),
        ("a FREE too many", header.replace("p4_", "p9_") + &row("0"), &["x.csv", "p9_command_kpa"]),
        (
            "a quaternion of length two",
            header.to_owned() + "0,1,1,1,1,0,0,175,2,0,0,0\n",
            &["x.csv", "quaternion"],
        ),
    ];
    for (what, text, fragments) in cases {
        fs::write(folder.path().join("x.csv"), text).expect("written");
        let outcome = run(folder.path(), "import @x.csv --rig @rig.toml --out @x.mcap");
        println!("{what}: {}", outcome.stderr.trim());
        refused(&outcome, fragments);
    }
}

#[test]
fn impossible_arguments() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fs::copy(data("actuators/buffinton-2020.toml"), folder.path().join("x.toml")).expect("copied");
    let cases: &[(&str, &[&str])] = &[
        ("", &["Usage"]),
        ("fly", &["fly"]),
        ("map --out @x.map", &["--of"]),
        ("map --of @x.toml --out @x.map --winding-angles 80:10:10", &["--winding-angles"]),
        ("map --of @x.toml --out @x.map --winding-angles 10:80:0", &["--winding-angles"]),
        ("map --of @x.toml --out @x.map --winding-angles 0,20", &["--winding-angles"]),
        ("map --of @x.toml --out @x.map --shear-moduli-mpa -1", &["--shear-moduli-mpa"]),
        ("map --of @x.toml --out @x.map --pressure-max-kpa -5", &["--pressure-max-kpa"]),
        ("map --of @x.toml --out @x.map --shard 3/2", &["--shard"]),
        ("map --of @x.toml --out @x.map --fidelity perfect", &["--fidelity"]),
    ];
    for (line, fragments) in cases {
        let outcome = run(folder.path(), line);
        println!("{line}: {}", outcome.stderr.trim());
        refused(&outcome, fragments);
    }
}

/// Refusals that need no base map come before it: it takes minutes.
#[test]
fn identify_refuses_before_it_computes_a_base_map() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    let rig = |name: &str| data(name).display().to_string();
    let held = rig("rigs/rig-a/2-triangles.mcap");
    let module = rig("rigs/rig-a/rig.toml");
    let pressures = "t_s,p1_kpa,p2_kpa,p3_kpa,p4_kpa\n0,0,0,0,0\n0.05,1,0,0,0\n";
    fs::write(folder.path().join("blind.csv"), pressures).expect("written");
    fs::copy(data("rigs/rig-a/2-triangles.mcap"), folder.path().join("copy.mcap")).expect("copied");
    fs::write(folder.path().join("free.csv"), "t_s,p1_kpa,twist_rad\n0,0,0\n1,5,0.1\n").expect("written");
    let cases = [
        (&module, at("blind.csv"), held.clone(), "no pose of the tip"),
        (&module, at("copy.mcap"), held.clone(), "both fitted and held out"),
        (&rig("actuators/buffinton-2020.toml"), at("free.csv"), at("free2.csv"), "--holdout is for modules"),
    ];
    fs::copy(folder.path().join("free.csv"), folder.path().join("free2.csv")).expect("copied");
    for (rig, fit, held, words) in cases {
        let out = at("results");
        let outcome =
            freeact(["identify", "--rig", rig, "--recordings", &fit, "--holdout", &held, "--out", &out]);
        assert!(outcome.code > 0 && outcome.stderr.contains(words), "{words}: {outcome:?}");
        assert!(!folder.path().join("results").exists(), "{words}: a base map was begun");
    }
}
