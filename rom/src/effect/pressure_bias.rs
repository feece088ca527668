//! Zero error of a pressure sensor: `reading = p + b`. A model that is driven by the reading must take `b` off. No state.

use super::Parameter;

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
pub(super) fn read(values: &[f64], pressure: f64) -> f64 {
    pressure + values[0]
}

/// The pressure behind a reading, Pa: inverse of [`read`].
pub(super) fn unread(values: &[f64], reading: f64) -> f64 {
    reading - values[0]
}

#[cfg(test)]
mod tests {
    #[test]
    fn unread_is_the_inverse_of_read() {
        let reading = super::read(&[1.5e3], 20e3);
        assert!((reading - 21.5e3).abs() < 1e-9);
        assert!((super::unread(&[1.5e3], reading) - 20e3).abs() < 1e-9);
    }
}
