use super::{Answer, Hyperelastic, Tangent, flat};
use nalgebra::Matrix3;

/// Hooke's law at small strain: W = lambda/2 (tr e)^2 + mu tr(e^2), e the symmetric part of F - 1.
///
/// For comparison with the other energies only: it is neither objective (a rotation by an angle strains it by 1 - cos of it) nor
/// aware of finite stretch; where bodies turn, the answer depends on the frames F is written in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic {
    /// Lame's first constant lambda, Pa.
    pub first_lame: f64,
    /// mu, Pa.
    pub shear_modulus: f64,
}

impl LinearElastic {
    /// The part that answers to change of shape only, W = mu |dev e|^2: lambda = -2/3 mu.
    pub fn deviatoric(shear_modulus: f64) -> Self {
        LinearElastic { first_lame: -2.0 / 3.0 * shear_modulus, shear_modulus }
    }
}

impl Hyperelastic for LinearElastic {
    #[inline]
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        let LinearElastic { first_lame: lambda, shear_modulus: mu } = *self;
        let displacement_gradient = deformation_gradient - Matrix3::identity();
        let strain = 0.5 * (displacement_gradient + displacement_gradient.transpose());
        let stress = 2.0 * mu * strain + Matrix3::from_diagonal_element(lambda * strain.trace());
        // lambda d_ij d_kl + mu (d_ik d_jl + d_il d_jk)
        let mut tangent = Tangent::zeros();
        for i in 0..3 {
            for j in 0..3 {
                tangent[(flat(i, i), flat(j, j))] += lambda;
                tangent[(flat(i, j), flat(i, j))] += mu;
                tangent[(flat(i, j), flat(j, i))] += mu;
            }
        }
        Answer { energy: 0.5 * stress.dot(&strain), stress, tangent }
    }
}
