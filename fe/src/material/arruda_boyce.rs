use super::{InvariantDerivatives, InvariantEnergy};
use actuator::{ARRUDA_BOYCE, chain_stiffening};

/// Arruda and Boyce's eight chains, W = mu_c sum of C_i/lm^(2i - 2) (I1^i - 3^i), five terms (1993, eq. 17).
///
/// The series has no singularity at the locking stretch lm; beyond about 0.8 lm it is softer than the chains themselves.
///
/// Alone it is not at rest at F = 1: it is meant for incompressible rubber, inside [`super::Isochoric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrudaBoyce {
    /// mu_c C_i/lm^(2i - 2), Pa.
    factors: [f64; 5],
}

impl ArrudaBoyce {
    /// The energy of initial shear modulus mu (Pa; mu_c is less by [`chain_stiffening`]) and locking stretch lm.
    pub fn new(shear_modulus: f64, locking_stretch: f64) -> Self {
        let chains = shear_modulus / chain_stiffening(locking_stretch);
        let per_square = (locking_stretch * locking_stretch).recip();
        let factors = std::array::from_fn(|i| chains * ARRUDA_BOYCE[i] * per_square.powi(i as i32));
        ArrudaBoyce { factors }
    }
}

impl InvariantEnergy for ArrudaBoyce {
    const SECOND_INVARIANT: bool = false;

    #[inline]
    fn derivatives(&self, first: f64, _: f64) -> InvariantDerivatives {
        let [a, b, c, d, e] = self.factors;
        let x = first;
        // x^i - 3^i = (x - 3)(x^(i-1) + 3 x^(i-2) + ...), so that nothing cancels near rest.
        let (q2, x2) = (x + 3.0, x * x);
        let (q3, x3) = (x2 + 3.0 * q2, x2 * x);
        let (q4, x4) = (x3 + 3.0 * q3, x2 * x2);
        let q5 = x4 + 3.0 * q4;
        InvariantDerivatives {
            energy: (x - 3.0) * (a + b * q2 + c * q3 + d * q4 + e * q5),
            first: [a + 2.0 * b * x + 3.0 * c * x2 + 4.0 * d * x3 + 5.0 * e * x4, 0.0],
            second: [2.0 * b + 6.0 * c * x + 12.0 * d * x2 + 20.0 * e * x3, 0.0, 0.0],
        }
    }
}
