//! Modules that are symmetric, turned, or computed on more threads.

use super::*;
use nalgebra::{UnitQuaternion, Vector3};

const ARM: f64 = 7.5e-3;

/// Four FREEs of `fibres` fibres on the corners of a square, hands in turn.
fn left_right(fibres: u32, gravity: [f64; 3]) -> Module {
    let corners = [(ARM, ARM), (-ARM, ARM), (-ARM, -ARM), (ARM, -ARM)];
    let hands = [Handedness::Right, Handedness::Left, Handedness::Right, Handedness::Left];
    let frees: Vec<_> =
        corners.into_iter().zip(hands).map(|((x, y), hand)| (free(30.0, hand, fibres), [x, y])).collect();
    module(&frees, gravity)
}

#[test]
fn equal_pressures_in_hands_in_turn_only_lengthen() {
    let mut four = solids(&left_right(6, [0.0, 0.0, 1.0]), [1, 12, 8]);
    let found = four.solve(&[2e4; 4]).unwrap();
    let [twist, bend_x, bend_y, x, y, z] = found.state.chart.to_array();
    assert!(twist.abs().max(bend_x.abs()).max(bend_y.abs()) < 1e-8, "{found:?}");
    assert!(x.abs().max(y.abs()) < 1e-8 * 30e-3, "{found:?}");
    assert!(z > 30.1e-3 && found.state.negative_pivots == 0, "{found:?}");
    // Each alone would turn by a tenth of a turn.
    let mut alone = solids(&module(&[(free(30.0, Handedness::Right, 6), [0.0; 2])], [0.0; 3]), [1, 12, 8]);
    assert!(alone.solve(&[2e4]).unwrap().state.chart.twist < -0.2);
}

#[test]
fn a_module_turned_by_a_right_angle_gives_the_turned_answer() {
    // Four fibres: the mesh of a FREE, too, is the same after a quarter turn.
    let upright = left_right(4, [0.0, 0.6, 0.8]);
    let pressures = [2e4, 0.4e4, 1e4, 0.0];
    let mut turned = upright.clone();
    for placed in &mut turned.frees {
        placed.position = [-placed.position[1], placed.position[0]];
    }
    turned.base.gravity = [-0.6, 0.0, 0.8];
    let [upright, turned] =
        [upright, turned].map(|module| solids(&module, [1, 16, 8]).solve(&pressures).unwrap().state);
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
    let (from, to) = (upright.chart.to_pose(), turned.chart.to_pose());
    assert!((quarter * from.position - to.position).norm() < 1e-9 * 30e-3 * 10.0, "{upright:?} {turned:?}");
    assert!((quarter * from.rotation * quarter.inverse()).angle_to(&to.rotation) < 1e-7);
    assert!((upright.chart.twist - turned.chart.twist).abs() < 1e-8);
    assert!(upright.chart.bend[0].hypot(upright.chart.bend[1]) > 0.003, "{upright:?}");
}

#[test]
fn threads_and_what_was_computed_before_change_no_bit() {
    let module = left_right(6, [0.0, 0.6, 0.8]);
    let pressures = [2e4, 1e4, 0.0, 1e4];
    let solve = |threads| {
        let settings = SolidModuleSettings { threads, ..settings([1, 12, 8]) };
        let mut four = SolidModule::new(&module, settings).unwrap();
        let first = four.solve(&pressures).unwrap();
        // Other states in between leave no trace.
        four.loaded(&first.shape, 0.05).unwrap();
        four.solve_from(&first.shape, &[1e4; 4]).unwrap();
        let again = four.solve(&pressures).unwrap();
        let next = four.solve_from(&again.shape, &[2e4; 4]).unwrap();
        (first.state, first.pressure_jacobian, again.state, next.state)
    };
    let (first, jacobian, again, next) = solve(1);
    assert_eq!(first, again);
    assert_eq!((first, jacobian, again, next), solve(2));
}
