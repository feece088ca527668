use super::{InvariantDerivatives, InvariantEnergy};

/// W = c10 (I1 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3 (Yeoh 1990). Initial shear modulus 2 c10.
///
/// Alone it is not at rest at F = 1: it is meant for incompressible rubber, inside [`super::Isochoric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yeoh {
    /// c10, Pa.
    pub c10: f64,
    /// c20, Pa.
    pub c20: f64,
    /// c30, Pa.
    pub c30: f64,
}

impl InvariantEnergy for Yeoh {
    const SECOND_INVARIANT: bool = false;

    #[inline]
    fn derivatives(&self, first: f64, _: f64) -> InvariantDerivatives {
        let Yeoh { c10, c20, c30 } = *self;
        let x = first - 3.0;
        InvariantDerivatives {
            energy: x * (c10 + x * (c20 + x * c30)),
            first: [c10 + x * (2.0 * c20 + x * 3.0 * c30), 0.0],
            second: [2.0 * c20 + 6.0 * c30 * x, 0.0, 0.0],
        }
    }
}
