use nalgebra::{Quaternion, UnitQuaternion, Vector2, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Position (m) and rotation of the tip plate in the base frame. At rest: position (0, 0, length), no rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipPose {
    /// Position of the plate's centre, m.
    pub position: Vector3<f64>,
    /// Rotation from the plate's frame to the base frame.
    pub rotation: UnitQuaternion<f64>,
}

/// Brings an angle (rad) into (-pi, pi].
pub fn wrap_angle(angle: f64) -> f64 {
    let wrapped = angle.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}

impl TipPose {
    /// Builds a pose from metres and a quaternion (w, x, y, z), which need not be normalised.
    /// `None` when a number is not finite or the quaternion is zero.
    pub fn from_parts(position: [f64; 3], wxyz: [f64; 4]) -> Option<Self> {
        let quaternion = Quaternion::new(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
        let rotation = UnitQuaternion::try_new(quaternion, 1e-6)?;
        let finite = position.iter().chain(&wxyz).all(|value| value.is_finite());
        finite.then_some(TipPose { position: Vector3::from(position), rotation })
    }

    /// The quaternion as (w, x, y, z).
    pub fn wxyz(&self) -> [f64; 4] {
        let q = self.rotation;
        [q.w, q.i, q.j, q.k]
    }

    /// This motion after `inner`: where a frame placed by `inner` in this frame stands in the frame this one stands in.
    pub fn compose(&self, inner: &TipPose) -> TipPose {
        TipPose {
            position: self.position + self.rotation * inner.position,
            rotation: self.rotation * inner.rotation,
        }
    }

    /// Angle (rad, 0 to pi) of the rotation between two poses.
    pub fn rotation_distance(&self, other: &TipPose) -> f64 {
        self.rotation.angle_to(&other.rotation)
    }
}

/// Six numbers of a tip pose that do not wrap: what maps are interpolated in.
///
/// The rotation is split symmetrically, `R = Rz(twist/2) exp([bend_x, bend_y, 0]x) Rz(twist/2)`, and the position is written in
/// the half-turned frame, `position = Rz(twist/2) (x, y, z)`. A rod of constant strain has exactly this shape: bend and
/// sideways motion keep their direction however far the module turns. `twist` counts whole turns; the split is unique and
/// smooth while the bend stays below pi. (Exponential coordinates of the whole pose, the other choice, are singular at one full
/// turn, where a 40 degree right-handed module works.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseChart {
    /// Turn about the tube's axis, rad, unwrapped.
    pub twist: f64,
    /// Bend vector in the half-turned frame, rad: the tip's axis is turned by |bend| about it.
    pub bend: [f64; 2],
    /// Position in the half-turned frame, m.
    pub position: [f64; 3],
}

impl PoseChart {
    /// Chart of a pose whose twist is within half a turn of `near_twist` (rad): the branch is chosen by it.
    pub fn from_pose(pose: &TipPose, near_twist: f64) -> Self {
        let q = pose.rotation;
        // For R = Rz(t/2) exp(b) Rz(t/2): w = cos(|b|/2) cos(t/2), k = cos(|b|/2) sin(t/2), and (i, j) = sin(|b|/2) b/|b| does
        // not change with t. q and -q give twists one turn apart, so the branch fixes the sign of q too.
        let principal = 2.0 * q.k.atan2(q.w);
        let twist = near_twist + wrap_angle(principal - near_twist);
        let half_turns_apart = ((twist - principal) / TAU).round() as i64;
        let sign = if half_turns_apart % 2 == 0 { 1.0 } else { -1.0 };
        let sine = Vector2::new(sign * q.i, sign * q.j);
        let half = sine.norm().atan2(q.w.hypot(q.k));
        // half/sin(half) -> 1 as the bend vanishes.
        let ratio = if half < 1e-8 { 1.0 } else { half / half.sin() };
        let bend = sine * (2.0 * ratio);
        let position = rotation_about_z(-0.5 * twist) * pose.position;
        PoseChart { twist, bend: bend.into(), position: position.into() }
    }

    /// The pose.
    pub fn to_pose(&self) -> TipPose {
        let half_turn = rotation_about_z(0.5 * self.twist);
        let bend = UnitQuaternion::from_scaled_axis(Vector3::new(self.bend[0], self.bend[1], 0.0));
        TipPose { position: half_turn * Vector3::from(self.position), rotation: half_turn * bend * half_turn }
    }

    /// The numbers in the order twist, bend x, bend y, x, y, z.
    pub fn to_array(&self) -> [f64; 6] {
        let [bx, by] = self.bend;
        let [x, y, z] = self.position;
        [self.twist, bx, by, x, y, z]
    }

    /// The inverse of [`PoseChart::to_array`].
    pub fn from_array(values: [f64; 6]) -> Self {
        let [twist, bx, by, x, y, z] = values;
        PoseChart { twist, bend: [bx, by], position: [x, y, z] }
    }
}

fn rotation_about_z(angle: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chart_and_pose_return_each_other_over_several_turns() {
        for twist in [-9.0, -6.4, -6.2, -3.2, -3.1, 0.0, 0.3, 3.2, 6.27, 6.4, 12.5] {
            for bend in [[0.0, 0.0], [0.4, -0.2], [-1.9, 1.7], [1e-12, 0.0]] {
                let chart = PoseChart { twist, bend, position: [0.01, -0.02, 0.17] };
                let pose = chart.to_pose();
                let back = PoseChart::from_pose(&pose, twist + 1.0);
                for (a, b) in chart.to_array().iter().zip(back.to_array()) {
                    assert!((a - b).abs() < 1e-12, "{chart:?} came back as {back:?}");
                }
            }
        }
    }

    #[test]
    fn a_full_turn_with_a_little_bend_is_regular() {
        // One full turn is where exp coordinates are singular: here a small bend stays a small, smooth bend.
        let chart = |bend| PoseChart { twist: TAU, bend: [bend, 0.0], position: [0.0, 0.0, 0.17] }.to_pose();
        for bend in [-1e-3, 0.0, 1e-3] {
            let back = PoseChart::from_pose(&chart(bend), TAU - 0.1);
            assert!((back.bend[0] - bend).abs() < 1e-12);
            assert!((back.twist - TAU).abs() < 1e-12);
        }
    }

    #[test]
    fn not_a_number_is_no_pose() {
        assert!(TipPose::from_parts([f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]).is_none());
        assert!(TipPose::from_parts([0.0; 3], [0.0; 4]).is_none());
    }
}
