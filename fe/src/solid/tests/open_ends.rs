use super::{specimen, winding};
use crate::solid::{SolidLoad, SolidMesh, SolidSolver};
use actuator::Handedness;

/// Lame: without axial force an incompressible tube (E = 3 mu) under a small pressure p in the bore shortens by p A^2/(E (B^2 - A^2)) and
/// widens outside by twice that.
#[test]
fn a_tube_pressed_in_the_bore_only_shortens_as_lame_says() {
    let specimen = specimen(0.06, &[], 1e6);
    let mut solver = SolidSolver::new(&specimen, SolidMesh { radial: 2, ..SolidMesh::new(16, 24) }).unwrap();
    let pressure = 20.0;
    let rest = solver.rest();
    let load_at = |p: f64| SolidLoad { open_ends: true, ..SolidLoad::pressure(p) };
    let state = solver.follow(&rest, 0.0, &[pressure], &load_at, &mut |_, _| true).unwrap();
    let found = solver.deformation(&state);
    let (a, b) = (specimen.tube.inner_radius, specimen.tube.outer_radius());
    let strain = pressure * a * a / (3.0 * 0.393e6 * (b * b - a * a));
    // The strains' own squares are 1e-4 of them.
    assert!(
        (1.0 - found.stretch_mid - strain).abs() < 5e-4 * strain,
        "{:e} {strain:e}",
        found.stretch_mid - 1.0
    );
    let widened = found.expansion_mid - 1.0;
    assert!((widened - 2.0 * strain).abs() < 1e-3 * strain, "{widened:e} {strain:e}");
    let refused = solver.inflate(&state, &[1e-6], &mut |_, _| true).unwrap_err().to_string();
    assert!(refused.contains("closed"), "{refused}");
}

/// With the caps held nothing is free at the edges: the load is conservative, and the bore pressed alone is the tube with closed ends.
#[test]
fn between_held_caps_open_and_closed_ends_are_the_same() {
    let specimen = specimen(0.02, &[winding(40.0, Handedness::Right, 6, 0.15e-3)], 1e4);
    let shape = |open_ends: bool| {
        let mut solver = SolidSolver::new(&specimen, SolidMesh::new(12, 12)).unwrap();
        let rest = solver.rest();
        let load_at = |p: f64| SolidLoad { open_ends, held: [true; 6], ..SolidLoad::pressure(p) };
        let state = solver.follow(&rest, 0.0, &[10e3, 20e3], &load_at, &mut |_, _| true).unwrap();
        solver.deformation(&state)
    };
    let (open, closed) = (shape(true), shape(false));
    assert!(
        (open.bore_mid - closed.bore_mid).abs() < 1e-9 && (open.twist_mid - closed.twist_mid).abs() < 1e-6
    );
    assert!(closed.bore_mid > 1.01);
}
