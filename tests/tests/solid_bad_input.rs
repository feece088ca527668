//! What the solid says to input without an answer: words, no panic, and the last good state kept.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{SolidError, SolidLoad, SolidMesh, SolidSolver, Specimen, ThickTube};

fn free(angle: f64, fibres: u32) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.15e-3, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 0.02, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, fibres, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn mesh() -> SolidMesh {
    SolidMesh::new(12, 8)
}

/// The error's words.
#[track_caller]
fn refused(specimen: &Specimen, mesh: SolidMesh, words: &str) {
    let error = SolidSolver::new(specimen, mesh).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.contains(words), "{error:?} lacks {words:?}");
}

/// Volume that 5 kPa add, by which part.
fn inflated(specimen: &Specimen, mesh: SolidMesh) -> Result<f64, SolidError> {
    let mut solver = SolidSolver::new(specimen, mesh)?;
    let rest = solver.rest();
    let state = solver.follow(&rest, 0.0, &[5e3], &|p| SolidLoad::pressure(p), &mut |_, _| true)?;
    let deformation = solver.deformation(&state);
    assert!(state.residual() < 1e-8);
    Ok(deformation.stretch_mid * deformation.bore_mid.powi(2) - 1.0)
}

#[test]
fn specimens_that_are_none_are_refused() {
    let good = Specimen::from(&free(30.0, 6));
    let tube = |tube: Tube| Specimen { tube, ..good.clone() };
    let Tube { length, inner_radius, wall } = good.tube;
    refused(&tube(Tube { length: -1.0, inner_radius, wall }), mesh(), "length");
    refused(&tube(Tube { length, inner_radius: 0.0, wall }), mesh(), "inner radius");
    refused(&tube(Tube { length, inner_radius, wall: f64::NAN }), mesh(), "wall");
    refused(&Specimen { bulk_ratio: 1e12, ..good.clone() }, mesh(), "between");
    refused(&Specimen { density: -1.0, ..good.clone() }, mesh(), "mass");
    refused(&Specimen { bore_offset: [[0.79e-3, 0.0], [0.0; 2]], ..good.clone() }, mesh(), "inside the tube");
    refused(&Specimen { wall_taper: 0.0, ..good.clone() }, mesh(), "taper");
    let mut soft = good.clone();
    soft.elastomer = Elastomer::NeoHookean { shear_modulus: 0.0 };
    refused(&soft, mesh(), "shear modulus");
    let mut slack = good.clone();
    slack.windings[0].fibre.axial_stiffness = 0.0;
    refused(&slack, mesh(), "EA");
    let mut thin = good.clone();
    thin.windings[0].fibre.diameter = f64::NAN;
    refused(&thin, mesh(), "diameter");
    let mut none = good;
    none.windings[0].fibres = 0;
    refused(&none, mesh(), "leave the family out");
}

#[test]
fn meshes_that_are_none_are_refused() {
    let good = Specimen::from(&free(30.0, 6));
    for (bad, words) in [
        (SolidMesh { along: 0, ..mesh() }, "at least one"),
        (SolidMesh { radial: 0, ..mesh() }, "at least one"),
        (SolidMesh { around: 2, ..mesh() }, "at least 4"),
        (SolidMesh { around: 9, ..mesh() }, "even number for each fibre"),
    ] {
        refused(&good, bad, words);
    }
    let mut wide = good.clone();
    wide.windings[0].fibre.diameter = 0.01;
    refused(&wide, SolidMesh { under_fibre: 1, ..mesh() }, "under");
    // A mesh along a helix of 15 degrees turns by 13 rad in 20 mm: one element would take it for 13 - 4 pi.
    refused(&Specimen::from(&free(15.0, 6)), SolidMesh::new(12, 1), "along");
    refused(&Specimen::from(&free(15.0, 6)), SolidMesh::new(12, 4), "along");
}

#[test]
fn a_ring_has_no_end_and_a_thread_along_the_tube_works() {
    refused(&Specimen::from(&free(0.0, 6)), mesh(), "rings");
    assert!(inflated(&Specimen::from(&free(90.0, 6)), mesh()).unwrap() > 0.0);
}

#[test]
fn a_bare_tube_is_one_without_fibres() {
    let bare = Specimen::from(&free(30.0, 0));
    assert!(bare.windings.is_empty());
    let [bare, wound] =
        [bare, Specimen::from(&free(30.0, 6))].map(|specimen| inflated(&specimen, mesh()).unwrap());
    assert!(bare > wound && wound > 0.0, "{bare} {wound}");
}

#[test]
fn a_wall_thicker_than_the_radius_works() {
    let mut thick = Specimen::from(&free(40.0, 6));
    thick.tube.wall = 6e-3;
    let change = inflated(&thick, SolidMesh { radial: 2, ..SolidMesh::new(12, 8) }).unwrap();
    assert!(change > 0.0 && change < 0.02, "{change}");
    thick.tube.wall = 1.0;
    refused(&thick, mesh(), "is the unit right");
}

#[test]
fn beyond_the_limit_pressure_the_last_good_state_is_kept() {
    // A bare tube of this rubber has its limit at the closed form's pressure, one between caps a little later.
    let mut bare = Specimen::from(&free(60.0, 0));
    bare.tube.length = 0.04;
    let mut solver = SolidSolver::new(&bare, SolidMesh::new(8, 12)).unwrap();
    let rest = solver.rest();
    let mut kept = vec![];
    let pressures = [10e3, 20e3, 90e3];
    let end = solver.follow(&rest, 0.0, &pressures, &|p| SolidLoad::pressure(p), &mut |p, state| {
        kept.push((p, state.clone()));
        true
    });
    let Err(error) = end else { panic!("there is no state at 90 kPa") };
    let SolidError::NotConverged { last_good, .. } = &error else { panic!("{error}") };
    let limit = 1e-3 * ThickTube::bare(&free(60.0, 0)).limit_state().unwrap().pressure;
    assert!((0.95 * limit..1.1 * limit).contains(last_good), "{error} ({limit})");
    let words = error.to_string();
    assert!(words.contains("no equilibrium") && words.contains("enclosed volume"), "{words}");
    assert_eq!(kept.iter().map(|(p, _)| *p).collect::<Vec<_>>(), [10e3, 20e3]);
    // The solver is as good as before.
    let (p, state) = &kept[1];
    let again = solver.follow(state, *p, &[15e3], &|p| SolidLoad::pressure(p), &mut |_, _| true).unwrap();
    assert!(again.residual() < 1e-8 && solver.deformation(&again).bore_mid > 1.02);
}

#[test]
fn loads_that_are_no_numbers_are_refused() {
    let mut solver = SolidSolver::new(&Specimen::from(&free(60.0, 6)), mesh()).unwrap();
    let rest = solver.rest();
    for pressure in [f64::NAN, f64::INFINITY] {
        let end = solver.follow(&rest, 0.0, &[pressure], &|p| SolidLoad::pressure(p), &mut |_, _| true);
        assert!(end.is_err());
    }
    assert!(solver.inflate(&rest, &[f64::NAN], &mut |_, _| true).is_err());
}
