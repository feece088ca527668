//! Pose error and its derivatives in real pose space: a chart's twist counts turns, a target's does not.

use crate::target::Goal;
use actuator::PoseChart;
use nalgebra::{Matrix3, Matrix6, Rotation3, Vector3, Vector6};

/// Right Jacobian of the exponential: with `R = exp([b]x)`, `R^T dR = [J_r(b) db]x`.
///
/// `J_r = I - (1 - cos t)/t^2 [b]x + (t - sin t)/t^3 [b]x^2`, `t = |b|` (rad).
pub fn right_jacobian(rotation_vector: &Vector3<f64>) -> Matrix3<f64> {
    let angle = rotation_vector.norm();
    let cross = rotation_vector.cross_matrix();
    // Below 1e-3 rad the closed forms cancel; the next terms of the series are of order t^4 and below rounding.
    let (first, second) = if angle < 1e-3 {
        (0.5 - angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0)
    } else {
        ((1.0 - angle.cos()) / angle.powi(2), (angle - angle.sin()) / angle.powi(3))
    };
    Matrix3::identity() - cross * first + cross * cross * second
}

/// Inverse of [`right_jacobian`]: `I + [b]x/2 + (1 - (t/2) cot(t/2))/t^2 [b]x^2`, regular up to and at half a turn.
pub fn inverse_right_jacobian(rotation_vector: &Vector3<f64>) -> Matrix3<f64> {
    let angle = rotation_vector.norm();
    let cross = rotation_vector.cross_matrix();
    let factor = if angle < 1e-3 {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        (1.0 - 0.5 * angle / (0.5 * angle).tan()) / angle.powi(2)
    };
    Matrix3::identity() + cross * 0.5 + cross * cross * factor
}

/// Derivative of the pose with respect to the chart's six numbers: rows 0-2 the position's (m), rows 3-5 the rotation's as
/// the angular rate in the plate's frame, `R^T dR = [omega]x` (rad).
///
/// With `A = Rz(twist/2)`, `B = exp([b]x)`: `R = A B A`, `position = A y`, so that
/// `d position = e_z x position dtwist/2 + A dy` and `omega = (A^T B^T e_z + e_z) dtwist/2 + A^T J_r(b) db`.
pub fn chart_to_pose_jacobian(chart: &PoseChart) -> Matrix6<f64> {
    let half_turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5 * chart.twist);
    let bend_vector = Vector3::new(chart.bend[0], chart.bend[1], 0.0);
    let bend = Rotation3::from_scaled_axis(bend_vector);
    let position = half_turn * Vector3::from(chart.position);
    let back = half_turn.matrix().transpose();
    let mut jacobian = Matrix6::zeros();
    jacobian.fixed_view_mut::<3, 1>(0, 0).copy_from(&(Vector3::z().cross(&position) * 0.5));
    jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(half_turn.matrix());
    let axis = back * (bend.matrix().transpose() * Vector3::z()) + Vector3::z();
    jacobian.fixed_view_mut::<3, 1>(3, 0).copy_from(&(axis * 0.5));
    let by_bend = back * right_jacobian(&bend_vector);
    jacobian.fixed_view_mut::<3, 2>(3, 1).copy_from(&by_bend.fixed_columns::<2>(0));
    jacobian
}

/// Weighted pose error (m): `[w_p (x - x_t); w_r log(R_t^T R)]`, and its derivative with respect to the chart.
pub(crate) fn pose_error(goal: &Goal, chart: &PoseChart) -> (Vector6<f64>, Matrix6<f64>) {
    let pose = chart.to_pose();
    let mut error = Vector6::zeros();
    let mut derivative = chart_to_pose_jacobian(chart);
    error.fixed_rows_mut::<3>(0).copy_from(&((pose.position - goal.position) * goal.position_weight));
    derivative.fixed_rows_mut::<3>(0).scale_mut(goal.position_weight);
    if goal.rotation_weight > 0.0 {
        let log = (goal.rotation.inverse() * pose.rotation).scaled_axis();
        error.fixed_rows_mut::<3>(3).copy_from(&(log * goal.rotation_weight));
        let by_chart = inverse_right_jacobian(&log) * derivative.fixed_rows::<3>(3) * goal.rotation_weight;
        derivative.fixed_rows_mut::<3>(3).copy_from(&by_chart);
    } else {
        derivative.fixed_rows_mut::<3>(3).fill(0.0);
    }
    (error, derivative)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Target;
    use actuator::TipPose;

    /// Charts with more than a turn, no bend, a large bend.
    const CHARTS: [[f64; 6]; 4] = [
        [0.7, 0.3, -0.2, 0.01, -0.02, 0.17],
        [-7.9, 0.0, 0.0, 0.0, 0.0, 0.19],
        [5.0, -1.9, 1.1, 0.05, 0.03, 0.1],
        [0.0, 4e-4, 3e-4, 1e-3, 0.0, 0.17],
    ];

    #[test]
    fn the_error_s_derivative_is_that_of_differences() {
        let poses = [
            TipPose::from_parts([0.02, -0.01, 0.15], [0.8, 0.1, -0.3, 0.5]).unwrap(),
            TipPose::from_parts([0.0, 0.0, 0.2], [-0.1, 0.9, 0.2, 0.3]).unwrap(),
        ];
        for (pose, array) in poses.iter().flat_map(|pose| CHARTS.map(|array| (pose, array))) {
            let mut target = Target::pose(pose, 0.17);
            target.position_weight = 2.0;
            let goal = Goal::new(&target).unwrap();
            let at = |array| pose_error(&goal, &PoseChart::from_array(array));
            let (_, derivative) = at(array);
            for column in 0..6 {
                // Central differences: error h^2 (1e-10) times third derivatives of order 10, plus rounding 1e-16/h.
                let step = 1e-5;
                let (mut ahead, mut behind) = (array, array);
                ahead[column] += step;
                behind[column] -= step;
                let difference = (at(ahead).0 - at(behind).0) / (2.0 * step);
                let error = (difference - derivative.column(column)).norm();
                assert!(error < 1e-8, "chart {array:?}, column {column}: {error:e}");
            }
        }
    }

    #[test]
    fn the_two_rotation_jacobians_are_inverse_on_both_sides_of_the_series() {
        for angle in [0.0, 1e-6, 9.99e-4, 1.001e-3, 0.4, 2.0, 3.1] {
            let vector = Vector3::new(0.36, -0.48, 0.8) * angle;
            let product = right_jacobian(&vector) * inverse_right_jacobian(&vector);
            // (t - sin t)/t^3 loses 1e-16/t^2 to cancellation at the switch, times t^2.
            assert!((product - Matrix3::identity()).norm() < 1e-12, "{angle}: {product}");
        }
    }

    #[test]
    fn the_error_vanishes_at_the_target_whatever_the_turn() {
        for turns in [-2.0, 0.0, 1.0] {
            let chart = PoseChart::from_array([0.4, 0.3, -0.2, 0.01, -0.02, 0.17]);
            let goal = Goal::new(&Target::pose(&chart.to_pose(), 0.17)).unwrap();
            let turned = PoseChart::from_pose(&chart.to_pose(), 0.4 + turns * std::f64::consts::TAU);
            assert!((turned.twist - 0.4).abs() > 6.0 || turns == 0.0);
            assert!(pose_error(&goal, &turned).0.norm() < 1e-14);
        }
    }
}
