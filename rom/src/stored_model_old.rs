//! Models as files of earlier formats hold them. Version 1: without error bars, and with the box of their grid as their domain. Version 2:
//! single FREEs without error bars.

use crate::{
    ErrorStatistics, InvalidModel, ModuleErrors, Provenance,
    free_model::FreeFacts,
    interpolation::grid,
    module_model::{ModuleFacts, Tables},
    stable_region::StableRegion,
    stored_model::{EffectSetting, StoredContent, StoredModel, StoredSpline},
};
use actuator::{Limits, MapParameter, Module};
use serde::Deserialize;

#[derive(Deserialize)]
struct Errors {
    position: ErrorStatistics,
    rotation: ErrorStatistics,
    worst_at: Vec<f64>,
    outside: usize,
    buckled: usize,
}

#[derive(Deserialize)]
struct Facts {
    module: Module,
    limits: Limits,
    parameters: Vec<MapParameter>,
    limit_pressures: Vec<Option<f64>>,
    /// Nodes whose state is unstable, rising.
    buckled: Vec<u64>,
    errors: Errors,
}

#[derive(Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is one of it, while a file is read")]
enum Content {
    Free { facts: FreeFacts, scaled_reference: StoredSpline, states: StoredSpline },
    Module { facts: Facts, chart: StoredSpline, slopes: Vec<Vec<f64>> },
}

#[derive(Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is one of it, while a file is read")]
enum ContentVersion2 {
    Free { facts: FreeFacts, scaled_reference: StoredSpline, states: StoredSpline },
    Module { facts: ModuleFacts, nodes: Vec<Vec<f64>>, tables: Tables },
}

/// A model of format version 2.
#[derive(Deserialize)]
pub(crate) struct StoredModelVersion2 {
    content: ContentVersion2,
    effects: Vec<EffectSetting>,
    provenance: Provenance,
}

impl From<StoredModelVersion2> for StoredModel {
    fn from(old: StoredModelVersion2) -> Self {
        let content = match old.content {
            ContentVersion2::Free { facts, scaled_reference, states } => {
                without_bars(facts, scaled_reference, states)
            }
            ContentVersion2::Module { facts, nodes, tables } => {
                StoredContent::Module { facts, nodes, tables }
            }
        };
        StoredModel { content, effects: old.effects, provenance: old.provenance }
    }
}

fn without_bars(facts: FreeFacts, scaled_reference: StoredSpline, states: StoredSpline) -> StoredContent {
    StoredContent::Free { facts, scaled_reference, states, bars: Vec::new(), coverage: Default::default() }
}

/// A model of format version 1.
#[derive(Deserialize)]
pub(crate) struct StoredModelVersion1 {
    content: Content,
    effects: Vec<EffectSetting>,
    provenance: Provenance,
}

impl TryFrom<StoredModelVersion1> for StoredModel {
    type Error = InvalidModel;

    fn try_from(old: StoredModelVersion1) -> Result<Self, InvalidModel> {
        let content = match old.content {
            Content::Free { facts, scaled_reference, states } => {
                without_bars(facts, scaled_reference, states)
            }
            Content::Module { facts, chart, slopes } => {
                let grid = grid(chart.nodes.clone())?;
                let mut stable = vec![true; grid.node_count()];
                for node in &facts.buckled {
                    let Some(stable) = usize::try_from(*node).ok().and_then(|node| stable.get_mut(node))
                    else {
                        return Err(InvalidModel::Inconsistent("its list of buckled nodes is none"));
                    };
                    *stable = false;
                }
                let tables = Tables {
                    chart: chart.coefficients,
                    slopes: slopes.concat(),
                    clearance: StableRegion::new(&grid, stable).clearance(&grid),
                    bars: Vec::new(),
                };
                let errors = ModuleErrors {
                    position: facts.errors.position,
                    rotation: facts.errors.rotation,
                    worst_at: facts.errors.worst_at,
                    outside: facts.errors.outside,
                    unstable: facts.errors.buckled,
                    ..ModuleErrors::default()
                };
                let unstable = facts.buckled.len() as u64;
                let Facts { module, limits, parameters, limit_pressures, .. } = facts;
                let facts = ModuleFacts { module, limits, parameters, limit_pressures, unstable, errors };
                StoredContent::Module { facts, nodes: chart.nodes, tables }
            }
        };
        Ok(StoredModel { content, effects: old.effects, provenance: old.provenance })
    }
}
