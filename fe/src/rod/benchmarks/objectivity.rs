//! What does not depend on where a module stands and how far it has turned.

use crate::{
    BendingLaw, ConstantBending, ThickTube,
    rigid_motion::{Frame, joined},
    rod::{element::ElementLaw, specimens::*, *},
};
use actuator::Handedness;
use nalgebra::{Rotation2, UnitQuaternion, Vector2, Vector3};
use std::{f64::consts::PI, sync::Arc};

#[test]
fn an_element_answers_alike_wherever_it_is() {
    let tube = ThickTube::new(&free(30.0, Handedness::Right));
    let bending: &dyn BendingLaw = &ConstantBending { bending: 4e-4, coupling: 3e-3, shear: 8.0 };
    for held_at in [None, Some([7e-3, -4e-3])] {
        let law = ElementLaw {
            section: &tube,
            hand: -1.0,
            bending,
            bending_scale: 1.0,
            held_at,
            length: 0.02,
            ends: 0.0,
        };
        let home = Frame { rotation: UnitQuaternion::identity(), position: Vector3::zeros() };
        let step = joined(Vector3::new(1e-3, -2e-3, 0.0216), Vector3::new(0.3, -0.2, 0.5));
        let here = law.evaluate(&home, &home.moved(&step), 3e4, true).unwrap();
        for turn in [Vector3::new(0.3, -0.5, 1.4), Vector3::new(-2.0, 2.0, 0.3), Vector3::z() * 7.0] {
            let base = Frame {
                rotation: UnitQuaternion::from_scaled_axis(turn),
                position: Vector3::new(0.4, -0.2, 0.1),
            };
            // The tip is carried along as a body, not made anew.
            let tip = home.moved(&step);
            let tip = Frame {
                rotation: base.rotation * tip.rotation,
                position: base.position + base.rotation * tip.position,
            };
            let there = law.evaluate(&base, &tip, 3e4, true).unwrap();
            assert!((there.energy - here.energy).abs() < 1e-11 * here.energy.abs());
            let size = here.gradient[0].amax();
            for node in 0..2 {
                assert!((there.gradient[node] - here.gradient[node]).amax() < 1e-10 * size);
            }
            for (a, b) in there.tangent.iter().zip(&here.tangent) {
                assert!((a - b).amax() < 1e-10 * b.amax());
            }
        }
    }
}

/// FREEs, gravity and tip load turned about z by any angle: the answer turns with them, its twist stays.
#[test]
fn a_turned_module_gives_the_turned_answer() {
    let pressures = [3e4, 1e4, 0.0, 2e4];
    let solve = |angle: f64| {
        let turn = |[x, y]: [f64; 2]| -> [f64; 2] { (Rotation2::new(angle) * Vector2::new(x, y)).into() };
        let [gx, gy] = turn([0.6, 0.0]);
        let mut module = left_right([gx, gy, 0.8]);
        for placed in &mut module.frees {
            placed.position = turn(placed.position);
        }
        let ([fx, fy], [mx, my]) = (turn([0.02, -0.01]), turn([1e-4, 2e-4]));
        let tip_load = crate::TipLoad { force: [fx, fy, 0.03], moment: [mx, my, 1e-4] };
        let settings = RodSettings { tip_load, ..RodSettings::default() };
        let [twist, bx, by, x, y, z] =
            analytic(&module, settings).solve(&pressures).unwrap().state.chart.to_array();
        let back = Rotation2::new(-angle);
        let (bend, place) = (back * Vector2::new(bx, by), back * Vector2::new(x, y));
        [twist, bend.x, bend.y, place.x, place.y, z]
    };
    let still = solve(0.0);
    for angle in [0.6, 2.5, 7.0] {
        for (a, b) in still.iter().zip(solve(angle)) {
            assert!((a - b).abs() < 1e-10, "{angle}: {still:?}");
        }
    }
}

#[test]
fn turns_are_counted() {
    let mut module = module(vec![at(free(30.0, Handedness::Left), 3e-3, -5e-3)]);
    // Held upright, so that it does not buckle.
    module.tip.free_dof = [true, true, true, false, false, true];
    let torsion = 1e-5;
    let law = Linear { axial: 100.0, torsion, area: 0.0, arm: 0.0 };
    let turns = 3.25;
    let torque = torsion * 2.0 * PI * turns / module.length();
    let tip_load = crate::TipLoad { force: [0.0; 3], moment: [0.0, 0.0, torque] };
    let bending = ConstantBending { bending: 4e-4, coupling: 0.0, shear: 10.0 };
    let law = RodLaw { section: Arc::new(law), bending: Arc::new(bending) };
    let rods =
        RodModule::new(&module, vec![law], RodSettings { tip_load, ..RodSettings::default() }).unwrap();
    let found = rods.rest().unwrap();
    assert!((found.state.chart.twist - 2.0 * PI * turns).abs() < 1e-8, "{found:?}");
    // A quarter more than whole turns about the FREE's axis at (3, -5) mm: the plate's centre comes to (3 - 5, -5 - 3).
    let position = found.state.chart.to_pose().position;
    assert!((position - Vector3::new(-2e-3, -8e-3, module.length())).norm() < 1e-9, "{position}");
}
