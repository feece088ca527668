use super::{InvariantDerivatives, InvariantEnergy};

/// W = c10 (I1 - 3) + c01 (I2 - 3) (Mooney 1940; Rivlin 1948). Initial shear modulus 2 (c10 + c01).
///
/// Alone it is not at rest at F = 1: it is meant for incompressible rubber, inside [`super::Isochoric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MooneyRivlin {
    /// c10, Pa.
    pub c10: f64,
    /// c01, Pa.
    pub c01: f64,
}

impl InvariantEnergy for MooneyRivlin {
    const SECOND_INVARIANT: bool = true;

    #[inline]
    fn derivatives(&self, first: f64, second: f64) -> InvariantDerivatives {
        let MooneyRivlin { c10, c01 } = *self;
        let energy = c10 * (first - 3.0) + c01 * (second - 3.0);
        InvariantDerivatives { energy, first: [c10, c01], second: [0.0; 3] }
    }
}
