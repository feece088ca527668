//! Hyperelastic energies of rubbers: one file each, one test list for all.

mod arruda_boyce;
pub mod calibration;
mod eigen;
mod gent;
mod invariants;
mod isochoric;
mod linear_elastic;
mod mooney_rivlin;
mod neo_hookean;
mod ogden;
mod rubber;
mod st_venant_kirchhoff;
#[cfg(test)]
mod tests;
mod yeoh;

use nalgebra::{Matrix3, SMatrix};

pub use arruda_boyce::ArrudaBoyce;
pub use gent::Gent;
pub use invariants::{InvariantDerivatives, InvariantEnergy};
pub use isochoric::Isochoric;
pub use linear_elastic::LinearElastic;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean::NeoHookean;
pub use ogden::Ogden;
pub use rubber::Rubber;
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use yeoh::Yeoh;

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

impl Answer {
    /// The answer where there is none.
    const NAN: Answer = Answer {
        energy: f64::NAN,
        stress: Matrix3::from_array_storage(nalgebra::ArrayStorage([[f64::NAN; 3]; 3])),
        tangent: Tangent::from_array_storage(nalgebra::ArrayStorage([[f64::NAN; 9]; 9])),
    };
}

/// An elastomer whose stress derives from an energy W(F) of the deformation gradient F, with det F > 0.
///
/// Every energy here is zero at F = 1 and, [`LinearElastic`] apart, depends on the stretches only (objective, isotropic). Where
/// det F is not positive the answer may be NaN; the elements refuse such a state before they ask. Where a material cannot be
/// stretched so far ([`Gent`]) all numbers of the answer are NaN: a solver that meets them takes a shorter step.
pub trait Hyperelastic {
    /// Energy, stress and tangent together.
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer;

    /// The answer of W(J^(-1/3) F), J = det F, which does not answer to change of volume (see [`Isochoric`]).
    fn isochoric_answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        isochoric::by_chain_rule(self, deformation_gradient)
    }

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
