use crate::Free;
use serde::{Deserialize, Serialize};

/// What computed the states of a FREE's map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fidelity {
    /// The cross-section far from the caps.
    Section,
    /// The whole tube with its rigid caps.
    Solid {
        /// Elements through the wall, around and along, where they were given; `None` = by the rule that the map's settings tell.
        elements: Option<[u32; 3]>,
    },
}

/// What a solid's middle does, beside what the whole does from cap to cap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Middle {
    /// Axial stretch over the middle fifth of the length.
    pub axial_stretch: f64,
    /// Twist per reference length there, rad/m.
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
    /// Of a solid, what its middle does; `None` for a section, which is a middle.
    pub middle: Option<Middle>,
}

/// Why a pressure path has no state above its last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PathEnd {
    /// A limit point: the pressure cannot rise further. The last state of the path is the limit state.
    LimitPoint,
    /// The path was followed as far as the pressure (or deformation) asked for, and no limit point was met.
    Range,
}

/// The states of one FREE from zero pressure up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreePath {
    /// States by rising pressure; the first is at zero, the last is where the path ends.
    pub states: Vec<FreeState>,
    /// What the end is.
    pub end: PathEnd,
}

impl FreePath {
    /// Limit pressure, Pa, where one was met.
    pub fn limit_pressure(&self) -> Option<f64> {
        match self.end {
            PathEnd::LimitPoint => self.states.last().map(|state| state.pressure),
            PathEnd::Range => None,
        }
    }
}

/// Pressure-to-deformation map of a FREE over winding angle and shear modulus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreeMap {
    /// The FREE; its own angle and modulus are one point of the axes' space.
    pub free: Free,
    /// Winding angles from the hoop, rad, rising.
    pub winding_angles: Vec<f64>,
    /// Shear moduli, Pa, rising.
    pub shear_moduli: Vec<f64>,
    /// Pressures asked for, Pa, rising from zero. Paths hold these (as far as they exist) and further states up to their end.
    pub pressures: Vec<f64>,
    /// Paths, angle by angle, modulus fastest; `None` = not computed yet or not converged.
    pub paths: Vec<Option<FreePath>>,
    /// Paths at angles and moduli between the nodes, for the fit to be judged by and never to be fitted.
    pub checks: Vec<(Free, FreePath)>,
    /// What computed it.
    pub fidelity: Fidelity,
    /// Settings of the finite elements, in words.
    pub settings: String,
    /// Name and text of the description it was made from.
    pub source: (String, String),
}

impl FreeMap {
    /// The path at node (angle `i`, modulus `j`).
    pub fn path(&self, i: usize, j: usize) -> Option<&FreePath> {
        self.paths[i * self.shear_moduli.len() + j].as_ref()
    }

    /// Whether every node was computed.
    pub fn is_complete(&self) -> bool {
        self.paths.iter().all(Option::is_some)
    }
}
