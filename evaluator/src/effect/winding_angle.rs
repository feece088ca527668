//! A winding laid at another angle than the description says: `angle -> angle + delta`, through the angle axis of a FREE's map.
//! Bounds: hand winding errs by one to three degrees. No state.

use super::Parameter;

/// `change_deg`: delta; positive = more along the tube.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "change_deg",
    unit: core::f64::consts::PI / 180.0,
    neutral: 0.0,
    start: 0.0,
    lower: -0.07,
    upper: 0.07,
    scale: 0.01,
}];
