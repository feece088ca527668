//! Sections between caps against the solid of the same FREE, through the program.

use freeact_tests::{Table, describe_free, freeact_in};
use std::path::Path;

fn csv(folder: &Path, map: &str) -> Table {
    freeact_in(folder, &format!("inspect @{map}.map --csv --out @{map}.csv")).succeeded();
    Table::read(&folder.join(format!("{map}.csv")))
}

#[test]
fn a_capped_section_is_nearer_to_the_solid_than_the_section() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    describe_free(folder, 60.0);
    const AXES: &str =
        "--of @free.toml --winding-angles 60 --pressure-max-kpa 40 --pressure-step-kpa 20 --checks 0";
    for (name, more) in [("section", ""), ("capped", "--caps"), ("solid", "--fidelity solid")] {
        freeact_in(folder, &format!("map {AXES} {more} --out @{name}.map")).succeeded();
    }
    let [section, capped, solid] = ["section", "capped", "solid"].map(|name| csv(folder, name));
    assert_eq!(capped.columns[..8], solid.columns[..8]);
    for kpa in [20.0, 40.0] {
        let [ours, middle, whole] = [&capped, &section, &solid].map(|table| {
            let row = table.rows.iter().find(|row| (table.number(row, "pressure_kpa") - kpa).abs() < 1e-9);
            (table, row.expect("a row"))
        });
        let value = |(table, row): (&Table, &Vec<String>), column: &str| table.number(row, column);
        for column in ["axial_stretch", "twist_per_length_deg_per_mm"] {
            let (true_one, corrected, plain) =
                (value(whole, column), value(ours, column), value(middle, column));
            // Caps change both by more than the meshes of section and solid differ.
            assert!((corrected - true_one).abs() < 0.15 * (plain - true_one).abs(), "{column} at {kpa} kPa");
            assert_eq!(value(ours, &format!("mid_{column}")), plain);
        }
        for column in ["energy_j_per_m", "axial_stiffness_n", "twist_per_length_error_deg_per_mm"] {
            assert_eq!(value(ours, column), value(middle, column), "{column}");
        }
    }
    freeact_in(folder, "fit @capped.map --out @capped.model").succeeded();
    let refused = freeact_in(folder, &format!("map {AXES} --caps --fidelity solid --out @x.map"));
    assert!(refused.code == 2 && refused.message().contains("--caps"), "{refused:?}");
}
