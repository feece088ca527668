//! A supply that cannot give more than its own pressure: `p = min(u, p_s)`. No state.

use super::Parameter;
use crate::Real;

/// `supply_kpa`: p_s.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "supply_kpa",
    unit: 1e3,
    neutral: 1e9,
    start: 40e3,
    lower: 1e3,
    upper: 1e9,
    scale: 1e3,
}];

/// min(u, p_s), Pa.
pub(super) fn pressure<T: Real>(values: &[T], command: T) -> T {
    command.lesser(values[0])
}

#[cfg(test)]
mod tests {
    #[test]
    fn below_the_supply_nothing_changes() {
        assert_eq!(super::pressure(&[34e3], 20e3), 20e3);
        assert_eq!(super::pressure(&[34e3], 40e3), 34e3);
    }
}
