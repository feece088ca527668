//! A module's map as files of earlier format versions hold it.

use crate::{Limits, MapParameter, Module, ModuleCheck, ModuleMap, ModuleState, PoseChart};
use serde::Deserialize;

#[derive(Deserialize)]
struct State3 {
    chart: PoseChart,
    slopes: Vec<[f64; 6]>,
    negative_pivots: u32,
    residual: f64,
}

#[derive(Deserialize)]
struct Check3 {
    pressures: Vec<f64>,
    state: State3,
}

/// Of format versions 1 to 3: without the gap between FREEs.
#[derive(Deserialize)]
pub struct ModuleMapVersion3 {
    module: Module,
    limits: Limits,
    parameters: Vec<MapParameter>,
    pressures: Vec<Vec<f64>>,
    states: Vec<Option<State3>>,
    checks: Vec<Check3>,
    limit_pressures: Vec<Option<f64>>,
    settings: String,
    source: (String, String),
}

impl From<State3> for ModuleState {
    fn from(old: State3) -> Self {
        ModuleState {
            chart: old.chart,
            slopes: old.slopes,
            negative_pivots: old.negative_pivots,
            residual: old.residual,
            gap: None,
        }
    }
}

impl From<ModuleMapVersion3> for ModuleMap {
    fn from(old: ModuleMapVersion3) -> Self {
        let check = |old: Check3| ModuleCheck { pressures: old.pressures, state: old.state.into() };
        ModuleMap {
            module: old.module,
            limits: old.limits,
            parameters: old.parameters,
            pressures: old.pressures,
            states: old.states.into_iter().map(|state| state.map(ModuleState::from)).collect(),
            checks: old.checks.into_iter().map(check).collect(),
            limit_pressures: old.limit_pressures,
            settings: old.settings,
            source: old.source,
        }
    }
}
