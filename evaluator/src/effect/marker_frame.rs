//! The marker is not at the plate's centre or not square to it: `pose_read = pose T_m`, `T_m` as in the effect `base_frame`. No state.

use super::{Parameter, base_frame};
use crate::{Pose, Real};

/// Rotation vector, deg, then offset, mm, both in the plate's frame.
pub(super) const PARAMETERS: &[Parameter] = base_frame::PARAMETERS;

/// pose T_m.
pub(super) fn pose<T: Real, D: Real + From<T>>(values: &[T], pose: &Pose<D>) -> Pose<D> {
    pose.compose(&base_frame::transformation(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_turns_with_the_plate() {
        let eighth = core::f64::consts::FRAC_PI_4;
        let turned = Pose { position: [0.0, 0.0, 0.175], rotation: [eighth.cos(), 0.0, 0.0, eighth.sin()] };
        let read = pose(&[0.0, 0.0, 0.0, 0.01, 0.0, 0.0], &turned);
        for (value, expected) in read.position.into_iter().zip([0.0, 0.01, 0.175]) {
            assert!((value - expected).abs() < 1e-15);
        }
    }
}
