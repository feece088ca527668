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

    /// Whether the law was made for this state. A law may answer a little beyond, so that Newton's method finds its way
    /// back; a converged state that is not covered is refused.
    fn covers(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> bool {
        self.respond(pressure, axial_stretch, twist_per_length).energy.is_finite()
    }

    /// Enclosed volume per reference length V = -dPhi/dp, m^2, at constant stretch and twist; by central differences unless a law
    /// knows better.
    fn volume(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> f64 {
        // 10 Pa of the some 1e4 in use: truncation (1e-3)^2, rounding 1e-16/1e-3.
        const STEP: f64 = 10.0;
        let [above, below] =
            [STEP, -STEP].map(|step| self.respond(pressure + step, axial_stretch, twist_per_length).energy);
        (below - above) / (2.0 * STEP)
    }

    /// dN/dp (m^2) and dM/dp (m^3) at constant stretch and twist; by central differences unless a law knows better.
    fn pressure_slopes(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> [f64; 2] {
        // 10 Pa of the some 1e4 in use: truncation (1e-3)^2, rounding 1e-16/1e-3.
        const STEP: f64 = 10.0;
        let [above, below] =
            [STEP, -STEP].map(|step| self.respond(pressure + step, axial_stretch, twist_per_length));
        [(above.force - below.force) / (2.0 * STEP), (above.torque - below.torque) / (2.0 * STEP)]
    }
}
