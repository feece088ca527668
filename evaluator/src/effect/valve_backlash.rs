//! Dead band of the regulator: the pressure follows the command with a play, `p <- max(u - r, min(u + r, p))`.
//!
//! The same operator as the rubber's hysteresis, on the link before the pressure reading: only a measured pressure tells the two
//! apart. State: the pressure, Pa.

use super::Parameter;
use crate::Real;

/// `radius_kpa`: r.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "radius_kpa",
    unit: 1e3,
    neutral: 0.0,
    start: 0.3e3,
    lower: 0.0,
    upper: 10e3,
    scale: 0.2e3,
}];

/// Pressure (Pa) that the regulator gives for a command (Pa).
pub(super) fn pressure<T: Real>(values: &[T], memory: &mut T, command: T) -> T {
    *memory = super::hysteresis::play(values[0], *memory, command);
    *memory
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_small_reversal_moves_nothing() {
        let mut memory = 0.0;
        assert_eq!(super::pressure(&[1.0], &mut memory, 10.0), 9.0);
        assert_eq!(super::pressure(&[1.0], &mut memory, 8.5), 9.0);
        assert_eq!(super::pressure(&[1.0], &mut memory, 7.0), 8.0);
    }
}
