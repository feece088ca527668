use super::{Answer, Hyperelastic, Tangent, flat};
use nalgebra::{ArrayStorage, Matrix3, SMatrix};

/// An energy W(I1, I2) of the first two invariants of C = F^T F, and its derivatives, Pa.
#[derive(Clone, Copy, Debug)]
pub struct InvariantDerivatives {
    /// W.
    pub energy: f64,
    /// dW/dI1, dW/dI2.
    pub first: [f64; 2],
    /// d2W/dI1dI1, d2W/dI1dI2, d2W/dI2dI2.
    pub second: [f64; 3],
}

/// An energy that depends on I1 = tr C and I2 = (I1^2 - tr C^2)/2 only.
pub trait InvariantEnergy {
    /// Whether it depends on I2; where it does not, the terms of I2 are not computed.
    const SECOND_INVARIANT: bool;

    /// W and its derivatives at (I1, I2).
    fn derivatives(&self, first: f64, second: f64) -> InvariantDerivatives;
}

impl<M: InvariantEnergy> Hyperelastic for M {
    #[inline]
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        let at = Invariants::new(deformation_gradient);
        let InvariantDerivatives { energy, first: [w1, w2], second: [w11, w12, w22] } =
            self.derivatives(at.first, at.second);
        let second = [[w11, w12, 0.0], [w12, w22, 0.0], [0.0; 3]];
        at.answer::<M>(energy, [w1, w2, 0.0], second)
    }

    #[inline]
    fn isochoric_answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        let at = Invariants::new(deformation_gradient);
        let j = at.volume_ratio;
        if j.is_nan() || j <= 0.0 {
            return Answer::NAN;
        }
        // With j1 = J^(-2/3), j2 = J^(-4/3), Ib1 = j1 I1, Ib2 = j2 I2:
        //   dIb1 = j1 dI1 - 2/3 Ib1 dJ/J,  d2Ib1 = j1 d2I1 - 2/3 j1 (dI1 dJ + dJ dI1)/J + 10/9 Ib1 dJ dJ/J^2 - 2/3 Ib1 d2J/J,
        //   dIb2 = j2 dI2 - 4/3 Ib2 dJ/J,  d2Ib2 = j2 d2I2 - 4/3 j2 (dI2 dJ + dJ dI2)/J + 28/9 Ib2 dJ dJ/J^2 - 4/3 Ib2 d2J/J.
        let shrink = j.cbrt().recip();
        let (j1, per_j) = (shrink * shrink, j.recip());
        let j2 = j1 * j1;
        let (first, second) = (j1 * at.first, j2 * at.second);
        let InvariantDerivatives { energy, first: [w1, w2], second: [w11, w12, w22] } =
            self.derivatives(first, second);
        let (a1, a2) = (-2.0 / 3.0 * first * per_j, -4.0 / 3.0 * second * per_j);
        let k11 = w11 * j1 * j1;
        let k12 = w12 * j1 * j2;
        let k22 = w22 * j2 * j2;
        let k13 = j1 * (w11 * a1 + w12 * a2 - 2.0 / 3.0 * per_j * w1);
        let k23 = j2 * (w12 * a1 + w22 * a2 - 4.0 / 3.0 * per_j * w2);
        let k33 = w11 * a1 * a1
            + 2.0 * w12 * a1 * a2
            + w22 * a2 * a2
            + per_j * per_j * (10.0 / 9.0 * w1 * first + 28.0 / 9.0 * w2 * second);
        let slopes = [w1 * j1, w2 * j2, w1 * a1 + w2 * a2];
        at.answer::<M>(energy, slopes, [[k11, k12, k13], [k12, k22, k23], [k13, k23, k33]])
    }
}

/// I1, I2 and J = det F of a deformation gradient, and what their derivatives are made of.
struct Invariants {
    /// F and C = F^T F by rows.
    f: [[f64; 3]; 3],
    c: [[f64; 3]; 3],
    /// dJ/dF, flat.
    cofactor: [f64; 9],
    first: f64,
    second: f64,
    volume_ratio: f64,
}

impl Invariants {
    #[inline]
    fn new(deformation_gradient: &Matrix3<f64>) -> Self {
        let f: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| deformation_gradient[(i, j)]));
        let c: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| f[0][i] * f[0][j] + f[1][i] * f[1][j] + f[2][i] * f[2][j])
        });
        let cofactor = std::array::from_fn(|index| {
            let (i, j) = (index / 3, index % 3);
            let (k, m, l, n) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            f[k][l] * f[m][n] - f[k][n] * f[m][l]
        });
        let volume_ratio = f[0][0] * cofactor[0] + f[0][1] * cofactor[1] + f[0][2] * cofactor[2];
        // I2 = |cof F|^2 is a sum of squares: nothing cancels, as it would in (I1^2 - tr C^2)/2.
        let second = cofactor.iter().map(|value| value * value).sum();
        Invariants { f, c, cofactor, first: c[0][0] + c[1][1] + c[2][2], second, volume_ratio }
    }

    /// Stress and tangent from W's derivatives by (I1, I2, J):
    /// P = sum of W_a dI_a, dP/dF = sum of W_ab dI_a dI_b + sum of W_a d2I_a.
    #[inline]
    fn answer<M: InvariantEnergy>(&self, energy: f64, slopes: [f64; 3], mut second: [[f64; 3]; 3]) -> Answer {
        let Invariants { f, c, cofactor, first, .. } = self;
        let [w1, w2, w3] = slopes;
        // dI1 = 2 F; dI2 = 2 (I1 F - F C).
        let mut by_first = [0.0; 9];
        let mut by_second = [0.0; 9];
        for i in 0..3 {
            for j in 0..3 {
                by_first[flat(i, j)] = 2.0 * f[i][j];
                if M::SECOND_INVARIANT {
                    let fc = f[i][0] * c[0][j] + f[i][1] * c[1][j] + f[i][2] * c[2][j];
                    by_second[flat(i, j)] = 2.0 * (first * f[i][j] - fc);
                }
            }
        }
        let mut stress = Matrix3::zeros();
        for i in 0..3 {
            for j in 0..3 {
                let at = flat(i, j);
                stress[(i, j)] = w1 * by_first[at] + w3 * cofactor[at];
                if M::SECOND_INVARIANT {
                    stress[(i, j)] += w2 * by_second[at];
                }
            }
        }

        // d2I1 = 2 d_ik d_jl; d2I2 = 4 F_ij F_kl + 2 I1 d_ik d_jl - 2 (d_ik C_jl + B_ik d_jl + F_il F_kj), B = F F^T: its first
        // part is W_2 dI1 dI1.
        if M::SECOND_INVARIANT {
            second[0][0] += w2;
        }
        let mut tangent = [[0.0; 9]; 9];
        for (column, entries) in tangent.iter_mut().enumerate() {
            let (g1, g2, g3) = (by_first[column], by_second[column], cofactor[column]);
            let mix = |a: usize| {
                let without = second[a][0] * g1 + second[a][2] * g3;
                if M::SECOND_INVARIANT { without + second[a][1] * g2 } else { without }
            };
            let (h1, h2, h3) = (mix(0), mix(1), mix(2));
            for row in 0..9 {
                entries[row] = by_first[row] * h1 + cofactor[row] * h3;
                if M::SECOND_INVARIANT {
                    entries[row] += by_second[row] * h2;
                }
            }
        }
        let diagonal = if M::SECOND_INVARIANT { 2.0 * (w1 + w2 * first) } else { 2.0 * w1 };
        for (index, column) in tangent.iter_mut().enumerate() {
            column[index] += diagonal;
        }
        if M::SECOND_INVARIANT {
            for i in 0..3 {
                for k in 0..3 {
                    let b = -2.0 * w2 * (f[i][0] * f[k][0] + f[i][1] * f[k][1] + f[i][2] * f[k][2]);
                    for j in 0..3 {
                        tangent[flat(i, j)][flat(k, j)] += b;
                        tangent[flat(j, i)][flat(j, k)] -= 2.0 * w2 * c[i][k];
                        for l in 0..3 {
                            tangent[flat(i, j)][flat(k, l)] -= 2.0 * w2 * f[i][l] * f[k][j];
                        }
                    }
                }
            }
        }
        // d2J/dF_ij dF_kl = e_ikm e_jln F_mn.
        for i in 0..3 {
            for j in 0..3 {
                let (k, m, l, n) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
                let column = &mut tangent[flat(i, j)];
                column[flat(k, l)] += w3 * f[m][n];
                column[flat(m, n)] += w3 * f[k][l];
                column[flat(k, n)] -= w3 * f[m][l];
                column[flat(m, l)] -= w3 * f[k][n];
            }
        }
        let tangent: Tangent = SMatrix::from_data(ArrayStorage(tangent));
        Answer { energy, stress, tangent }
    }
}
