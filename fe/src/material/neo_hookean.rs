use super::{InvariantDerivatives, InvariantEnergy};

/// W = mu/2 (I1 - 3), with I1 = F : F the sum of the squared stretches.
///
/// Alone it is not at rest at F = 1 (P = mu 1): it is meant for incompressible rubber, inside [`super::Isochoric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    /// mu, Pa.
    pub shear_modulus: f64,
}

impl InvariantEnergy for NeoHookean {
    const SECOND_INVARIANT: bool = false;

    #[inline]
    fn derivatives(&self, first: f64, _: f64) -> InvariantDerivatives {
        let half = 0.5 * self.shear_modulus;
        InvariantDerivatives { energy: half * (first - 3.0), first: [half, 0.0], second: [0.0; 3] }
    }
}
