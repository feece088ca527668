//! Maps of a single FREE by solids: a short tube from description to model, in parts and at once.

use freeact_tests::{Table, data, describe_free, freeact_in};
use std::{fs, path::Path};

/// Of the FREE, mm.
const LENGTH: f64 = 60.0;

fn csv(folder: &Path, map: &str) -> Table {
    Table::parse(&freeact_in(folder, &format!("inspect @{map} --csv")).succeeded().stdout)
}

const AXES: &str =
    "--of @free.toml --winding-angles 30,60 --pressure-max-kpa 40 --pressure-step-kpa 10 --checks 1";

#[test]
fn a_short_free_from_description_to_model() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    describe_free(folder, LENGTH);
    let whole = freeact_in(folder, &format!("map {AXES} --fidelity solid --out @solid.map --json"))
        .succeeded()
        .json();
    assert_eq!((&whole["fidelity"], &whole["computed"]), (&"solid".into(), &2.into()), "{whole}");
    assert!(whole["worst_residual"].as_f64().expect("a number") < 1e-8);
    // 60 mm in elements of 0.26 outer radii.
    assert!(whole["settings"].as_str().expect("words").contains("2 x 24 x 45"), "{whole}");

    // In two parts, one of them going on with what the other has left.
    for part in 1..=2 {
        let outcome =
            freeact_in(folder, &format!("map {AXES} --fidelity solid --shard {part}/2 --out @{part}.map"));
        assert_eq!(outcome.code, 0, "{outcome:?}");
    }
    freeact_in(folder, "merge @1.map @2.map --out @merged.map").succeeded();
    freeact_in(folder, &format!("map {AXES} --fidelity solid --resume --out @1.map")).succeeded();
    let bytes = |name: &str| fs::read(folder.join(name)).expect(name);
    assert!(bytes("merged.map") == bytes("solid.map"), "the merged map differs");
    assert!(bytes("1.map") == bytes("solid.map"), "the resumed map differs");
    let refused = freeact_in(folder, &format!("map {AXES} --resume --out @1.map"));
    assert!(refused.code == 4 && refused.message().contains("the fidelities differ"), "{refused:?}");

    // The middle is as the section far from caps; the bounds are those asked of solids and sections.
    freeact_in(folder, &format!("map {AXES} --out @section.map")).succeeded();
    let (solid, section) = (csv(folder, "solid.map"), csv(folder, "section.map"));
    assert_eq!(
        solid.columns[..10].join(","),
        "winding_angle_deg,shear_modulus_mpa,pressure_kpa,axial_stretch,expansion,twist_per_length_deg_per_mm,\
         mid_axial_stretch,mid_twist_per_length_deg_per_mm,limit_pressure_kpa,status"
    );
    let mut compared = 0;
    for ours in &solid.rows {
        let axes = ["winding_angle_deg", "pressure_kpa"];
        let theirs = section.rows.iter().find(|row| {
            axes.iter().all(|axis| (section.number(row, axis) - solid.number(ours, axis)).abs() < 1e-6)
        });
        let Some(theirs) = theirs else { continue };
        let [stretch, twist] =
            ["axial_stretch", "twist_per_length_deg_per_mm"].map(|c| section.number(theirs, c));
        let mid_stretch = solid.number(ours, "mid_axial_stretch");
        assert!((mid_stretch - stretch).abs() < 5e-3 * (stretch - 1.0).abs() + 5e-4, "{ours:?} {theirs:?}");
        let mid_twist = solid.number(ours, "mid_twist_per_length_deg_per_mm");
        assert!((mid_twist - twist).abs() <= 0.015 * twist.abs() + 1e-9, "{ours:?} {theirs:?}");
        assert_eq!(ours[9], "converged");
        compared += 1;
    }
    assert_eq!(compared, 10);

    let text = freeact_in(folder, "inspect @solid.map --plot @plots").succeeded().stdout;
    assert!(text.contains("by solid") && text.contains("mid twist"), "{text}");
    let chart = fs::read_to_string(folder.join("plots/twist-by-winding-angle.svg")).expect("a chart");
    assert!(chart.contains("middle"), "no curve of the middle");

    // A model of it is one of the whole, cap to cap.
    freeact_in(folder, "fit @solid.map --out @solid.model").succeeded();
    fs::write(folder.join("p.csv"), "p1_kpa,winding_angle_deg\n30,30\n30,60\n").expect("writes");
    freeact_in(folder, "predict --model @solid.model --pressures @p.csv --out @predicted.csv").succeeded();
    let predicted = Table::read(&folder.join("predicted.csv"));
    for row in &predicted.rows {
        let node = solid.rows.iter().find(|node| {
            solid.number(node, "winding_angle_deg") == predicted.number(row, "winding_angle_deg")
                && solid.number(node, "pressure_kpa") == 30.0
        });
        for column in ["axial_stretch", "twist_per_length_deg_per_mm"] {
            let expected = solid.number(node.expect("the node"), column);
            // The spline goes through the states up to its own resampling.
            assert!(
                (predicted.number(row, column) / expected - 1.0).abs() < 1e-3,
                "{column}: {row:?} {expected}"
            );
        }
    }
}

#[test]
fn solids_that_cannot_be_are_refused_in_words() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    describe_free(folder, LENGTH);
    let module = data("modules/buffinton-2020-30lr.toml");
    fs::copy(module, folder.join("module.toml")).expect("copies");
    let cases = [
        ("--of @free.toml --fidelity solid --elements 1,10,20", 2, "even number for each fibre"),
        ("--of @free.toml --fidelity solid --elements 1,12", 2, "as in 1,12,90"),
        ("--of @free.toml --elements 1,12,40", 2, "give --fidelity solid"),
        ("--of @free.toml --fidelity rod", 2, "section or solid"),
        ("--of @module.toml --fidelity solid", 4, "set spacers = 0"),
        ("--of @free.toml --fidelity solid --winding-angles 0", 2, "not between 1 and 89.5"),
    ];
    for (line, code, words) in cases {
        let outcome = freeact_in(folder, &format!("map {line} --out @x.map"));
        assert!(outcome.code == code && outcome.message().contains(words), "{line}: {outcome:?}");
        assert!(!folder.join("x.map").exists(), "{line}: a map was left");
    }
}
