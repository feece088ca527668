/// Symmetric banded matrix and its LDL^T factors, lower band kept column by column.
///
/// No pivoting: the columns of elements around the tube couple only with their neighbours, and the inner stiffness is
/// positive definite wherever the section is stable at given stretch and twist; past that the factors stay useful as long as
/// no pivot vanishes, and the caller judges the result by its residual.
#[derive(Clone, Debug)]
pub(crate) struct Banded {
    order: usize,
    /// Entries of a column from the diagonal down.
    height: usize,
    entries: Vec<f64>,
}

/// A pivot is zero or not a number: the matrix has no LDL^T factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ZeroPivot;

impl Banded {
    pub fn new(order: usize, bandwidth: usize) -> Self {
        let height = bandwidth + 1;
        Banded { order, height, entries: vec![0.0; order * height] }
    }

    pub fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// Adds to entry (row, column), row >= column.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.entries[column * self.height + (row - column)] += value;
    }

    /// Replaces the matrix by its factors: D on the diagonal, L below. Returns the number of negative pivots.
    pub fn factorise(&mut self) -> Result<usize, ZeroPivot> {
        let height = self.height;
        let mut negative = 0;
        for j in 0..self.order {
            let (before, after) = self.entries.split_at_mut((j + 1) * height);
            let column = &mut before[j * height..];
            let pivot = column[0];
            if pivot == 0.0 || !pivot.is_finite() {
                return Err(ZeroPivot);
            }
            negative += usize::from(pivot < 0.0);
            for (c, target) in after.chunks_exact_mut(height).take(height - 1).enumerate() {
                let factor = column[c + 1] / pivot;
                if factor != 0.0 {
                    for (entry, below) in target.iter_mut().zip(&column[c + 1..]) {
                        *entry -= factor * below;
                    }
                }
            }
            let inverse = pivot.recip();
            for entry in &mut column[1..] {
                *entry *= inverse;
            }
        }
        Ok(negative)
    }

    /// Solves with the factors, in place.
    pub fn solve(&self, x: &mut [f64]) {
        let height = self.height;
        for j in 0..self.order {
            let value = x[j];
            let column = &self.entries[j * height..][..height];
            for (entry, factor) in x[j + 1..].iter_mut().zip(&column[1..]) {
                *entry -= factor * value;
            }
        }
        for j in (0..self.order).rev() {
            let column = &self.entries[j * height..][..height];
            let below: f64 = x[j + 1..].iter().zip(&column[1..]).map(|(entry, factor)| entry * factor).sum();
            x[j] = x[j] / column[0] - below;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn solves_an_indefinite_banded_system_and_counts_negative_pivots() {
        let (order, bandwidth) = (23, 4);
        let mut dense = DMatrix::<f64>::zeros(order, order);
        let mut banded = Banded::new(order, bandwidth);
        for j in 0..order {
            for i in j..order.min(j + bandwidth + 1) {
                let value = ((7 * i + 3 * j) as f64).sin() + if i == j { 6.0 - i as f64 } else { 0.0 };
                banded.add(i, j, value);
                dense[(i, j)] = value;
                dense[(j, i)] = value;
            }
        }
        let right = DVector::from_fn(order, |i, _| (i as f64).cos());
        let negative = banded.factorise().unwrap();
        let mut x = right.clone();
        banded.solve(x.as_mut_slice());
        assert!((&dense * &x - &right).norm() < 1e-11);
        let expected = dense.symmetric_eigen().eigenvalues.iter().filter(|value| **value < 0.0).count();
        assert!(expected > 0);
        assert_eq!(negative, expected);
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let mut banded = Banded::new(2, 1);
        for (i, j) in [(0, 0), (1, 0), (1, 1)] {
            banded.add(i, j, 1.0);
        }
        assert_eq!(banded.factorise(), Err(ZeroPivot));
    }
}
