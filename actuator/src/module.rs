use crate::Free;
use serde::{Deserialize, Serialize};

/// A FREE and where its axis stands on the plates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedFree {
    /// The FREE.
    pub free: Free,
    /// Position of its axis on both plates, m, in the plate's frame.
    pub position: [f64; 2],
}

/// The rigid plate that closes a module.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tip {
    /// Mass of the plate, kg.
    pub plate_mass: f64,
    /// Mass carried by the plate, at its centre, kg.
    pub payload: f64,
    /// Which of x, y, z, rx, ry, rz may move; a guided tip has fewer.
    pub free_dof: [bool; 6],
}

/// What the module stands on or hangs from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Base {
    /// Unit vector of gravity in the base frame (+z: the module hangs); zero where gravity is not considered.
    pub gravity: [f64; 3],
    /// Mass of each FREE, kg, spread along it.
    pub free_mass: f64,
}

/// What the supply and the operator allow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Greatest gauge pressure of each FREE, Pa.
    pub pressure_max: Vec<f64>,
    /// Greatest rate of a pressure, Pa/s.
    pub pressure_rate: f64,
    /// Least pressure kept in every FREE, Pa (keeps idle FREEs from buckling).
    pub idle_pressure: f64,
}

/// Several FREEs between two rigid plates, both ends clamped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Module {
    /// The FREEs in the order of their pressures.
    pub frees: Vec<PlacedFree>,
    /// The moving plate.
    pub tip: Tip,
    /// The fixed plate.
    pub base: Base,
    /// Number of rigid, weightless spacers, evenly spaced, that tie all FREEs together between the plates: between two of them
    /// each FREE has constant strain. Zero: every FREE goes its own way from plate to plate, and may sway and buckle.
    pub spacers: u32,
}

impl Module {
    /// Reference length of the module, m: the mean length of its FREEs; scale of relative errors and of the pose chart.
    pub fn length(&self) -> f64 {
        self.frees.iter().map(|placed| placed.free.tube.length).sum::<f64>() / self.frees.len() as f64
    }
}
