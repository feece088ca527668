use crate::{Fidelity, Free, FreeMap, FreePath, FreeState, PathEnd};
use serde::Deserialize;

#[derive(Deserialize)]
struct State {
    pressure: f64,
    axial_stretch: f64,
    expansion: f64,
    twist_per_length: f64,
    residual: f64,
}

#[derive(Deserialize)]
struct Path {
    states: Vec<State>,
    end: PathEnd,
}

/// A FREE's map as files of format version 1 hold it: of sections only.
#[derive(Deserialize)]
pub struct FreeMapVersion1 {
    free: Free,
    winding_angles: Vec<f64>,
    shear_moduli: Vec<f64>,
    pressures: Vec<f64>,
    paths: Vec<Option<Path>>,
    checks: Vec<(Free, Path)>,
    settings: String,
    source: (String, String),
}

impl From<Path> for FreePath {
    fn from(old: Path) -> Self {
        let states = old.states.into_iter().map(|state| FreeState {
            pressure: state.pressure,
            axial_stretch: state.axial_stretch,
            expansion: state.expansion,
            twist_per_length: state.twist_per_length,
            residual: state.residual,
            middle: None,
        });
        FreePath { states: states.collect(), end: old.end }
    }
}

impl From<FreeMapVersion1> for FreeMap {
    fn from(old: FreeMapVersion1) -> Self {
        FreeMap {
            free: old.free,
            winding_angles: old.winding_angles,
            shear_moduli: old.shear_moduli,
            pressures: old.pressures,
            paths: old.paths.into_iter().map(|path| path.map(FreePath::from)).collect(),
            checks: old.checks.into_iter().map(|(free, path)| (free, path.into())).collect(),
            fidelity: Fidelity::Section,
            settings: old.settings,
            source: old.source,
        }
    }
}
