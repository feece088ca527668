use crate::setup::Setup;
use crate::verdict::Estimated;
use nalgebra::DMatrix;

/// Estimates with their 95 % intervals (1.96 standard errors) in the unit of their names: index of the effect, index of its value, estimate.
pub fn intervals(setup: &Setup, covariance: &DMatrix<f64>) -> Vec<(usize, usize, Estimated)> {
    let mut all = Vec::new();
    for (number, own) in setup.numbers.iter().enumerate() {
        let half = 1.96 * covariance[(number, number)].max(0.0).sqrt();
        let value = setup.value(number);
        let unit = |value: f64| own.parameter.in_unit(value.clamp(own.parameter.lower, own.parameter.upper));
        let estimated = Estimated { value: unit(value), ci95: [unit(value - half), unit(value + half)] };
        all.extend(own.values.iter().map(|value| (own.effect, *value, estimated)));
    }
    all
}
