/// What a piece of a FREE answers to curvature and shear, at one state of its section.
///
/// Energy per reference length beside the section's own: `B (kx^2 + ky^2)/2 + C (kx gx + ky gy) + G (gx^2 + gy^2)/2`, with the
/// curvatures k (rad/m) and the shear strains g per reference length. C is the coupling that a winding brings: it changes sign
/// with the hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BendingResponse {
    /// B (N m^2), C (N m), G (N).
    pub stiffness: [f64; 3],
    /// Their derivatives by the axial stretch and by the twist per length.
    pub slopes: [[f64; 3]; 2],
    /// Their second derivatives: twice by the stretch, by both, twice by the twist.
    pub curvatures: [[f64; 3]; 3],
}

/// The law of a FREE's bending and shear, for a right-handed winding; see [`crate::SectionLaw`].
pub trait BendingLaw: Send + Sync {
    /// Response at gauge pressure (Pa), axial stretch and twist per reference length (rad/m), of a piece with `ends` caps per
    /// reference length (1/m): none inside, one over its length for a piece next to a cap.
    fn respond(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64, ends: f64)
    -> BendingResponse;

    /// Response of a piece that may shear as it likes while it bends, as one that tilts in the holes of spacers: no coupling, the
    /// bending stiffness at no shear force and the shear stiffness at no moment.
    fn respond_tied(
        &self,
        pressure: f64,
        axial_stretch: f64,
        twist_per_length: f64,
        ends: f64,
    ) -> BendingResponse;
}

/// The same stiffness in every state: a bare, unpressurised tube's, or what a test wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantBending {
    /// EI, N m^2.
    pub bending: f64,
    /// Coupling, N m.
    pub coupling: f64,
    /// GA, N.
    pub shear: f64,
}

impl ConstantBending {
    /// 3 mu I and mu A of the undeformed wall, mu the initial shear modulus: no fibres, no pressure.
    pub fn of_bare_tube(free: &actuator::Free) -> Self {
        let mu = free.elastomer.initial_shear_modulus();
        let tube = free.tube;
        ConstantBending {
            bending: 3.0 * mu * tube.second_moment(),
            coupling: 0.0,
            shear: mu * tube.wall_area(),
        }
    }
}

impl BendingLaw for ConstantBending {
    fn respond(&self, _: f64, _: f64, _: f64, _: f64) -> BendingResponse {
        BendingResponse { stiffness: [self.bending, self.coupling, self.shear], ..BendingResponse::default() }
    }

    fn respond_tied(&self, _: f64, _: f64, _: f64, _: f64) -> BendingResponse {
        let released = 1.0 - self.coupling * self.coupling / (self.bending * self.shear);
        BendingResponse {
            stiffness: [self.bending * released, 0.0, self.shear * released],
            ..BendingResponse::default()
        }
    }
}
