//! The marker is not at the plate's centre or not square to it: `pose_read = pose T_m`, `T_m` as in the effect `base_frame`. No state.

use super::{Parameter, base_frame};
use actuator::TipPose;

/// Rotation vector, deg, then offset, mm, both in the plate's frame.
pub(super) const PARAMETERS: &[Parameter] = base_frame::PARAMETERS;

/// pose T_m.
pub(super) fn pose(values: &[f64], pose: &TipPose) -> TipPose {
    pose.compose(&base_frame::transformation(values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn the_offset_turns_with_the_plate() {
        let turned = TipPose {
            position: Vector3::new(0.0, 0.0, 0.175),
            rotation: UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_2),
        };
        let read = pose(&[0.0, 0.0, 0.0, 0.01, 0.0, 0.0], &turned);
        assert!((read.position - Vector3::new(0.0, 0.01, 0.175)).norm() < 1e-15);
    }
}
