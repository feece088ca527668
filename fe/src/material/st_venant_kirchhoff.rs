use super::{InvariantDerivatives, InvariantEnergy};

/// W = lambda/2 (tr E)^2 + mu tr(E^2) with Green's strain E = (C - 1)/2: Hooke's law for E and the second Piola-Kirchhoff stress.
///
/// It is at rest at F = 1 and may stand alone. Under compression it gives way: the nominal stress of a bar in uniaxial strain
/// has its extremum at the stretch 1/sqrt(3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StVenantKirchhoff {
    /// Lame's first constant lambda, Pa.
    pub first_lame: f64,
    /// mu, Pa.
    pub shear_modulus: f64,
}

impl InvariantEnergy for StVenantKirchhoff {
    const SECOND_INVARIANT: bool = true;

    #[inline]
    fn derivatives(&self, first: f64, second: f64) -> InvariantDerivatives {
        let StVenantKirchhoff { first_lame: lambda, shear_modulus: mu } = *self;
        // tr E = (I1 - 3)/2; tr E^2 = (tr C^2 - 2 I1 + 3)/4 with tr C^2 = I1^2 - 2 I2: with x = I1 - 3, y = I2 - 3 it is
        // (x^2 + 4 x - 2 y)/4.
        let (x, y) = (first - 3.0, second - 3.0);
        InvariantDerivatives {
            energy: 0.125 * lambda * x * x + 0.25 * mu * (x * x + 4.0 * x - 2.0 * y),
            first: [0.25 * lambda * x + mu * (0.5 * x + 1.0), -0.5 * mu],
            second: [0.25 * lambda + 0.5 * mu, 0.0, 0.0],
        }
    }
}
