//! Zero error of a pressure sensor: `reading = p + b`. A model that is driven by the reading must take `b` off. No state.

use super::Parameter;
use crate::Real;

/// `bias_kpa`: b; positive = the sensor reads too much.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "bias_kpa",
    unit: 1e3,
    neutral: 0.0,
    start: 0.0,
    lower: -10e3,
    upper: 10e3,
    scale: 0.2e3,
}];

/// What the sensor shows at a pressure, Pa.
pub(super) fn read<T: Real>(values: &[T], pressure: T) -> T {
    pressure + values[0]
}

/// The pressure behind a reading, Pa: inverse of [`read`].
pub(super) fn unread<T: Real>(values: &[T], reading: T) -> T {
    reading - values[0]
}

#[cfg(test)]
mod tests {
    #[test]
    fn unread_is_the_inverse_of_read() {
        let reading = super::read(&[1.5e3], 20e3f64);
        assert!((reading - 21.5e3).abs() < 1e-9);
        assert!((super::unread(&[1.5e3], reading) - 20e3).abs() < 1e-9);
    }
}
