//! The model of a section map at winding angles, moduli and pressures that its fit never saw, against the solid FE of the same tube.

use actuator::{Description, EndLoad, Rig, units::*};
use fe::SolidSweep;
use freeact_tests::{Table, data, freeact_in};
use std::fs;

/// Winding angle (° from the hoop), shear modulus (MPa) and share of the limit pressure: all between the map's nodes.
const HIDDEN: [[f64; 3]; 6] = [
    [17.3, 0.265, 0.55],
    [26.1, 0.740, 0.70],
    [34.7, 0.470, 0.80],
    [45.9, 0.910, 0.45],
    [57.2, 0.335, 0.75],
    [71.8, 0.620, 0.60],
];

#[test]
fn the_model_of_a_section_map_is_the_middle_of_the_solid() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let folder = folder.path();
    let paper = data("actuators/buffinton-2020.toml");
    fs::copy(&paper, folder.join("free.toml")).expect("the paper's FREE");
    freeact_in(
        folder,
        "map --of @free.toml --out @free.map --winding-angles 10:80:10 --shear-moduli-mpa 0.2:1:0.1 --pressure-max-kpa 59",
    )
    .succeeded();
    freeact_in(folder, "fit @free.map --out @free.model").succeeded();

    let rig = Rig::read(&paper).expect("the paper's FREE");
    let Description::Free(mut free) = rig.description else { panic!("a FREE") };
    // Long enough for a middle that the caps do not reach.
    free.tube.length = 60.0 * MM;
    let mut asked = String::from("winding_angle_deg,shear_modulus_mpa,pressure_kpa\n");
    let mut solids = Vec::new();
    for [angle, modulus, share] in HIDDEN {
        let node = free.at(angle * DEG, modulus * MPA);
        let mut section = fe::SectionSolver::new(&node, fe::SectionMesh::default()).expect("a section");
        let limit = section.limit_pressure(EndLoad::NONE).expect("a path").expect("a limit");
        let pressure = share * limit;
        asked += &format!("{angle},{modulus},{}\n", pressure / KPA);
        let steps: Vec<f64> = (0..=3).map(|i| pressure * f64::from(i) / 3.0).collect();
        let path = SolidSweep::default().path(&node.into(), &steps, &mut || true).expect("a solid");
        solids.push(*path.states.last().expect("its last state"));
    }
    fs::write(folder.join("asked.csv"), asked).expect("a table");
    freeact_in(folder, "predict --model @free.model --pressures @asked.csv --out @told.csv").succeeded();
    let told = Table::read(&folder.join("told.csv"));

    assert_eq!(told.rows.len(), HIDDEN.len());
    for ((row, solid), [angle, modulus, _]) in told.rows.iter().zip(&solids).zip(HIDDEN) {
        let [stretch, expansion, twist] = ["axial_stretch", "expansion", "twist_per_length_deg_per_mm"]
            .map(|column| told.number(row, column));
        let middle = solid.middle.expect("the middle of a solid");
        let theirs = middle.twist_per_length / DEG * MM;
        println!(
            "{angle}° {modulus} MPa {:.2} kPa: stretch {stretch:.5} solid {:.5}, expansion {expansion:.5} solid {:.5}, twist {twist:.5} solid {theirs:.5} °/mm: \
             {:+.3} % of stretch, {:+.3} % of expansion, {:+.3} % of twist",
            solid.pressure / KPA,
            middle.axial_stretch,
            solid.expansion,
            100.0 * (stretch / middle.axial_stretch - 1.0),
            100.0 * (expansion / solid.expansion - 1.0),
            100.0 * (twist / theirs - 1.0),
        );
        assert!((stretch / middle.axial_stretch - 1.0).abs() < 5e-3);
        assert!((expansion / solid.expansion - 1.0).abs() < 5e-3);
        assert!((twist / theirs - 1.0).abs() < 15e-3);
    }
}
