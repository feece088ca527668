use actuator::TipPose;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Where the tip plate shall be. Plain numbers, so that a log can hold it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Position of the plate's centre in the base frame, m.
    pub position: [f64; 3],
    /// Rotation from the plate's frame to the base frame as (w, x, y, z), any length but zero; `None`: free.
    pub rotation: Option<[f64; 4]>,
    /// Weight of the position error (w_p above, no unit); 0 leaves the position free.
    pub position_weight: f64,
    /// Weight of the rotation error (w_r above), m: metres of position error that one radian counts. The module's length is a
    /// good value; 0 leaves the rotation free.
    pub rotation_weight: f64,
}

impl Target {
    /// A position (m), the rotation free.
    pub fn at(position: [f64; 3]) -> Self {
        Target { position, rotation: None, position_weight: 1.0, rotation_weight: 0.0 }
    }

    /// A whole pose; `length` (m) is the module's length, with which a radian is weighed against metres.
    pub fn pose(pose: &TipPose, length: f64) -> Self {
        Target {
            position: pose.position.into(),
            rotation: Some(pose.wxyz()),
            position_weight: 1.0,
            rotation_weight: length,
        }
    }
}

/// Errors up to which a target counts as reached. The search does not stop there: it goes on to the least error it can find.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Position, m. Default 0.01 mm, well below what a reduced model knows.
    pub position: f64,
    /// Rotation, rad. Default 1e-4 (0.006 degrees).
    pub rotation: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Tolerance { position: 1e-5, rotation: 1e-4 }
    }
}

/// A target whose numbers were checked.
#[derive(Clone, Debug)]
pub(crate) struct Goal {
    pub position: Vector3<f64>,
    pub rotation: UnitQuaternion<f64>,
    pub position_weight: f64,
    /// Zero where the target has no rotation.
    pub rotation_weight: f64,
    pub has_rotation: bool,
}

/// Farther away than this (m) no module reaches, and squares of distances lose their digits.
const FARTHEST: f64 = 1e4;

impl Goal {
    pub fn new(target: &Target) -> Result<Self, String> {
        let number = |name: &str, value: f64| {
            if value.is_finite() {
                Ok(())
            } else {
                Err(format!("the target's {name} is {value}; give a finite number"))
            }
        };
        for (name, value) in ["x", "y", "z"].iter().zip(target.position) {
            number(name, value)?;
            if value.abs() > FARTHEST {
                return Err(format!(
                    "the target's {name} is {value} m; positions are given in metres from the base plate"
                ));
            }
        }
        for (name, value) in
            [("position weight", target.position_weight), ("rotation weight", target.rotation_weight)]
        {
            number(name, value)?;
            if !(0.0..=1e6).contains(&value) {
                return Err(format!("the target's {name} is {value}; give a number from 0 to 1e6"));
            }
        }
        let rotation = match target.rotation {
            None => UnitQuaternion::identity(),
            Some([w, x, y, z]) => {
                for (name, value) in ["qw", "qx", "qy", "qz"].iter().zip([w, x, y, z]) {
                    number(name, value)?;
                }
                UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
                    .ok_or("the target's quaternion (w, x, y, z) is zero; give 1, 0, 0, 0 for no rotation")?
            }
        };
        let rotation_weight = if target.rotation.is_some() { target.rotation_weight } else { 0.0 };
        Ok(Goal {
            position: target.position.into(),
            rotation,
            position_weight: target.position_weight,
            rotation_weight,
            has_rotation: target.rotation.is_some(),
        })
    }
}
