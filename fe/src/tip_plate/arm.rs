use crate::rigid_motion::Frame;
use nalgebra::{Matrix3, Matrix6, Vector3};

/// Motion at an arm for a motion of a frame, both in the frame's directions: v - arm x w, w.
pub(crate) fn at_arm(arm: &Vector3<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::identity();
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&-arm.cross_matrix());
    matrix
}

/// The frame at an arm of another one.
pub(crate) fn shifted(frame: &Frame, arm: &Vector3<f64>) -> Frame {
    Frame { rotation: frame.rotation, position: frame.position + frame.rotation * arm }
}

/// Second derivative of an energy that rises by `pull` with a frame's position, pull being in the frame's own directions: moved by exp(xi) the
/// frame also swings, which makes v.(pull x w)/2 twice.
pub(crate) fn swing(pull: &Vector3<f64>) -> Matrix6<f64> {
    let half: Matrix3<f64> = pull.cross_matrix() * 0.5;
    let mut block = Matrix6::zeros();
    block.fixed_view_mut::<3, 3>(0, 3).copy_from(&half);
    block.fixed_view_mut::<3, 3>(3, 0).copy_from(&half.transpose());
    block
}
