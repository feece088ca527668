//! Hyperelastic energies of rubbers: one file each, one test list for all.

mod isochoric;
mod neo_hookean;
mod ogden;
#[cfg(test)]
mod tests;

use actuator::Elastomer;
use nalgebra::{Matrix3, SMatrix};

pub use isochoric::Isochoric;
pub use neo_hookean::NeoHookean;
pub use ogden::Ogden;

/// Second derivatives of an energy by the deformation gradient, Pa: entry `(3 i + j, 3 k + l)` is d2W/dF_ij dF_kl.
pub type Tangent = SMatrix<f64, 9, 9>;

/// Energy, stress and tangent at one deformation gradient.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// W, J per reference volume (Pa).
    pub energy: f64,
    /// First Piola-Kirchhoff stress P = dW/dF, Pa; rows are directions in the deformed body, columns in the reference body.
    pub stress: Matrix3<f64>,
    /// dP/dF, Pa, symmetric.
    pub tangent: Tangent,
}

/// An elastomer whose stress derives from an energy W(F) of the deformation gradient F, with det F > 0.
///
/// Every energy here depends on the stretches only (objective, isotropic) and is zero at F = 1. Where det F is not positive
/// the answer may be NaN; the elements refuse such a state before they ask.
pub trait Hyperelastic {
    /// Energy, stress and tangent together.
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer;

    /// W(F), J per reference volume.
    fn energy(&self, deformation_gradient: &Matrix3<f64>) -> f64 {
        self.answer(deformation_gradient).energy
    }

    /// P = dW/dF, Pa.
    fn first_piola_kirchhoff_stress(&self, deformation_gradient: &Matrix3<f64>) -> Matrix3<f64> {
        self.answer(deformation_gradient).stress
    }

    /// dP/dF, Pa.
    fn tangent(&self, deformation_gradient: &Matrix3<f64>) -> Tangent {
        self.answer(deformation_gradient).tangent
    }
}

/// Where F_ij stands in the rows and columns of a [`Tangent`].
pub(crate) const fn flat(i: usize, j: usize) -> usize {
    3 * i + j
}

/// The shape-changing part of an [`Elastomer`]'s energy: W(F/(det F)^(1/3)). Its volume is held by the element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rubber {
    /// Neo-Hookean.
    NeoHookean(Isochoric<NeoHookean>),
    /// One Ogden term, either form.
    Ogden(Isochoric<Ogden>),
}

impl From<Elastomer> for Rubber {
    fn from(elastomer: Elastomer) -> Self {
        match elastomer {
            Elastomer::NeoHookean { shear_modulus } => {
                Rubber::NeoHookean(Isochoric(NeoHookean { shear_modulus }))
            }
            Elastomer::Ogden { shear_modulus, alpha, form } => {
                Rubber::Ogden(Isochoric(Ogden::new(shear_modulus, alpha, form)))
            }
        }
    }
}

impl Hyperelastic for Rubber {
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        match self {
            Rubber::NeoHookean(material) => material.answer(deformation_gradient),
            Rubber::Ogden(material) => material.answer(deformation_gradient),
        }
    }
}
