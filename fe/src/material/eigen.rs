use nalgebra::{Matrix3, Vector3};

/// Eigenvalues and orthonormal eigenvectors (columns) of a symmetric matrix, in no order, by Jacobi's rotations: exact to rounding for
/// close and equal eigenvalues too. Near the identity, where strains are, it takes two or three sweeps.
#[inline]
pub(crate) fn symmetric_eigen(matrix: &Matrix3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let mut a = *matrix;
    let mut n = Matrix3::identity();
    let size = a.norm_squared();
    for _ in 0..12 {
        let beside = a[(0, 1)].powi(2) + a[(0, 2)].powi(2) + a[(1, 2)].powi(2);
        // Eigenvalues are then wrong by the square of what is left.
        if beside.is_nan() || beside <= 1e-32 * size {
            break;
        }
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            if a[(p, q)] == 0.0 {
                continue;
            }
            let middle = 0.5 * (a[(q, q)] - a[(p, p)]);
            let tangent = a[(p, q)] / (middle.abs() + middle.hypot(a[(p, q)])) * middle.signum();
            let cosine = (1.0 + tangent * tangent).sqrt().recip();
            let sine = tangent * cosine;
            a[(p, p)] -= tangent * a[(p, q)];
            a[(q, q)] += tangent * a[(p, q)];
            let (x, y) = (a[(p, r)], a[(q, r)]);
            let (x, y) = (cosine * x - sine * y, sine * x + cosine * y);
            (a[(p, r)], a[(r, p)], a[(q, r)], a[(r, q)]) = (x, x, y, y);
            (a[(p, q)], a[(q, p)]) = (0.0, 0.0);
            for i in 0..3 {
                let (x, y) = (n[(i, p)], n[(i, q)]);
                (n[(i, p)], n[(i, q)]) = (cosine * x - sine * y, sine * x + cosine * y);
            }
        }
    }
    (a.diagonal(), n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_are_orthonormal_and_give_the_matrix_back() {
        let mut state = 5;
        let mut next = || 2.0 * crate::free_map::next_fraction(&mut state) - 1.0;
        for scale in [0.0, 1e-12, 1e-6, 1e-2, 1.0, 1e3] {
            for _ in 0..50 {
                let random = Matrix3::from_fn(|_, _| next());
                let matrix = Matrix3::identity() + (random + random.transpose()) * scale;
                let (values, vectors) = symmetric_eigen(&matrix);
                let size = matrix.norm();
                assert!((vectors * vectors.transpose() - Matrix3::identity()).norm() < 1e-14);
                let back = vectors * Matrix3::from_diagonal(&values) * vectors.transpose();
                assert!((back - matrix).norm() < 1e-14 * size, "{scale}: {:e}", (back - matrix).norm());
            }
        }
    }
}
