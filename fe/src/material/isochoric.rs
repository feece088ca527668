use super::{Answer, Hyperelastic, flat};
use nalgebra::{Matrix3, SVector};

/// The shape-changing part of a material's energy, W(J^(-1/3) F) with J = det F: it answers to no change of volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isochoric<M>(
    /// The energy W.
    pub M,
);

impl<M: Hyperelastic> Hyperelastic for Isochoric<M> {
    #[inline]
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        self.0.isochoric_answer(deformation_gradient)
    }

    #[inline]
    fn isochoric_answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        self.0.isochoric_answer(deformation_gradient)
    }
}

fn flatten(matrix: &Matrix3<f64>) -> SVector<f64, 9> {
    SVector::from_fn(|index, _| matrix[(index / 3, index % 3)])
}

/// W(J^(-1/3) F) of any energy, by the chain rule.
pub(super) fn by_chain_rule<M: Hyperelastic + ?Sized>(material: &M, f: &Matrix3<f64>) -> Answer {
    let volume_ratio = f.determinant();
    let Some(inverse) = f.try_inverse().filter(|_| volume_ratio > 0.0) else { return Answer::NAN };
    // With Fb = J^(-1/3) F, h = F^-T, Pb and Ab the answers at Fb, s = Pb : F,
    //   P = J^(-1/3) (Pb - s/3 h)
    //   dP/dF = J^(-2/3) (Ab - (Ab F) h/3 - h (Ab F)/3 + (F Ab F) h h/9) + s/9 J^(-1/3) h h - J^(-1/3) (h Pb + Pb h + s dh/dF)/3,
    //   dh_ij/dF_kl = -h_il h_kj.
    let shrink = volume_ratio.cbrt().recip();
    let Answer { energy, stress: inner, tangent: inner_tangent } = material.answer(&(shrink * f));
    let h = inverse.transpose();
    let power = inner.dot(f);
    let stress = shrink * (inner - (power / 3.0) * h);

    let (f_flat, h_flat) = (flatten(f), flatten(&h));
    let along = inner_tangent * f_flat;
    let second = shrink * shrink;
    let mut tangent = second * inner_tangent;
    // The vector v with v h + h v = all the symmetric products of h with something.
    let beside: SVector<f64, 9> = (-second / 3.0) * along - (shrink / 3.0) * flatten(&inner)
        + (0.5 * (second * f_flat.dot(&along) + shrink * power) / 9.0) * h_flat;
    tangent.ger(1.0, &beside, &h_flat, 1.0);
    tangent.ger(1.0, &h_flat, &beside, 1.0);
    let turn = shrink * power / 3.0;
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                for l in 0..3 {
                    tangent[(flat(i, j), flat(k, l))] += turn * h[(i, l)] * h[(k, j)];
                }
            }
        }
    }
    Answer { energy, stress, tangent }
}
