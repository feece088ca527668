use nalgebra::{DMatrix, SymmetricEigen};

use super::factorisation::Factorisation;

/// Blocks of a Krylov space before it is restarted from its best vectors, and restarts before giving up.
const DEPTH: usize = 6;
const RESTARTS: usize = 60;

/// Relative error of an eigenvalue at which it counts as found.
const ACCURACY: f64 = 1e-9;

/// An eigenpair `K v = value M v`.
#[derive(Debug, Clone)]
pub(crate) struct Mode {
    pub value: f64,
    /// `v` with `v^T M v = 1`.
    pub vector: Vec<f64>,
    /// Bound on the relative error of `value`, and of the order of the vector's error times the relative gap to the next value.
    pub error: f64,
}

/// A tangent that has been factorised.
pub(crate) trait Inverse {
    /// Scalar unknowns.
    fn dimension(&self) -> usize;

    /// Solves for any number of right-hand sides, one column after the other, in place.
    fn solve(&mut self, columns: &mut [f64]);
}

impl Inverse for Factorisation {
    fn dimension(&self) -> usize {
        Factorisation::dimension(self)
    }

    fn solve(&mut self, columns: &mut [f64]) {
        Factorisation::solve(self, columns);
    }
}

/// The modes of smallest |eigenvalue|, negative ones included, the smallest first: fewer than `count` only if K is
/// smaller. `metric` is the diagonal of M, positive; without it M = 1.
///
/// Block Krylov spaces of `M^1/2 K^-1 M^1/2`, fully orthogonalised and restarted (a block, as at the buckling of a tube
/// eigenvalues come in pairs). Gives what it has after a fixed number of restarts: look at `error`.
///
/// # Panics
/// If the last `factorise` failed, or the metric is not positive or of another length.
pub(crate) fn lowest_modes(inverse: &mut impl Inverse, count: usize, metric: Option<&[f64]>) -> Vec<Mode> {
    let dimension = inverse.dimension();
    let root: Vec<f64> = match metric {
        Some(metric) => {
            assert!(metric.len() == dimension && metric.iter().all(|&m| m > 0.0), "a metric is positive");
            metric.iter().map(|m| m.sqrt()).collect()
        }
        None => vec![1.0; dimension],
    };
    let count = count.min(dimension);
    if count == 0 {
        return Vec::new();
    }
    let block = (count + 2).min(dimension);

    let mut start = Vec::new();
    let mut noise = Noise(0x9E37_79B9_7F4A_7C15);
    let mut modes = Vec::new();
    for _ in 0..RESTARTS {
        // Basis Q and its image S Q, block by block; the image, orthogonalised, is the next block.
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut images: Vec<Vec<f64>> = Vec::new();
        for _ in 0..DEPTH {
            let old = basis.len();
            let candidates =
                if old == 0 { std::mem::take(&mut start) } else { images[old - block.min(old)..].to_vec() };
            for candidate in candidates {
                extend(&mut basis, candidate);
            }
            while basis.len() < block {
                extend(&mut basis, (0..dimension).map(|_| noise.next()).collect());
            }
            if basis.len() == old {
                break;
            }
            let mut columns: Vec<f64> = Vec::with_capacity((basis.len() - old) * dimension);
            for vector in &basis[old..] {
                columns.extend(vector.iter().zip(&root).map(|(x, m)| x * m));
            }
            inverse.solve(&mut columns);
            images.extend(columns.chunks_exact(dimension).map(|column| scaled(column, &root)));
        }

        let size = basis.len();
        let projected = DMatrix::from_fn(size, size, |i, j| {
            0.5 * (dot(&basis[i], &images[j]) + dot(&basis[j], &images[i]))
        });
        let eigen = SymmetricEigen::new(projected);
        let mut largest: Vec<usize> = (0..size).collect();
        largest.sort_by(|&a, &b| eigen.eigenvalues[b].abs().total_cmp(&eigen.eigenvalues[a].abs()));
        modes.clear();
        for &k in &largest[..block] {
            let theta = eigen.eigenvalues[k];
            let coefficients = eigen.eigenvectors.column(k);
            let vector = combination(&basis, coefficients.as_slice());
            let image = combination(&images, coefficients.as_slice());
            let residual =
                image.iter().zip(&vector).map(|(s, q)| (s - theta * q).powi(2)).sum::<f64>().sqrt();
            if modes.len() < count {
                let physical = vector.iter().zip(&root).map(|(q, m)| q / m).collect();
                modes.push(Mode { value: 1.0 / theta, vector: physical, error: residual / theta.abs() });
            }
            start.push(vector);
        }
        if modes.iter().all(|mode| mode.error <= ACCURACY) {
            break;
        }
    }
    modes
}

/// Orthonormalises a vector against the basis and appends it, unless nothing new is left of it.
fn extend(basis: &mut Vec<Vec<f64>>, mut vector: Vec<f64>) {
    let length = dot(&vector, &vector).sqrt();
    // Twice is enough (Kahan, in Parlett 1980).
    for _ in 0..2 {
        for other in &*basis {
            let component = dot(&vector, other);
            for (x, q) in vector.iter_mut().zip(other) {
                *x -= component * q;
            }
        }
    }
    let left = dot(&vector, &vector).sqrt();
    if left > 1e-12 * length {
        vector.iter_mut().for_each(|x| *x /= left);
        basis.push(vector);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn scaled(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

fn combination(vectors: &[Vec<f64>], coefficients: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; vectors[0].len()];
    for (vector, &coefficient) in vectors.iter().zip(coefficients) {
        for (sum, x) in sum.iter_mut().zip(vector) {
            *sum += coefficient * x;
        }
    }
    sum
}

/// Start vectors: the same at each call (xorshift, Marsaglia 2003).
struct Noise(u64);

impl Noise {
    /// Between -1/2 and 1/2.
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}
