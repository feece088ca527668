use crate::rows::Rows;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A smooth function of the pressures added to every channel: what the base model's own error may look like. Memory effects are judged beside it, so
/// that a wrong shape of the base model is never taken for a memory, nor a memory hidden by a wrong shape.
///
/// Polynomials of total degree 3 (2 from five FREEs on) in the pressures over the greatest pressure, with a weak pull to zero.
pub struct Discrepancy {
    /// Values of the polynomials, sample by sample.
    basis: DMatrix<f64>,
}

/// Pull to zero, as a share of the mean square of a polynomial: leaves well-determined coefficients alone, bounds the others.
const RIDGE: f64 = 1e-5;

/// A fitted discrepancy: coefficients of each channel.
pub struct Coefficients(Vec<DVector<f64>>);

/// Exponents of all products of total degree up to `degree`.
fn exponents(variables: usize, degree: usize) -> Vec<Vec<usize>> {
    let mut all = vec![vec![]];
    for _ in 0..variables {
        all = all
            .into_iter()
            .flat_map(|start: Vec<usize>| {
                let used: usize = start.iter().sum();
                (0..=degree - used).map(move |power| start.iter().copied().chain([power]).collect())
            })
            .collect();
    }
    all
}

impl Discrepancy {
    /// The polynomials at drive pressures (Pa, FREEs fastest), with the scale `greatest` (Pa).
    pub fn new(drives: &[f64], frees: usize, greatest: f64) -> Self {
        let degree = if frees < 5 { 3 } else { 2 };
        let exponents = exponents(frees, degree);
        let samples = drives.len() / frees.max(1);
        let basis = DMatrix::from_fn(samples, exponents.len(), |sample, term| {
            let pressures = &drives[sample * frees..(sample + 1) * frees];
            // From -1 to 1 over the range: powers are then far less alike.
            exponents[term]
                .iter()
                .zip(pressures)
                .map(|(power, p)| (2.0 * p / greatest - 1.0).powi(*power as i32))
                .product()
        });
        Discrepancy { basis }
    }

    /// A constant alone, over `samples` samples.
    pub fn constant(samples: usize) -> Self {
        Discrepancy { basis: DMatrix::from_element(samples, 1, 1.0) }
    }

    fn normal(&self, valid: &[f64]) -> Option<Cholesky<f64, Dyn>> {
        let mut weighted = self.basis.clone();
        for (mut row, value) in weighted.row_iter_mut().zip(valid) {
            if !value.is_finite() {
                row.fill(0.0);
            }
        }
        let mut normal = weighted.transpose() * &weighted;
        let pull = RIDGE * normal.trace() / normal.nrows() as f64 + f64::MIN_POSITIVE;
        for k in 0..normal.nrows() {
            normal[(k, k)] += pull;
        }
        normal.cholesky()
    }

    fn moments(&self, channel: &[f64]) -> DVector<f64> {
        let filled = DVector::from_iterator(
            channel.len(),
            channel.iter().map(|v| if v.is_finite() { *v } else { 0.0 }),
        );
        self.basis.tr_mul(&filled)
    }

    /// Takes the discrepancy that fits each channel best out of the residuals and out of their derivatives; returns its coefficients.
    pub fn project(&self, rows: &mut Rows, columns: &mut [Rows]) -> Coefficients {
        let mut coefficients = Vec::with_capacity(rows.channels.len());
        for channel in 0..rows.channels.len() {
            let Some(normal) = self.normal(&rows.channels[channel]) else {
                coefficients.push(DVector::zeros(self.basis.ncols()));
                continue;
            };
            for column in columns.iter_mut() {
                let fitted = normal.solve(&self.moments(&column.channels[channel]));
                self.take_out(&fitted, &mut column.channels[channel]);
            }
            let fitted = normal.solve(&self.moments(&rows.channels[channel]));
            self.take_out(&fitted, &mut rows.channels[channel]);
            coefficients.push(fitted);
        }
        Coefficients(coefficients)
    }

    fn take_out(&self, coefficients: &DVector<f64>, channel: &mut [f64]) {
        let fitted = &self.basis * coefficients;
        for (value, fitted) in channel.iter_mut().zip(fitted.iter()) {
            *value -= fitted;
        }
    }

    /// Takes a discrepancy fitted elsewhere out of residuals at this one's samples.
    pub fn apply(&self, coefficients: &Coefficients, rows: &mut Rows) {
        for (channel, coefficients) in rows.channels.iter_mut().zip(&coefficients.0) {
            self.take_out(coefficients, channel);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_polynomials_as_the_binomial_says() {
        assert_eq!(exponents(4, 3).len(), 35);
        assert_eq!(exponents(1, 3).len(), 4);
    }

    #[test]
    fn a_cubic_is_taken_out_and_known_again_elsewhere() {
        let drives = |count: usize, offset: f64| -> Vec<f64> {
            (0..2 * count).map(|k| 25e3 * (1.0 + (k as f64 * 0.7 + offset).sin())).collect()
        };
        let cubic = |drives: &[f64]| -> Vec<f64> {
            drives.chunks(2).map(|p| 1.0 + (p[0] / 5e4).powi(3) - p[0] * p[1] / 2.5e9).collect()
        };
        let (here, there) = (drives(200, 0.0), drives(50, 1.0));
        let mut rows = Rows { channels: vec![cubic(&here)] };
        rows.channels[0][7] = f64::NAN;
        let fitted = Discrepancy::new(&here, 2, 5e4).project(&mut rows, &mut []);
        // What is left is the pull to zero, RIDGE of the size of the cubic.
        assert!(rows.channels[0].iter().all(|left| left.is_nan() || left.abs() < 1e-3));
        let mut other = Rows { channels: vec![cubic(&there)] };
        Discrepancy::new(&there, 2, 5e4).apply(&fitted, &mut other);
        assert!(other.channels[0].iter().all(|left| left.abs() < 1e-3));
    }
}
