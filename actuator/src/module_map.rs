use crate::{Limits, Module, PoseChart, grid_places};
use serde::{Deserialize, Serialize};

/// A quantity of the module that is known less well than its pressures, to which a map keeps its sensitivity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MapParameter {
    /// Mass m carried at the tip plate's centre, kg, beyond the description's own: the slope at m = 0.
    Payload,
    /// How the pose departs from that slope as m grows, by the factor [`payload_curvature`] in kg^2: a mass that hangs straightens a
    /// module the less the straighter it is.
    PayloadCurvature,
    /// Factor on the bending stiffness of every FREE, minus one.
    BendingStiffness,
}

/// The mass (kg) at which [`MapParameter::PayloadCurvature`] makes the pose exact.
pub const PAYLOAD_STEP: f64 = 0.05;

/// m^2/(1 + |m|/M), kg^2, with M = [`PAYLOAD_STEP`]: a parabola for small masses, a line for large ones, because a straightened
/// module does not bend back. The chart at a payload m is `chart + m slope(Payload) + payload_curvature(m) slope(PayloadCurvature)`.
pub fn payload_curvature(mass: f64) -> f64 {
    mass * mass / (1.0 + mass.abs() / PAYLOAD_STEP)
}

/// A converged equilibrium of a module.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModuleState {
    /// Tip pose in the chart that does not wrap.
    pub chart: PoseChart,
    /// Derivatives of the chart (in the order of [`PoseChart::to_array`]) with respect to each of [`ModuleMap::parameters`],
    /// from the finite elements' tangent at this state.
    pub slopes: Vec<[f64; 6]>,
    /// Number of negative pivots of the tangent: 0 = stable, more = buckled.
    pub negative_pivots: u32,
    /// Relative residual of the equilibrium.
    pub residual: f64,
    /// Least distance between the surfaces of two FREEs, m; negative where they overlap, since nothing keeps them apart: with contact the
    /// module would be somewhere else. `None` of a single FREE, or not known.
    pub gap: Option<f64>,
}

/// A state off the grid, for a fit to be judged by and never to be fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModuleCheck {
    /// Pressures, Pa.
    pub pressures: Vec<f64>,
    /// The equilibrium there.
    pub state: ModuleState,
}

/// Tip poses of a module over the pressures of its FREEs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModuleMap {
    /// The module.
    pub module: Module,
    /// Its limits.
    pub limits: Limits,
    /// Parameters whose slopes every state carries.
    pub parameters: Vec<MapParameter>,
    /// Grid of each FREE's pressure, Pa, rising from zero.
    pub pressures: Vec<Vec<f64>>,
    /// States over the grid, last FREE fastest; `None` = not computed yet or not converged.
    pub states: Vec<Option<ModuleState>>,
    /// States between the nodes.
    pub checks: Vec<ModuleCheck>,
    /// Limit pressure of each FREE alone, Pa, where it has one.
    pub limit_pressures: Vec<Option<f64>>,
    /// Settings of the finite elements, in words.
    pub settings: String,
    /// Name and text of the description it was made from.
    pub source: (String, String),
}

impl ModuleState {
    /// Whether it is an equilibrium that is not stable.
    pub fn is_buckled(&self) -> bool {
        self.negative_pivots > 0
    }

    /// Whether FREEs touch, and in truth would push each other away.
    pub fn is_in_contact(&self) -> bool {
        self.gap.is_some_and(|gap| gap < 0.0)
    }
}

impl ModuleMap {
    /// Number of grid nodes.
    pub fn node_count(&self) -> usize {
        self.pressures.iter().map(Vec::len).product()
    }

    /// Pressures (Pa) of a node.
    pub fn node_pressures(&self, node: usize) -> Vec<f64> {
        let places = grid_places(self.pressures.iter().map(Vec::len), node);
        places.into_iter().zip(&self.pressures).map(|(place, axis)| axis[place]).collect()
    }

    /// Whether every node was computed.
    pub fn is_complete(&self) -> bool {
        self.states.iter().all(Option::is_some)
    }
}
