//! The frame in which poses are read is not the base plate's: `pose_read = T_b pose`, `T_b = (exp([rx, ry, rz]x), [x, y, z])`. No state.

use super::Parameter;
use crate::{Pose, Real, chart::half_angle};

const fn rotation(name: &'static str) -> Parameter {
    Parameter {
        name,
        unit: core::f64::consts::PI / 180.0,
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
pub(super) fn transformation<T: Real, D: Real + From<T>>(values: &[T]) -> Pose<D> {
    let [rx, ry, rz, x, y, z] = core::array::from_fn(|index| D::from(values[index]));
    let (w, per_angle) = half_angle(rx * rx + ry * ry + rz * rz);
    Pose { position: [x, y, z], rotation: [w, per_angle * rx, per_angle * ry, per_angle * rz] }
}

/// T_b pose.
pub(super) fn pose<T: Real, D: Real + From<T>>(values: &[T], pose: &Pose<D>) -> Pose<D> {
    transformation(values).compose(pose)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_x_lays_the_module_down() {
        let at_rest = Pose { position: [0.0, 0.0, 0.175f64], rotation: [1.0, 0.0, 0.0, 0.0] };
        let quarter = core::f64::consts::FRAC_PI_2;
        let read = pose(&[quarter, 0.0, 0.0, 0.01, 0.0, 0.0], &at_rest);
        for (value, expected) in read.position.into_iter().zip([0.01, -0.175, 0.0]) {
            assert!((value - expected).abs() < 1e-15);
        }
        assert!((read.rotation[1] - (0.5 * quarter).sin()).abs() < 1e-15);
    }
}
