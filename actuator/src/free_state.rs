use serde::{Deserialize, Serialize};

/// What the middle of a FREE does, beside what the whole does from cap to cap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Middle {
    /// Axial stretch far from the caps; of a solid, over the middle fifth of the length.
    pub axial_stretch: f64,
    /// Twist per reference length there, rad/m.
    pub twist_per_length: f64,
}

/// Energy and stiffness of a FREE at a state, per reference length, as a rod needs them.
///
/// They belong to the enthalpy Phi(lambda, tau; p) = W - p V, whose derivatives N = dPhi/dlambda and M = dPhi/dtau are the net axial
/// force and torque on the closed ends. Twist, torque and coupling have the sign of the FREE's own hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectionConstants {
    /// Strain energy W of rubber and fibres, J/m.
    pub energy: f64,
    /// Enclosed volume V = -dPhi/dp, m^2 (m^3 per metre of reference length).
    pub volume: f64,
    /// [[dN/dlambda, dN/dtau], [dM/dlambda, dM/dtau]] at constant pressure: N, N m; N m, N m^2.
    pub stiffness: [[f64; 2]; 2],
    /// dN/dp (m^2) and dM/dp (m^3) at constant stretch and twist: minus the change of V with lambda and tau.
    pub pressure_slopes: [f64; 2],
}

/// Estimated error of a state that comes from the mesh: absolute values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshError {
    /// Of the axial stretch.
    pub axial_stretch: f64,
    /// Of the expansion.
    pub expansion: f64,
    /// Of the twist per reference length, rad/m.
    pub twist_per_length: f64,
}

/// A converged state of a FREE under gauge pressure: of a section, far from the caps; of a solid, from cap to cap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreeState {
    /// Gauge pressure, Pa.
    pub pressure: f64,
    /// Axial stretch lambda; of a solid, the distance of its caps over that at rest.
    pub axial_stretch: f64,
    /// Expansion b/B, with b the outer radius of equal area; of a solid, over the middle fifth of its length.
    pub expansion: f64,
    /// Twist per reference length, rad/m; sign of the FREE's own hand.
    pub twist_per_length: f64,
    /// Relative residual of the equilibrium, the state's evidence of convergence.
    pub residual: f64,
    /// What its middle does, where the values above are from cap to cap; `None` for a section, which is a middle.
    pub middle: Option<Middle>,
    /// Energy and stiffness, where they were computed.
    pub section: Option<SectionConstants>,
    /// What a coarser mesh says about the error, where one was asked.
    pub mesh_error: Option<MeshError>,
}

impl FreeState {
    /// Axial stretch, expansion and twist per reference length (rad/m).
    pub fn deformation(&self) -> [f64; 3] {
        [self.axial_stretch, self.expansion, self.twist_per_length]
    }
}
