//! A module of one FREE is that FREE between its caps.

use super::*;
use crate::{SolidLoad, SolidMesh, SolidSolver, Specimen};
use actuator::units::STANDARD_GRAVITY;
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

#[test]
fn alone_it_is_the_solid_under_the_weight_of_its_plate() {
    let own = free(30.0, Handedness::Right, 6);
    let alone = module(&[(own, [0.0, 0.0])], [0.6, 0.0, 0.8]);
    let pressure = 2e4;
    let mut solid_module = solids(&alone, [1, 12, 14]);
    let found = solid_module.solve(&[pressure]).unwrap();

    let density = alone.base.free_mass / (own.tube.wall_area() * own.tube.length);
    let specimen = Specimen { density, cap_mass: alone.tip.plate_mass, ..Specimen::from(&own) };
    let mut solver = SolidSolver::new(&specimen, SolidMesh::new(12, 14)).unwrap();
    let gravity = Vector3::from(alone.base.gravity) * STANDARD_GRAVITY;
    let to = |part: f64| SolidLoad { gravity: part * gravity, ..SolidLoad::pressure(part * pressure) };
    let state = solver.follow(&solver.rest(), 0.0, &[1.0], &to, &mut |_, _| true).unwrap();

    let (pose, (place, turn)) = (found.state.chart.to_pose(), state.cap());
    // Both are in equilibrium to 1e-9 of the forces; the FREE bends by 0.1.
    let off = (pose.position - place).norm() / own.tube.length;
    let turned = pose.rotation.angle_to(&turn);
    assert!(off < 1e-8 && turned < 1e-7, "{off:.1e} {turned:.1e}");
    assert!(found.state.residual < 1e-9 && found.state.chart.bend[1].abs() > 0.02, "{found:?}");
    assert_eq!(found.state.negative_pivots as usize, solver.stability(&state, 1).unwrap().negative);
}

#[test]
fn frees_too_long_and_too_short_meet_at_their_mean() {
    // Without pressure the long one thrusts and the short one pulls, each with a stiffness that is proportional to mu/L.
    let mut pair = unlike_pair();
    pair.base = Base { gravity: [0.0; 3], free_mass: 0.0 };
    let unlike = [(30.03e-3, 0.6e6), (29.97e-3, 0.2e6)];
    for (placed, (length, shear_modulus)) in pair.frees.iter_mut().zip(unlike) {
        placed.free = free(90.0, Handedness::Right, 0).at(FRAC_PI_2, shear_modulus);
        placed.free.tube.length = length;
        placed.position = [0.0, 0.0];
    }
    let found = solids(&pair, [1, 12, 8]).rest().unwrap();
    let height = found.state.chart.position[2];
    // k1 (h - L1) + k2 (h - L2) = 0: half way from their mean to the stiffer one. Strains of a thousandth change stiffnesses by as much.
    let expected = 30.015e-3;
    assert!((height - expected).abs() < 0.01 * (expected - 30e-3), "{height} {expected}");
    assert!(found.energy > 0.0);
}
