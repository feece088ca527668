//! Maps over more than winding angle, shear modulus and pressure.

use freeact_tests::{Table, describe_free, freeact_in};
use std::{fs, path::Path};

fn csv(folder: &Path, map: &str) -> Table {
    let table = folder.join(map).with_extension("csv");
    freeact_in(folder, &format!("inspect @{map} --csv --out @{}", table.file_name().unwrap().display()))
        .succeeded();
    Table::read(&table)
}

/// The state at a pressure (kPa) of the node with these values of the named columns.
fn state<'t>(table: &'t Table, place: &[(&str, f64)], kpa: f64) -> &'t [String] {
    let at = |row: &[String], column: &str, value: f64| (table.number(row, column) - value).abs() < 1e-9;
    let mut rows = table.rows.iter().filter(|row| {
        at(row, "pressure_kpa", kpa) && place.iter().all(|(column, value)| at(row, column, *value))
    });
    rows.next().expect("a row")
}

#[test]
fn a_node_on_named_axes_is_the_free_described_so() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    describe_free(folder, 130.0);
    freeact_in(
        folder,
        "map --of @free.toml --out @all.map --axis wall_mm=0.7,0.9 --axis fibres=4,8 --axis torque_nmm=0,4 --winding-angles 25,40 \
         --pressure-max-kpa 30 --pressure-step-kpa 15 --checks 2",
    )
    .succeeded();
    let all = csv(folder, "all.map");
    assert_eq!(
        all.columns[..6].join(","),
        "winding_angle_deg,shear_modulus_mpa,pressure_kpa,wall_mm,fibres,torque_nmm"
    );

    // The same tube, written down.
    let text = fs::read_to_string(folder.join("free.toml")).expect("the description");
    let set = |text: String, field: &str, value: &str| {
        let lines = text.lines().map(|line| match line.starts_with(field) {
            true => format!("{field} = {value}\n"),
            false => format!("{line}\n"),
        });
        lines.collect::<String>()
    };
    let text = set(set(set(text, "wall_mm", "0.9"), "fibres", "8"), "winding_angle_deg", "40");
    fs::write(folder.join("other.toml"), text).expect("a description");
    freeact_in(folder, "map --of @other.toml --out @other.map --pressure-max-kpa 30 --pressure-step-kpa 15")
        .succeeded();
    let other = csv(folder, "other.map");
    let values = |table: &Table, row: &[String]| {
        ["axial_stretch", "expansion", "twist_per_length_deg_per_mm"].map(|column| table.number(row, column))
    };
    for kpa in [0.0, 15.0, 30.0] {
        let place = [("winding_angle_deg", 40.0), ("wall_mm", 0.9), ("fibres", 8.0), ("torque_nmm", 0.0)];
        let (ours, theirs) =
            (values(&all, state(&all, &place, kpa)), values(&other, state(&other, &[], kpa)));
        for (a, b) in ours.iter().zip(theirs) {
            assert!((a - b).abs() < 1e-9, "{ours:?} {theirs:?}");
        }
        // A torque against the sense in which the FREE turns holds it back, without pressure too.
        let loaded = [place[0], place[1], place[2], ("torque_nmm", 4.0)];
        assert!(values(&all, state(&all, &loaded, kpa))[2] > ours[2] + 0.05, "{kpa} kPa");
    }

    // A model has no such axes, and says so.
    let refused = freeact_in(folder, "fit @all.map --out @all.model");
    assert!(
        refused.code != 0 && refused.message().contains("make a map for one value of wall_mm"),
        "{refused:?}"
    );
    // One value is no axis: it is the FREE's own.
    freeact_in(
        folder,
        "map --of @free.toml --out @one.map --axis wall_mm=0.9 --axis fibres=8 --winding-angles 40 --pressure-max-kpa 30 \
         --pressure-step-kpa 15",
    )
    .succeeded();
    let one = csv(folder, "one.map");
    assert_eq!(one.columns[3], "axial_stretch");
    assert_eq!(state(&one, &[], 15.0)[2..], state(&other, &[], 15.0)[2..]);
    freeact_in(folder, "fit @one.map --out @one.model").succeeded();
}

#[test]
fn axes_that_make_no_sense_are_refused_by_name() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    describe_free(folder, 130.0);
    for (axis, words) in [
        ("wall=0.8", "`wall` is no axis"),
        ("wall_mm", "NAME=VALUES"),
        ("wall_mm=-0.8,0.8", "a wall has a positive thickness"),
        ("fibres=3.5", "a whole number"),
        ("fibres=4,4", "given twice"),
        ("winding_angle_deg=20 --winding-angles 30", "is given twice"),
        ("torque_nmm=0:1", "has no step"),
    ] {
        let refused = freeact_in(folder, &format!("map --of @free.toml --out @x.map --axis {axis}"));
        assert!(refused.code == 2 && refused.message().contains(words), "{axis}: {refused:?}");
        assert!(!folder.join("x.map").exists());
    }
}
