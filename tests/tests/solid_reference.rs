//! The solid against the closed form and against solid models of other programs (CalculiX 2.20, FEBio 4.11, felupe 11.3): 20-node
//! hexahedra and truss fibres, K/mu = 1000, one element through the wall, twelve around.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{Deformation, SectionMesh, SectionSolver, SolidLoad, SolidMesh, SolidSolver, Specimen, ThickTube};

/// The FREE of all programs: angle from the hoop (deg), length (mm), EA (N), 0.15 mm wide threads.
fn free(angle: f64, length: f64, stiffness: f64, alpha: f64) -> Free {
    let fibre = Fibre { axial_stiffness: stiffness, diameter: 0.15e-3, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 1e-3 * length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha, form: OgdenForm::InitialModulus },
    }
}

/// States at pressures in kPa.
fn states(specimen: &Specimen, mesh: SolidMesh, pressures: &[f64]) -> Vec<Deformation> {
    let mut solver = if specimen.windings.is_empty() {
        SolidSolver::new(specimen, mesh).unwrap()
    } else {
        // One of six equal sectors.
        SolidSolver::sector(specimen, mesh).unwrap()
    };
    let rest = solver.rest();
    let stops: Vec<f64> = pressures.iter().map(|p| 1e3 * p).collect();
    let mut found = vec![];
    solver
        .follow(&rest, 0.0, &stops, &|p| SolidLoad::pressure(p), &mut |_, state| {
            found.push(state.clone());
            true
        })
        .unwrap();
    found.iter().map(|state| solver.deformation(state)).collect()
}

#[test]
fn the_bare_tube_is_the_closed_form_far_from_its_caps() {
    for alpha in [0.8, 1.2, 2.0] {
        let free = free(30.0, 50.0, 644.0, alpha);
        let specimen = Specimen { windings: vec![], bulk_ratio: 1e5, ..Specimen::from(&free) };
        let pressures = [4.0, 12.0, 20.0, 22.0, 24.0];
        let closed = ThickTube::bare(&free);
        // What a cap does to a bare wall decays by e in sqrt(R t) = 2 mm: the middle 20 % begin ten of them away.
        for (found, p) in states(&specimen, SolidMesh::new(12, 16), &pressures).iter().zip(pressures) {
            let exact = closed.free_state(1e3 * p).unwrap();
            let [expansion, stretch] =
                [found.expansion_mid - exact.expansion, found.stretch_mid - exact.axial_stretch];
            println!("alpha {alpha}, {p} kPa: b/B off by {expansion:.1e}, stretch by {stretch:.1e}");
            assert!(expansion.abs() < 1e-4 && stretch.abs() < 1e-4, "alpha {alpha}, {p} kPa: {found:?}");
        }
    }
}

/// kPa, stretch and twist (deg/mm) cap to cap, stretch, a/A and twist of the middle; NaN where nothing is compared.
type Row = [f64; 6];

const NONE: f64 = f64::NAN;

/// Within what programs agree in on like meshes: 0.5 % of stretch - 1, 1 % of a/A - 1, each plus 5e-4, 1.5 % of twist.
fn compare(angle: f64, stiffness: f64, mesh: SolidMesh, rows: &[Row]) {
    let specimen = Specimen { bulk_ratio: 1e3, ..Specimen::from(&free(angle, 40.0, stiffness, 1.2)) };
    let pressures: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    for (found, row) in states(&specimen, mesh, &pressures).iter().zip(rows) {
        let twist = [found.twist_total, found.twist_mid].map(|twist| 1e-3 * twist.to_degrees());
        let values = [found.stretch_total, twist[0], found.stretch_mid, found.bore_mid, twist[1]];
        println!("{angle} deg, EA {stiffness}, {} kPa: {values:.5?} for {:?}", row[0], &row[1..]);
        for (index, (value, expected)) in values.iter().zip(&row[1..]).enumerate() {
            let allowed = match index {
                0 | 2 => 0.005 * (expected - 1.0).abs() + 5e-4,
                3 => 0.01 * (expected - 1.0).abs() + 5e-4,
                _ => 0.015 * expected.abs(),
            };
            assert!(
                expected.is_nan() || (value - expected).abs() < allowed,
                "{angle} deg, EA {stiffness}, {} kPa, number {index}: {value} for {expected}",
                row[0]
            );
        }
    }
}

/// What caps do is not resolved by 12x28x1 of the other programs' elements: see the next test. Their fibres are lines, ours 0.15 mm
/// wide, which makes a/A - 1 smaller by up to 1.5 % with rising pressure: at 68.9 kPa, and with EA x 2 at 60 kPa, by more than is asked.
#[test]
fn twenty_degrees_agree_with_other_programs_in_the_middle() {
    let mesh = SolidMesh::new(12, 28);
    let rows = [
        [10.0, NONE, NONE, 1.01152, 1.02153, -0.3855],
        [20.0, NONE, NONE, 1.02499, 1.04481, -0.8005],
        [30.0, NONE, NONE, 1.04092, 1.07029, -1.2526],
        [40.0, NONE, NONE, 1.05997, 1.09863, -1.7529],
        [50.0, NONE, NONE, 1.08324, 1.13087, -2.3185],
        [60.0, NONE, NONE, 1.11251, 1.16872, -2.9775],
        [68.9, NONE, NONE, 1.14626, NONE, -3.6848],
    ];
    compare(20.0, 644.0, mesh, &rows);
    let rows = [
        [30.0, NONE, NONE, 1.04095, 1.07014, -1.2543],
        [60.0, NONE, NONE, 1.11249, NONE, -2.9807],
        [68.9, NONE, NONE, 1.14616, NONE, -3.6880],
    ];
    compare(20.0, 1288.0, mesh, &rows);
    let rows = [
        [30.0, NONE, NONE, 1.04085, 1.07059, -1.2492],
        [60.0, NONE, NONE, 1.11255, 1.16960, -2.9711],
        [68.9, NONE, NONE, 1.14647, NONE, -3.6784],
    ];
    compare(20.0, 322.0, mesh, &rows);
}

/// felupe on 24x56x1. Here the fibres' width is resolved: the bore of the middle is that of the section.
#[test]
fn twenty_degrees_agree_with_other_programs_cap_to_cap() {
    let mesh = SolidMesh { radial: 2, under_fibre: 1, ..SolidMesh::new(12, 28) };
    let rows = [
        [10.0, 1.01194, -0.3644, 1.01149, NONE, -0.3871],
        [20.0, 1.02578, -0.7543, 1.02495, NONE, -0.8040],
        [30.0, 1.04195, -1.1764, 1.04086, NONE, -1.2582],
        [40.0, 1.06110, -1.6404, 1.05991, NONE, -1.7607],
        [50.0, 1.08417, -2.1611, 1.08317, NONE, -2.3285],
        [60.0, 1.11272, -2.7622, 1.11243, NONE, -2.9898],
        [68.9, 1.14499, -3.3998, 1.14617, NONE, -3.6991],
    ];
    compare(20.0, 644.0, mesh, &rows);
}

/// What the caps do to stretches is of first order in the other programs' elements along the tube: felupe, total stretch on 12x18x1 and
/// 12x54x1 (`benches/peers/felupe_free.py` with 54 in place of 18), and from both on infinitely many.
#[test]
fn sixty_degrees_agree_with_other_programs() {
    let totals = [
        [0.99690, 0.99650, -0.14476],
        [0.99394, 0.99310, -0.33136],
        [0.99146, 0.99014, -0.57813],
        [0.99015, 0.98830, -0.92331],
        [0.99186, 0.98940, -1.48600],
    ];
    let middles = [
        [10.0, 0.99512, 1.05354, -0.1393],
        [20.0, 0.99046, 1.11973, -0.3247],
        [30.0, 0.98660, 1.20626, -0.5808],
        [40.0, 0.98531, 1.33112, -0.9617],
        [50.0, 0.99471, 1.55701, -1.6422],
    ];
    let row = |([coarse, fine, twist], [p, stretch, bore, middle]): (&[f64; 3], &[f64; 4])| {
        // 50 kPa is within 5 % of the limit pressure of the middle.
        let [bore, stretch] = if *p < 45.0 { [*bore, *stretch] } else { [NONE; 2] };
        [*p, 1.5 * fine - 0.5 * coarse, *twist, stretch, bore, *middle]
    };
    let rows: Vec<Row> = totals.iter().zip(&middles).map(row).collect();
    compare(60.0, 644.0, SolidMesh { radial: 2, under_fibre: 1, ..SolidMesh::new(12, 18) }, &rows);
}

/// Far from the caps the solid is the section: the same elements across, the same fibres of the same width.
#[test]
fn the_middle_is_the_section() {
    for (angle, along, pressure) in [(20.0, 28, 30.0), (60.0, 18, 30.0)] {
        let free = free(angle, 40.0, 644.0, 1.2);
        let mesh = SolidMesh { under_fibre: 1, ..SolidMesh::new(12, along) };
        let found = states(&Specimen { bulk_ratio: 1e5, ..Specimen::from(&free) }, mesh, &[pressure])[0];
        let like = SectionMesh { radial: 1, under_fibre: 1, between_fibres: 1 };
        let path = SectionSolver::new(&free, like).unwrap().path(&[1e3 * pressure], 0).unwrap();
        let at = |state: &&actuator::FreeState| (state.pressure - 1e3 * pressure).abs() < 1.0;
        let section = path.states.iter().find(at).unwrap();
        let found = [found.stretch_mid, found.expansion_mid, found.twist_mid];
        let expected = [section.axial_stretch, section.expansion, section.twist_per_length];
        println!("{angle} deg: solid {found:.6?}, section {expected:.6?}");
        assert!((found[0] - expected[0]).abs() < 0.002 * (expected[0] - 1.0).abs() + 2e-5, "{angle}");
        assert!((found[1] - expected[1]).abs() < 0.002 * (expected[1] - 1.0), "{angle}");
        assert!((found[2] / expected[2] - 1.0).abs() < 0.002, "{angle}");
    }
}
