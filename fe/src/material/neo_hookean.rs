use super::{Answer, Hyperelastic, Tangent};
use nalgebra::Matrix3;

/// W = mu/2 (F : F - 3), the sum of the squared stretches.
///
/// Alone it is not at rest at F = 1 (P = mu 1): it is meant for incompressible rubber, inside [`super::Isochoric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    /// mu, Pa.
    pub shear_modulus: f64,
}

impl Hyperelastic for NeoHookean {
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        let mu = self.shear_modulus;
        Answer {
            energy: 0.5 * mu * (deformation_gradient.norm_squared() - 3.0),
            stress: mu * deformation_gradient,
            tangent: Tangent::from_diagonal_element(mu),
        }
    }
}
