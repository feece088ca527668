use serde::{Deserialize, Serialize};

/// One inverse solve as the log keeps it: every number that went in, so that it can be computed again bit for bit, and every
/// number that came out. Message `freeact_msgs/msg/Solve`, in this order of fields. SI, gauge pressures.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolveRecord {
    /// Time, s from the start of the recording.
    pub time: f64,
    /// Target position of the tip plate, m.
    pub target_position: [f64; 3],
    /// Target rotation w, x, y, z; of no weight where `rotation_weight` is zero.
    pub target_rotation: [f64; 4],
    /// Pressures that the solve started from, Pa.
    pub start_pressure: Vec<f64>,
    /// Least pressures allowed in this solve, Pa, rate limits included.
    pub pressure_min: Vec<f64>,
    /// Greatest pressures allowed in this solve, Pa, rate limits included.
    pub pressure_max: Vec<f64>,
    /// Weight of the position error.
    pub position_weight: f64,
    /// Weight of the rotation error.
    pub rotation_weight: f64,
    /// Choice among equals: `least-pressure`, `least-change` or `margin`.
    pub preference: String,
    /// Weight of that choice.
    pub preference_weight: f64,
    /// Names of the other numbers that the solve depends on (tolerances, trust region, states of effects).
    pub setting_name: Vec<String>,
    /// Their values, in the same order.
    pub setting_value: Vec<f64>,
    /// `reached`, `unreachable` or `refused`.
    pub status: String,
    /// Why, in words; empty when reached.
    pub reason: String,
    /// Bounds that hold the answer, as `p2_min`.
    pub active_bound: Vec<String>,
    /// The answer, Pa.
    pub pressure: Vec<f64>,
    /// Position that the model predicts there, m.
    pub predicted_position: [f64; 3],
    /// Rotation that the model predicts there, w, x, y, z.
    pub predicted_rotation: [f64; 4],
    /// Value of the objective there.
    pub objective: f64,
    /// Distance from the target, m.
    pub position_residual: f64,
    /// Angle from the target, rad.
    pub rotation_residual: f64,
    /// Distance to the nearest limit pressure, Pa.
    pub limit_margin: f64,
    /// Steps taken.
    pub iterations: u32,
    /// Wall time of the solve, s; the only number that a second computation does not give again.
    pub duration: f64,
}
