//! Bending stiffness of every FREE against the base model's, through the map's slope with respect to
//! [`actuator::MapParameter::BendingStiffness`]: plates, glue and end caps change it more than anything else. No state.

use super::Parameter;

/// `change`: factor minus one.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "change",
    unit: 1.0,
    neutral: 0.0,
    start: 0.0,
    lower: -0.5,
    upper: 0.5,
    scale: 0.05,
}];
