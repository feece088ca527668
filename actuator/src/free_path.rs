use crate::FreeState;
use serde::{Deserialize, Serialize};

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
    /// States past the limit point, by rising enclosed volume and at first falling pressure, where they were asked for. At a
    /// given pressure they are not stable: a FREE gets there only if its volume is prescribed.
    pub beyond: Vec<FreeState>,
    /// Estimated error of the limit pressure that comes from the mesh, Pa, where a coarser mesh was asked.
    pub limit_error: Option<f64>,
}

impl FreePath {
    /// A path of solved states and nothing more.
    pub fn solved(states: Vec<FreeState>, end: PathEnd) -> Self {
        FreePath { states, end, beyond: Vec::new(), limit_error: None }
    }

    /// Limit pressure, Pa, where one was met.
    pub fn limit_pressure(&self) -> Option<f64> {
        match self.end {
            PathEnd::LimitPoint => self.states.last().map(|state| state.pressure),
            PathEnd::Range => None,
        }
    }
}
