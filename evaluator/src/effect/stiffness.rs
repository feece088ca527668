//! Stiffness of the rubber, the whole class that acts alike in free inflation: modulus, wall, coating, temperature, pressure gain.
//!
//! By dimensional analysis a material stiffer by the factor `1 + a` answers pressure `p` as the nominal one answers `p/(1 + a)`, when
//! the loads are divided too and fibres are stiff: `y(p, m; (1 + a) mu) = y(p/(1 + a), m/(1 + a); mu)` with `m` every mass that hangs on it.
//!
//! Limits: the fibres' EA is scaled along with the rubber, which changes twist by less than 0.5 % for a change of 50 %. No state.

use super::Parameter;
use crate::Real;

/// `change`: a, without unit; 0.1 = ten per cent stiffer.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "change",
    unit: 1.0,
    neutral: 0.0,
    start: 0.0,
    lower: -0.6,
    upper: 1.5,
    scale: 0.05,
}];

/// p/(1 + a), Pa.
pub(super) fn pressure<T: Real>(values: &[T], pressure: T) -> T {
    pressure / (T::ONE + values[0])
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_quarter_stiffer_needs_a_quarter_more_pressure() {
        assert!((super::pressure(&[0.25], 50e3f64) - 40e3).abs() < 1e-9);
    }
}
