use crate::ErrorStatistics;
use serde::{Deserialize, Serialize};

/// Error of a module model on states of the finite elements that the fit never saw.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModuleErrors {
    /// Distance between model and finite elements, m.
    pub position: ErrorStatistics,
    /// Angle between them, rad.
    pub rotation: ErrorStatistics,
    /// Pressures (Pa) at which the position is worst.
    pub worst_at: Vec<f64>,
    /// Check states outside the model's domain, which were not judged.
    pub outside: usize,
    /// Check states that are unstable, which were not judged either.
    pub unstable: usize,
    /// Of the states that took no part in setting the error bars: how many there are, and at how many position and rotation are
    /// within their bars.
    pub bars: BarCoverage,
}

/// How often error bars hold on states that took no part in setting them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BarCoverage {
    /// Number of states.
    pub states: usize,
    /// Those whose position is within its bar.
    pub position: usize,
    /// Those whose rotation is within its bar.
    pub rotation: usize,
}
