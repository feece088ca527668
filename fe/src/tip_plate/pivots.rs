use nalgebra::{Matrix6, Vector6};

/// Inverse of a symmetric 6x6 block and the number of its negative pivots (the number of its negative eigenvalues, by
/// Sylvester's law).
pub(crate) struct InvertedBlock {
    pub inverse: Matrix6<f64>,
    pub negative: u32,
}

impl InvertedBlock {
    /// Sweeps the block, the largest remaining diagonal first; `None` when it is singular or not finite.
    pub fn new(block: &Matrix6<f64>) -> Option<Self> {
        // Forces and moments have different units: scale the diagonal to one.
        let scale = Vector6::from_fn(|i, _| 1.0 / block.row(i).amax().sqrt());
        if !scale.iter().all(|s| s.is_finite()) {
            return None;
        }
        let scaled = Matrix6::from_fn(|i, j| block[(i, j)] * scale[i] * scale[j]);
        let (inverse, negative) = sweep(scaled).or_else(|| by_eigenvalues(scaled))?;
        let inverse = Matrix6::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]);
        Some(InvertedBlock { inverse, negative })
    }
}

/// Gauss-Jordan elimination by diagonal pivots; `None` when a diagonal pivot is too small to be trusted.
fn sweep(mut a: Matrix6<f64>) -> Option<(Matrix6<f64>, u32)> {
    let mut negative = 0;
    let mut done = [false; 6];
    for _ in 0..6 {
        let (k, pivot) = (0..6)
            .filter(|i| !done[*i])
            .map(|i| (i, a[(i, i)]))
            .max_by(|(_, x), (_, y)| x.abs().total_cmp(&y.abs()))?;
        // Growth of the elements is bounded by the inverse of this, squared over the sweep.
        if pivot.is_nan() || pivot.abs() <= 1e-5 {
            return None;
        }
        done[k] = true;
        negative += u32::from(pivot < 0.0);
        let (row, column) = (a.row(k) / pivot, a.column(k).clone_owned());
        a -= column * row;
        a.set_row(k, &row);
        a.set_column(k, &row.transpose());
        a[(k, k)] = -1.0 / pivot;
    }
    Some((-a, negative))
}

/// The dear but safe way, for blocks whose diagonal pivots vanish without the block being singular.
fn by_eigenvalues(a: Matrix6<f64>) -> Option<(Matrix6<f64>, u32)> {
    let eigen = a.try_symmetric_eigen(1e-15, 1000)?;
    let smallest = eigen.eigenvalues.amin();
    if smallest.is_nan() || smallest <= 1e-14 {
        return None;
    }
    let negative = eigen.eigenvalues.iter().filter(|value| **value < 0.0).count() as u32;
    let v = eigen.eigenvectors;
    let inverse = v * Matrix6::from_diagonal(&eigen.eigenvalues.map(|value| 1.0 / value)) * v.transpose();
    Some((inverse, negative))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A symmetric matrix of numbers without a pattern, in [-1, 1].
    fn symmetric(seed: f64) -> Matrix6<f64> {
        let a = Matrix6::from_fn(|i, j| ((6 * i + j) as f64 * 78.233 + seed * 12.9898).sin() * 43758.5453)
            .map(|x| x.fract());
        (a + a.transpose()) * 0.5
    }

    #[test]
    fn inverse_and_inertia_match_the_eigenvalues() {
        for seed in 0..20 {
            // Mixed units: rows of very different size.
            let units = Matrix6::from_diagonal(&Vector6::new(1.0, 1.0, 1.0, 1e-4, 1e-4, 1e-4));
            let plain = symmetric(seed as f64) + Matrix6::identity() * (0.2 * seed as f64);
            let block = InvertedBlock::new(&(units * plain * units)).unwrap();
            let negative = plain.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
            assert_eq!(block.negative as usize, negative, "{seed}");
            let product = units * block.inverse * units * plain;
            assert!((product - Matrix6::identity()).amax() < 1e-8, "{seed}: {product}");
        }
    }

    #[test]
    fn a_zero_diagonal_is_no_obstacle_and_a_singular_block_is() {
        let mut block = Matrix6::zeros();
        for (i, j) in [(0, 3), (1, 4), (2, 5)] {
            block[(i, j)] = 2.0;
            block[(j, i)] = 2.0;
        }
        let inverted = InvertedBlock::new(&block).unwrap();
        assert_eq!(inverted.negative, 3);
        assert!((inverted.inverse * block - Matrix6::identity()).amax() < 1e-12);
        let mut singular = symmetric(1.0);
        let copy = singular.row(0) * 2.0;
        singular.set_row(1, &copy);
        singular.set_column(1, &copy.transpose());
        singular[(1, 1)] = 2.0 * copy[0];
        assert!(InvertedBlock::new(&singular).is_none());
        assert!(InvertedBlock::new(&Matrix6::zeros()).is_none());
        assert!(InvertedBlock::new(&(block * f64::NAN)).is_none());
    }
}
