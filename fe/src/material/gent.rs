use super::{InvariantDerivatives, InvariantEnergy};

/// W = -mu Jm/2 ln(1 - (I1 - 3)/Jm) (Gent 1996, eq. 3). Initial shear modulus mu.
///
/// The chains lock at I1 = 3 + Jm, where the stress is infinite. There and beyond all numbers of the answer are NaN: a solver
/// that steps so far must take a shorter step.
///
/// Alone it is not at rest at F = 1: it is meant for incompressible rubber, inside [`super::Isochoric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gent {
    /// mu, Pa.
    pub shear_modulus: f64,
    /// Jm.
    pub locking_invariant: f64,
}

impl InvariantEnergy for Gent {
    const SECOND_INVARIANT: bool = false;

    #[inline]
    fn derivatives(&self, first: f64, _: f64) -> InvariantDerivatives {
        let Gent { shear_modulus: mu, locking_invariant: jm } = *self;
        let share = (first - 3.0) / jm;
        let share = if share < 1.0 { share } else { f64::NAN };
        let left = 1.0 - share;
        let slope = 0.5 * mu / left;
        InvariantDerivatives {
            energy: -0.5 * mu * jm * (-share).ln_1p(),
            first: [slope, 0.0],
            second: [slope / (left * jm), 0.0, 0.0],
        }
    }
}
