//! Interpolation in the 27-node hexahedron and the tables that elements of the same undeformed shape share.

use super::SolidError;

/// Nodes of an element; also its integration points (3 x 3 x 3 Gauss points).
pub(crate) const NODES: usize = 27;
/// Rows of the tables: one for each integration point and reference direction.
pub(crate) const SLOPES: usize = 3 * NODES;

/// Places of the three Gauss points on [-1, 1] and their weights.
pub(crate) const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Quadratic Lagrange functions of the nodes -1, 0, 1 and their derivatives.
pub(crate) fn quadratic(x: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)], [x - 0.5, -2.0 * x, x + 0.5])
}

/// Functions and derivatives (by the three element coordinates) of the 27 nodes, first coordinate fastest.
pub(crate) fn interpolation(at: [f64; 3]) -> ([f64; NODES], [[f64; NODES]; 3]) {
    let [u, v, w] = at.map(quadratic);
    let mut values = [0.0; NODES];
    let mut slopes = [[0.0; NODES]; 3];
    for a in 0..NODES {
        let (i, j, k) = (a % 3, a / 3 % 3, a / 9);
        values[a] = u.0[i] * v.0[j] * w.0[k];
        slopes[0][a] = u.1[i] * v.0[j] * w.0[k];
        slopes[1][a] = u.0[i] * v.1[j] * w.0[k];
        slopes[2][a] = u.0[i] * v.0[j] * w.1[k];
    }
    (values, slopes)
}

/// What elements of one undeformed shape share, wherever they lie and however they are turned about the tube's axis.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    /// dN_a/dX_L at integration point g, 1/m: entry `(3 g + L) NODES + a`, X in the element's own frame.
    pub slopes: Vec<f64>,
    /// Weight times Jacobian of the integration points, m^3.
    pub weights: [f64; NODES],
    /// The four functions of the pressure at the integration points: 1 and the three coordinates X from the element's
    /// middle, over half its size. Linear in X, not in the element's coordinates: on distorted elements only that keeps the order.
    pub pressure: [[f64; 4]; NODES],
    /// `integral N_a dV` of each node, m^3.
    pub shares: [f64; NODES],
    /// Inverse of the matrix of `integral psi_p psi_q dV`, 1/m^3.
    pub pressure_metric: [[f64; 4]; 4],
}

/// Determinant and inverse of a 3 x 3 matrix.
fn inverse(m: [[f64; 3]; 3]) -> (f64, [[f64; 3]; 3]) {
    let cofactor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum::<f64>();
    (determinant, std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant)))
}

impl Shape {
    /// The tables of an element with nodes at `nodes` (m); `element` is its number for the error.
    pub fn new(nodes: &[[f64; 3]; NODES], element: usize) -> Result<Self, SolidError> {
        let mut slopes = vec![0.0; SLOPES * NODES];
        let mut weights = [0.0; NODES];
        let mut places = [[0.0; 3]; NODES];
        let mut shares = [0.0; NODES];
        let mut jacobians = [0.0; NODES];
        for g in 0..NODES {
            let at = [g % 3, g / 3 % 3, g / 9].map(|i| GAUSS[i]);
            let (values, local) = interpolation(at.map(|point| point.0));
            // Rows: dX_L/d xi_m.
            let mut jacobian = [[0.0; 3]; 3];
            for a in 0..NODES {
                for l in 0..3 {
                    places[g][l] += values[a] * nodes[a][l];
                    for m in 0..3 {
                        jacobian[l][m] += nodes[a][l] * local[m][a];
                    }
                }
            }
            let (determinant, to_local) = inverse(jacobian);
            jacobians[g] = determinant;
            weights[g] = at.iter().map(|point| point.1).product::<f64>() * determinant;
            for (share, value) in shares.iter_mut().zip(values) {
                *share += weights[g] * value;
            }
            for l in 0..3 {
                for a in 0..NODES {
                    slopes[(3 * g + l) * NODES + a] = (0..3).map(|m| local[m][a] * to_local[m][l]).sum();
                }
            }
        }
        let average = jacobians.iter().map(|value| value.abs()).sum::<f64>() / NODES as f64;
        let least = jacobians.iter().copied().fold(f64::INFINITY, f64::min);
        if !(average > 0.0 && least > 1e-6 * average) {
            return Err(SolidError::Degenerate { element, ratio: least / average });
        }
        let volume: f64 = weights.iter().sum();
        let middle: [f64; 3] =
            std::array::from_fn(|l| (0..NODES).map(|g| weights[g] * places[g][l]).sum::<f64>() / volume);
        let half = 0.5 * volume.cbrt();
        let pressure = places.map(|at| {
            [1.0, (at[0] - middle[0]) / half, (at[1] - middle[1]) / half, (at[2] - middle[2]) / half]
        });
        let mut metric = nalgebra::Matrix4::<f64>::zeros();
        for (psi, weight) in pressure.iter().zip(weights) {
            let psi = nalgebra::Vector4::from(*psi);
            metric += psi * psi.transpose() * weight;
        }
        let inverse = metric.try_inverse().ok_or(SolidError::Degenerate { element, ratio: 0.0 })?;
        Ok(Shape {
            slopes,
            weights,
            pressure,
            shares,
            pressure_metric: std::array::from_fn(|p| std::array::from_fn(|q| inverse[(p, q)])),
        })
    }

    /// Volume, m^3.
    pub fn volume(&self) -> f64 {
        self.weights.iter().sum()
    }
}
