//! The whole turned in space, its cap beyond 180 degrees.

use super::derivatives::Case;
use crate::solid::assembly::Forces;
use nalgebra::{UnitQuaternion, Vector3};

#[test]
fn turning_everything_turns_the_forces_and_keeps_the_energy() {
    let mut case = Case::whole();
    case.load.gravity = Vector3::zeros();
    let (state, load) = (case.state.clone(), case.load);
    let mut forces = Forces::default();
    case.body.assemble(&state, &load, true, &mut forces).unwrap();
    let still = (forces.clone(), case.in_space(&state, &forces.residual));
    let scale = still.1.iter().fold(0.0f64, |most, force| most.max(force.amax()));
    for degrees in [100.0f64, 179.9, 200.0, 359.0, 500.0] {
        let axis = Vector3::new(0.48, -0.6, 0.64);
        let turn = UnitQuaternion::from_scaled_axis(axis * degrees.to_radians());
        let mut turned = state.clone();
        for x in &mut turned.positions {
            *x = (turn * Vector3::from(*x)).into();
        }
        turned.cap = turn * state.cap;
        turned.cap_rotation = turn * state.cap_rotation;
        let load = crate::SolidLoad { force: turn * load.force, ..load };
        case.body.assemble(&turned, &load, true, &mut forces).unwrap();
        assert!((forces.energy - still.0.energy).abs() < 1e-12 * still.0.energy.abs(), "{degrees}");
        // The base's own share of the cone from the origin is none: the origin stays in its plane.
        assert!((forces.volume - still.0.volume).abs() < 1e-13 * still.0.volume, "{degrees}");
        for (force, before) in case.in_space(&turned, &forces.residual).iter().zip(&still.1) {
            assert!((force - turn * before).amax() < 1e-11 * scale, "{degrees}");
        }
    }
}
