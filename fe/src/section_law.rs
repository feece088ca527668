/// Answer of a FREE's cross-section to a given stretch and twist under pressure, per reference length.
///
/// `energy` is the enthalpy Phi = W - p V with W the strain energy and V the enclosed volume, both per reference length, so that
/// the generalised forces are the *net* ones: zero on a FREE with a free, closed end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SectionResponse {
    /// Phi, J/m.
    pub energy: f64,
    /// N = dPhi/dlambda, N.
    pub force: f64,
    /// M = dPhi/dtau, N m.
    pub torque: f64,
    /// Second derivatives [[d2Phi/dlambda2, d2Phi/dlambda dtau], [.., d2Phi/dtau2]]: N, N m, N m^2.
    pub stiffness: [[f64; 2]; 2],
}

/// The law of a FREE's cross-section, as a rod needs it: for a right-handed winding; a left-handed FREE is its mirror image
/// (`tau -> -tau`, torque and coupling change sign).
pub trait SectionLaw: Send + Sync {
    /// Response at gauge pressure (Pa), axial stretch and twist per reference length (rad/m).
    fn respond(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> SectionResponse;
}
