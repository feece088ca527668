use nalgebra::{Matrix6, Vector6};

/// Inverse of a symmetric 6x6 block and the number of its negative pivots (the number of its negative eigenvalues, by
/// Sylvester's law).
pub(crate) struct InvertedBlock {
    pub inverse: Matrix6<f64>,
    pub negative: u32,
}

/// Rounds of scaling: each takes the root of what sets the rows' greatest elements apart from one.
const ROUNDS: usize = 4;
/// Greatest element of what is left of the scaled block that counts as zero: rounding leaves a few 1e-16.
const SINGULAR: f64 = 1e-14;
/// Share of the greatest element that a diagonal one must have to be a pivot alone, (1 + sqrt 17)/8: elements then grow least (Bunch & Parlett 1971).
const ALONE: f64 = 0.6404;

impl InvertedBlock {
    /// Of the symmetric part of a block: elimination multiplies what rounding adds to the other part by GA l^2/EI, and along a chain of
    /// n blocks by its power n, if it is let in. `None` when the block is singular or not finite.
    pub fn new(block: &Matrix6<f64>) -> Option<Self> {
        let block = &((block + block.transpose()) * 0.5);
        let scale = unit_rows(block)?;
        let scaled = block.component_mul(&(scale * scale.transpose()));
        let (inverse, negative) = sweep(scaled)?;
        Some(InvertedBlock { inverse: inverse.component_mul(&(scale * scale.transpose())), negative })
    }
}

/// Factors that bring the greatest element of every row of `s_i a_ij s_j` to about one, whatever the units of forces and moments. One
/// round does not: in an element of length l, shear couples GA/2 of a turn to GA/l of a shift, and beside GA/2 the turn's own GA l/4 + EI/l
/// is a length, so that a short element would look singular.
fn unit_rows(block: &Matrix6<f64>) -> Option<Vector6<f64>> {
    let mut scale = Vector6::repeat(1.0);
    for _ in 0..ROUNDS {
        let greatest =
            |i: usize| (0..6).map(|j| (block[(i, j)] * scale[j]).abs()).fold(0.0, f64::max) * scale[i];
        let next = Vector6::from_fn(|i, _| scale[i] / greatest(i).sqrt());
        scale = next;
    }
    scale.iter().all(|s| s.is_finite()).then_some(scale)
}

/// Gauss-Jordan elimination by the greatest of the diagonal elements left or, where they are small, by the pair of rows of the greatest
/// element, one of whose two eigenvalues is negative.
fn sweep(mut a: Matrix6<f64>) -> Option<(Matrix6<f64>, u32)> {
    let mut negative = 0;
    let mut left = [true; 6];
    while left.contains(&true) {
        let (mut alone, mut pair) = ((0, 0.0), (0, 0, 0.0));
        for i in (0..6).filter(|i| left[*i]) {
            if a[(i, i)].abs() > alone.1 {
                alone = (i, a[(i, i)].abs());
            }
            for j in (0..i).filter(|j| left[*j]) {
                if a[(i, j)].abs() > pair.2 {
                    pair = (i, j, a[(i, j)].abs());
                }
            }
        }
        if alone.1.max(pair.2) <= SINGULAR {
            return None;
        }
        if alone.1 >= ALONE * pair.2 {
            let (k, pivot) = (alone.0, a[(alone.0, alone.0)]);
            left[k] = false;
            negative += u32::from(pivot < 0.0);
            let (row, column) = (a.row(k) / pivot, a.column(k).clone_owned());
            a -= column * row;
            a.set_row(k, &row);
            a.set_column(k, &row.transpose());
            a[(k, k)] = -1.0 / pivot;
        } else {
            let (k, l, _) = pair;
            (left[k], left[l]) = (false, false);
            negative += 1;
            let (kk, kl, ll) = (a[(k, k)], a[(k, l)], a[(l, l)]);
            let determinant = kk * ll - kl * kl;
            let (on_k, on_l) = (a.column(k).clone_owned(), a.column(l).clone_owned());
            let row_k = (on_k * ll - on_l * kl).transpose() / determinant;
            let row_l = (on_l * kk - on_k * kl).transpose() / determinant;
            a -= on_k * row_k + on_l * row_l;
            for (index, row) in [(k, row_k), (l, row_l)] {
                a.set_row(index, &row);
                a.set_column(index, &row.transpose());
            }
            (a[(k, k)], a[(l, l)]) = (-ll / determinant, -kk / determinant);
            (a[(k, l)], a[(l, k)]) = (kl / determinant, kl / determinant);
        }
    }
    Some((-a, negative))
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

    /// Tip of an element of length l with a clamped base: its shift and turn are coupled by shear, GA/l, GA/2 and GA l/4 + EI/l. The turn
    /// alone has the compliance l/EI, however stiff it is in shear.
    #[test]
    fn a_short_element_stiff_in_shear_is_not_singular() {
        let torsion = 1.0;
        for shear in [1e1, 1e3, 1e5, 1e7, 1e9, 1e11] {
            for length in [1e-1, 1e-3, 1e-5] {
                // In units of EI.
                let (shift, both, turn) = (shear / length, 0.5 * shear, 0.25 * shear * length + 1.0 / length);
                let mut block =
                    Matrix6::from_diagonal(&Vector6::new(shift, shift, shift, turn, turn, torsion));
                for (i, j, sign) in [(0, 4, 1.0), (1, 3, -1.0)] {
                    (block[(i, j)], block[(j, i)]) = (sign * both, sign * both);
                }
                // turn - both^2/shift = 1/l.
                let InvertedBlock { inverse, negative } = InvertedBlock::new(&block).unwrap();
                assert_eq!(negative, 0, "GA/EI {shear:e}, l {length:e}");
                let rounding = 1e-15 * shear * length * length;
                for i in [3, 4] {
                    assert!(
                        (inverse[(i, i)] / length - 1.0).abs() < 1e-13 + rounding,
                        "{shear:e} {length:e}"
                    );
                }
            }
        }
    }

    #[test]
    fn only_the_symmetric_part_counts() {
        let symmetric = symmetric(3.0) + Matrix6::identity();
        let rounding = Matrix6::from_fn(|i, j| 1e-3 * (i as f64 - j as f64));
        let [with, without] =
            [symmetric + rounding, symmetric].map(|block| InvertedBlock::new(&block).unwrap().inverse);
        assert!((with - without).amax() < 1e-13 * without.amax());
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
