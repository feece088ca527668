//! A mass at the plate's centre that the description does not know, through the map's slope with respect to [`actuator::MapParameter::Payload`]. No state.

use super::Parameter;

/// `mass_g`.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "mass_g",
    unit: 1e-3,
    neutral: 0.0,
    start: 0.0,
    lower: -0.02,
    upper: 0.2,
    scale: 5e-3,
}];
