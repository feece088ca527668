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

fn face_values([around, along]: [f64; 2]) -> [f64; 9] {
    let (na, nz) = (lagrange(around).0, lagrange(along).0);
    std::array::from_fn(|a| na[a % 3] * nz[a / 3])
}

/// Derivatives of the nine functions in a direction (around, along) of the face's coordinates.
pub(super) fn face_slopes([around, along]: [f64; 2], [da, dz]: [f64; 2]) -> [f64; 9] {
    let ((na, sa), (nz, sz)) = (lagrange(around), lagrange(along));
    std::array::from_fn(|a| sa[a % 3] * da * nz[a / 3] + na[a % 3] * sz[a / 3] * dz)
}

impl SurfacePoint {
    /// At `share` (0 to 1) of a piece. A point of the face that has no part in it gets exact zeros.
    pub fn new(piece: &Piece, share: f64) -> Self {
        let at = piece.at(share);
        SurfacePoint { values: face_values(at), slopes: face_slopes(at, piece.direction()) }
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
