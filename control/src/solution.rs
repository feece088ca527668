use actuator::{PoseChart, TipPose};
use serde::{Deserialize, Serialize};
use std::fmt;

/// What became of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// The pose is the target within the tolerance.
    Reached,
    /// It is not, and the answer is the nearest pose that was found.
    Unreachable,
    /// The question cannot be answered; there are no pressures.
    Refused,
}

/// Which end of a pressure's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// The least pressure.
    Min,
    /// The greatest pressure.
    Max,
    /// The fastest fall.
    RateDown,
    /// The fastest rise.
    RateUp,
}

/// A bound that a pressure lies on. Written `p2_min`, `p1_rate_up`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ActiveBound {
    /// Index of the FREE, from zero; written from one.
    pub free: usize,
    /// Which end.
    pub side: Side,
}

impl fmt::Display for ActiveBound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = match self.side {
            Side::Min => "min",
            Side::Max => "max",
            Side::RateDown => "rate_down",
            Side::RateUp => "rate_up",
        };
        write!(f, "p{}_{side}", self.free + 1)
    }
}

/// Pressures and what the model says of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// Pressures, Pa, within the bounds to the bit.
    pub pressures: Vec<f64>,
    /// The pose there.
    pub chart: PoseChart,
    /// Distance of the plate's centre to the target's position, m, unweighted.
    pub position_error: f64,
    /// Angle to the target's rotation, rad, 0 to pi; `None` where the target has none.
    pub rotation_error: Option<f64>,
    /// Bounds that a pressure lies on.
    pub active_bounds: Vec<ActiveBound>,
    /// Least distance of a pressure to its limit, Pa.
    pub limit_margin: f64,
    /// How far from a stationary point of the pose error, relative (0 = stationary): the largest projected gradient over the
    /// Jacobian's norm and the error, the error taken as 1 mm at least.
    pub stationarity: f64,
}

impl Answer {
    /// Tip pose at the pressures.
    pub fn pose(&self) -> TipPose {
        self.chart.to_pose()
    }
}

/// Outcome of a solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// What became of the target.
    pub status: Status,
    /// The pressures; `None` exactly when refused.
    pub answer: Option<Answer>,
    /// Clarabel programs and Newton steps, over all starts.
    pub iterations: usize,
    /// Why the target is not reached, in words; empty when it is.
    pub reason: String,
}

impl Solution {
    pub(crate) fn refused(reason: String, iterations: usize) -> Self {
        Solution { status: Status::Refused, answer: None, iterations, reason }
    }
}
