//! The frame in which poses are read is not the base plate's: `pose_read = T_b pose`, `T_b = (exp([rx, ry, rz]x), [x, y, z])`. No state.

use super::Parameter;
use actuator::TipPose;
use nalgebra::{UnitQuaternion, Vector3};

const fn rotation(name: &'static str) -> Parameter {
    Parameter {
        name,
        unit: std::f64::consts::PI / 180.0,
        neutral: 0.0,
        start: 0.0,
        lower: -0.6,
        upper: 0.6,
        scale: 0.01,
    }
}

const fn offset(name: &'static str) -> Parameter {
    Parameter { name, unit: 1e-3, neutral: 0.0, start: 0.0, lower: -0.05, upper: 0.05, scale: 5e-4 }
}

/// Rotation vector, deg, then offset, mm.
pub(super) const PARAMETERS: &[Parameter] = &[
    rotation("rotation_x_deg"),
    rotation("rotation_y_deg"),
    rotation("rotation_z_deg"),
    offset("offset_x_mm"),
    offset("offset_y_mm"),
    offset("offset_z_mm"),
];

/// The transformation of the six values.
pub(super) fn transformation(values: &[f64]) -> TipPose {
    TipPose {
        position: Vector3::new(values[3], values[4], values[5]),
        rotation: UnitQuaternion::from_scaled_axis(Vector3::new(values[0], values[1], values[2])),
    }
}

/// T_b pose.
pub(super) fn pose(values: &[f64], pose: &TipPose) -> TipPose {
    transformation(values).compose(pose)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_x_lays_the_module_down() {
        let at_rest =
            TipPose { position: Vector3::new(0.0, 0.0, 0.175), rotation: UnitQuaternion::identity() };
        let read = pose(&[std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.01, 0.0, 0.0], &at_rest);
        assert!((read.position - Vector3::new(0.01, -0.175, 0.0)).norm() < 1e-15);
        assert!((read.rotation.scaled_axis().x - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}
