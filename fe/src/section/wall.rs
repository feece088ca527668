use super::{
    SectionError, SectionSolver,
    solver::{Third, check},
};

/// Strain energy of a section at a given enclosed volume, stretch and twist, per reference length.
///
/// Unlike the response at a given pressure it has no limit: a wall that would balloon under a pressure is at rest at any volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallResponse {
    /// W, J/m.
    pub energy: f64,
    /// dW/dV = the pressure (Pa), dW/dlambda (N), dW/dtau (N m).
    pub gradient: [f64; 3],
    /// Second derivatives in the same order, SI.
    pub hessian: [[f64; 3]; 3],
}

impl SectionSolver {
    /// Response at an enclosed volume per reference length (m^2), axial stretch and twist per reference length (rad/m), for a right-handed
    /// winding.
    ///
    /// # Errors
    /// [`SectionError::NotConverged`] where no equilibrium is found. The solver stays usable.
    pub fn respond_at_volume(
        &mut self,
        volume: f64,
        axial_stretch: f64,
        twist_per_length: f64,
    ) -> Result<WallResponse, SectionError> {
        check("volume", volume, volume > 0.0, "an enclosed volume per length is positive, in m^2")?;
        check("axial_stretch", axial_stretch, axial_stretch > 0.0, "a stretch is positive")?;
        let finite = twist_per_length.is_finite();
        check("twist_per_length", twist_per_length, finite, "it must be a number, in rad/m")?;
        let (b, mu) = (self.units.length, self.units.stress);
        let target = [axial_stretch, twist_per_length * b, volume / (b * b)];
        let schur = self.reach(target, Third::Volume).map_err(|failed| {
            let globals = [target[0], target[1], f64::NAN];
            SectionError::NotConverged {
                target: self.units.whereabouts(&globals),
                residual: failed.residual,
                last_good: self.units.whereabouts(&self.state.globals),
            }
        })?;
        let system = &self.newton.system;
        let pressure = self.state.globals[2];
        let [force, torque] = system.global_residual;
        // Phi(lambda, psi, p) = min (W - p V) has the Schur complement S for its second derivatives, and V = -Phi_p: with p(V, ..)
        // W_VV = -1/S_pp, W_Vi = -S_ip/S_pp, W_ij = S_ij - S_ip S_jp/S_pp.
        let inverse = 1.0 / schur[(2, 2)];
        let by_volume = [-inverse, -schur[(0, 2)] * inverse, -schur[(1, 2)] * inverse];
        let at_volume = |i: usize, j: usize| schur[(i, j)] - schur[(i, 2)] * schur[(j, 2)] * inverse;
        let second = [
            by_volume,
            [by_volume[1], at_volume(0, 0), at_volume(0, 1)],
            [by_volume[2], at_volume(1, 0), at_volume(1, 1)],
        ];
        // W has the unit mu B^2, and the variables B^2, 1, 1/B.
        let (line, units) = (mu * b * b, [b * b, 1.0, 1.0 / b]);
        let gradient = [pressure, force, torque];
        Ok(WallResponse {
            energy: line * (system.energy + pressure * target[2]),
            gradient: std::array::from_fn(|i| line * gradient[i] / units[i]),
            hessian: std::array::from_fn(|i| {
                std::array::from_fn(|j| line * second[i][j] / (units[i] * units[j]))
            }),
        })
    }
}
