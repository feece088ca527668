//! Mullins softening: rubber that was inflated further before is softer below that pressure.
//! `p_effective = p (1 + m (1 - p/p_max))` with `p_max` the greatest pressure so far; first loading is left as it is.
//!
//! State: `p_max`, Pa; zero in a virgin actuator.

use super::Parameter;
use crate::Real;

/// `softening`: m, without unit.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "softening",
    unit: 1.0,
    neutral: 0.0,
    start: 0.05,
    lower: -0.1,
    upper: 0.8,
    scale: 0.05,
}];

/// The pressure (Pa) that the base model is to answer.
pub(super) fn pressure<T: Real>(values: &[T], memory: &mut T, pressure: T) -> T {
    *memory = memory.greater(pressure);
    if *memory <= T::ZERO {
        pressure
    } else {
        pressure * (T::ONE + values[0] * (T::ONE - pressure / *memory))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_below_the_past_maximum() {
        let mut memory = 0.0f64;
        assert_eq!(pressure(&[0.2], &mut memory, 5.0), 5.0);
        assert_eq!(pressure(&[0.2], &mut memory, 10.0), 10.0);
        assert!((pressure(&[0.2], &mut memory, 5.0) - 5.5).abs() < 1e-12);
    }
}
