//! One FREE of a module that is stronger or weaker than the others: `p -> (1 + k) p` for that FREE alone.
//!
//! The same equation as pressure gain or an own stiffness of one FREE; a common factor of all FREEs is the effect `stiffness`.
//! Vanishes at zero pressure, which tells it from a tilted base. No state.

use super::Parameter;
use crate::Real;

/// `gain`: k, without unit; positive = this FREE acts stronger.
pub(super) const PARAMETERS: &[Parameter] =
    &[Parameter { name: "gain", unit: 1.0, neutral: 0.0, start: 0.0, lower: -0.6, upper: 0.6, scale: 0.05 }];

/// (1 + k) p, Pa.
pub(super) fn pressure<T: Real>(values: &[T], pressure: T) -> T {
    (T::ONE + values[0]) * pressure
}

#[cfg(test)]
mod tests {
    #[test]
    fn gain_scales_the_pressure() {
        assert!((super::pressure(&[-0.1], 20e3f64) - 18e3).abs() < 1e-9);
    }
}
