use crate::Free;
use serde::{Deserialize, Serialize};

/// Constant loads on the closed ends of a FREE, beside the pressure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EndLoad {
    /// Axial force, N, positive when it pulls.
    pub force: f64,
    /// Torque about the axis, N m, positive like a positive twist.
    pub torque: f64,
}

impl EndLoad {
    /// No load.
    pub const NONE: EndLoad = EndLoad { force: 0.0, torque: 0.0 };

    /// A share of both.
    pub fn times(self, share: f64) -> Self {
        EndLoad { force: share * self.force, torque: share * self.torque }
    }
}

/// A FREE and what pulls and turns it: what a path of a map belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadedFree {
    /// The FREE.
    pub free: Free,
    /// The loads on its ends, present from zero pressure up.
    pub load: EndLoad,
}

impl From<Free> for LoadedFree {
    fn from(free: Free) -> Self {
        LoadedFree { free, load: EndLoad::NONE }
    }
}
