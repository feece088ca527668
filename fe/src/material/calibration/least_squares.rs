//! Levenberg's and Marquardt's method for small problems, and Student's distribution for their intervals.

use nalgebra::{DMatrix, DVector};

/// Most steps of one descent.
const MOST_STEPS: usize = 400;
/// Relative change of all parameters at which a descent ends.
const SMALLEST_STEP: f64 = 1e-12;

/// A minimum of the sum of squares.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub at: DVector<f64>,
    /// Sum of the squared residuals.
    pub cost: f64,
    /// Derivatives of the residuals by the parameters.
    pub jacobian: DMatrix<f64>,
}

/// Descends from `start`; `residuals` says `None` where the parameters make no sense. `None` where `start` does not.
pub(super) fn minimise(
    start: DVector<f64>,
    residuals: &dyn Fn(&[f64]) -> Option<DVector<f64>>,
) -> Option<Minimum> {
    let mut at = start;
    let mut values = residuals(at.as_slice())?;
    let mut cost = values.norm_squared();
    let mut jacobian = derivatives(&at, &values, residuals);
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        // Columns of unit length: parameters of any unit are damped alike.
        let scale = DVector::from_iterator(
            at.len(),
            jacobian.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE.sqrt())),
        );
        let scaled = DMatrix::from_fn(jacobian.nrows(), at.len(), |i, j| jacobian[(i, j)] / scale[j]);
        let normal = scaled.tr_mul(&scaled);
        let gradient = scaled.tr_mul(&values);
        let damped = &normal + DMatrix::from_diagonal_element(at.len(), at.len(), damping);
        let step = damped.cholesky().map(|factor| factor.solve(&-&gradient).component_div(&scale));
        let Some(step) = step else {
            damping *= 10.0;
            if damping > 1e12 {
                break;
            }
            continue;
        };
        let size = |i: usize| step[i].abs() / (at[i].abs() + 1e-9);
        let small = (0..at.len()).all(|i| size(i) < SMALLEST_STEP);
        let trial = &at + &step;
        match residuals(trial.as_slice()).map(|values| (values.norm_squared(), values)) {
            Some((lower, new)) if lower < cost => {
                let stalled = cost - lower < 1e-14 * cost;
                (at, cost, values) = (trial, lower, new);
                jacobian = derivatives(&at, &values, residuals);
                damping = f64::max(0.1 * damping, 1e-15);
                if small || stalled {
                    break;
                }
            }
            _ if small => break,
            _ => {
                damping *= 8.0;
                if damping > 1e12 {
                    break;
                }
            }
        }
    }
    Some(Minimum { at, cost, jacobian })
}

/// Central differences; one-sided beside parameters that make no sense.
fn derivatives(
    at: &DVector<f64>,
    values: &DVector<f64>,
    residuals: &dyn Fn(&[f64]) -> Option<DVector<f64>>,
) -> DMatrix<f64> {
    let mut jacobian = DMatrix::zeros(values.len(), at.len());
    for j in 0..at.len() {
        // The cube root of rounding balances it with truncation.
        let step = 6e-6 * at[j].abs().max(1e-6);
        let shifted = |by: f64| {
            let mut moved = at.clone();
            moved[j] += by;
            residuals(moved.as_slice())
        };
        let column = match (shifted(step), shifted(-step)) {
            (Some(up), Some(down)) => (up - down) / (2.0 * step),
            (Some(up), None) => (up - values) / step,
            (None, Some(down)) => (values - down) / step,
            (None, None) => DVector::zeros(values.len()),
        };
        jacobian.set_column(j, &column);
    }
    jacobian
}

/// Half widths of 95 % intervals of the parameters at a minimum; `None` for all where the data leave a direction undetermined or
/// no freedom is left to tell the noise.
pub(super) fn half_widths(minimum: &Minimum) -> Option<Vec<f64>> {
    let (points, parameters) = minimum.jacobian.shape();
    let freedom = points.checked_sub(parameters).filter(|freedom| *freedom > 0)?;
    let norms: Vec<f64> = minimum.jacobian.column_iter().map(|column| column.norm()).collect();
    if norms.iter().any(|norm| norm.is_nan() || *norm <= 0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(points, parameters, |i, j| minimum.jacobian[(i, j)] / norms[j]);
    let singular = scaled.clone().singular_values();
    // Differences are good to 1e-9: what is flatter than that is undetermined.
    if singular.min() < 1e-8 * singular.max() {
        return None;
    }
    let covariance = scaled.tr_mul(&scaled).cholesky()?.inverse();
    let noise = (minimum.cost / freedom as f64).sqrt();
    let t = student_quantile(freedom);
    Some((0..parameters).map(|j| t * noise * covariance[(j, j)].sqrt() / norms[j]).collect())
}

/// 97.5 % quantile of Student's distribution: exact for one and two degrees of freedom, by its expansion in 1/freedom
/// (Abramowitz and Stegun 26.7.5) from three on (to 0.3 % there, better than 1e-4 from eight).
pub(super) fn student_quantile(freedom: usize) -> f64 {
    let z: f64 = 1.959_963_984_540_054;
    let n = freedom as f64;
    match freedom {
        0 => f64::INFINITY,
        1 => (0.475 * std::f64::consts::PI).tan(),
        // t = u sqrt(2/(1 - u^2)) with u = 2 p - 1.
        2 => 0.95 * (2.0f64 / (1.0 - 0.95 * 0.95)).sqrt(),
        _ => {
            let g = [
                (z.powi(3) + z) / 4.0,
                (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
                (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
                (79.0 * z.powi(9) + 776.0 * z.powi(7) + 1482.0 * z.powi(5) - 1920.0 * z.powi(3) - 945.0 * z)
                    / 92160.0,
            ];
            g.iter().enumerate().fold(z, |sum, (i, g)| sum + g / n.powi(i as i32 + 1))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedom, printed) in [(1, 12.706), (2, 4.303), (3, 3.182), (5, 2.571), (10, 2.228), (30, 2.042)]
        {
            assert!((student_quantile(freedom) / printed - 1.0).abs() < 3e-3, "{freedom}");
        }
    }

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        // Rosenbrock: residuals 10 (y - x^2), 1 - x.
        let residuals = |p: &[f64]| Some(DVector::from_vec(vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]));
        let found = minimise(DVector::from_vec(vec![-1.2, 1.0]), &residuals).unwrap();
        assert!((found.at[0] - 1.0).abs() < 1e-9 && (found.at[1] - 1.0).abs() < 1e-9, "{}", found.at);
    }

    #[test]
    fn intervals_of_a_line_are_those_of_regression() {
        // y = a + b x at 0..4 with residuals of unit pattern: var b = s^2/Sxx.
        let x = [0.0, 1.0, 2.0, 3.0, 4.0];
        let y = [0.1, 0.9, 2.2, 2.8, 4.05];
        let residuals =
            |p: &[f64]| Some(DVector::from_iterator(5, x.iter().zip(y).map(|(x, y)| p[0] + p[1] * x - y)));
        let found = minimise(DVector::from_vec(vec![0.0, 0.5]), &residuals).unwrap();
        let widths = half_widths(&found).unwrap();
        let s = (found.cost / 3.0).sqrt();
        assert!((widths[1] / (student_quantile(3) * s / 10f64.sqrt()) - 1.0).abs() < 1e-6);
    }
}
