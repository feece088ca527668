//! A winding laid at another angle than the description says: `angle -> angle + delta`, through the angle axis of a FREE's map. No state.

use super::Parameter;

/// `change_deg`: delta; positive = more along the tube.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "change_deg",
    unit: std::f64::consts::PI / 180.0,
    neutral: 0.0,
    start: 0.0,
    lower: -0.14,
    upper: 0.14,
    scale: 0.01,
}];
