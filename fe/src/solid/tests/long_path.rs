use super::{specimen, winding};
use crate::solid::{SolidMesh, SolidSolver};
use actuator::Handedness;
use std::f64::consts::PI;

/// Sixty volumes, past the pressure's limit: extrapolations of a path must not feed on their own rounding errors. While the record of a
/// path's motions was a sum of steps they grew twentyfold a step, and the path was lost from the twentieth on.
#[test]
fn a_path_of_many_stops_takes_a_step_or_two_for_each() {
    let specimen = specimen(0.05, &[winding(60.0, Handedness::Right, 6, 0.15e-3)], 1e4);
    let mut solver = SolidSolver::sector(&specimen, SolidMesh::new(12, 36)).unwrap();
    let rest = solver.rest();
    let at_rest = PI * specimen.tube.inner_radius.powi(2) * specimen.tube.length;
    let volumes: Vec<f64> = (1..=60).map(|i| at_rest * (1.0 + 0.06 * f64::from(i))).collect();
    let mut pressures = vec![];
    solver
        .inflate(&rest, &volumes, &mut |_, state| {
            pressures.push(state.load().pressure);
            true
        })
        .unwrap();
    assert_eq!(pressures.len(), 60);
    let greatest = pressures.iter().copied().fold(0.0, f64::max);
    assert!(greatest > 1.01 * pressures[59], "{greatest} {}", pressures[59]);
    let iterations = solver.cost().iterations;
    assert!(iterations < 120, "{iterations} steps of Newton's method for 60 states");
}
