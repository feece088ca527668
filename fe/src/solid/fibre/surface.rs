use super::trace::Piece;

/// Interpolation of a nine-point face at a point of a fibre; points around fastest, then along.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    pub values: [f64; 9],
    /// Derivatives along the piece, by its share from 0 to 1.
    pub slopes: [f64; 9],
}

fn lagrange(at: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * at * (at - 1.0), 1.0 - at * at, 0.5 * at * (at + 1.0)], [at - 0.5, -2.0 * at, at + 0.5])
}

impl SurfacePoint {
    /// At `share` (0 to 1) of a piece. A point of the face that has no part in it gets exact zeros.
    pub fn new(piece: &Piece, share: f64) -> Self {
        let [around, along] = piece.at(share);
        let [da, dz] = piece.direction();
        let ((na, sa), (nz, sz)) = (lagrange(around), lagrange(along));
        SurfacePoint {
            values: std::array::from_fn(|a| na[a % 3] * nz[a / 3]),
            slopes: std::array::from_fn(|a| sa[a % 3] * da * nz[a / 3] + na[a % 3] * sz[a / 3] * dz),
        }
    }

    /// Position, m, or derivative by the piece's share, for one of the two sets of factors.
    pub fn combine(factors: &[f64; 9], face: &[u32; 9], positions: &[[f64; 3]]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (factor, &point) in factors.iter().zip(face) {
            for (total, coordinate) in sum.iter_mut().zip(positions[point as usize]) {
                *total += factor * coordinate;
            }
        }
        sum
    }
}
