//! A model as its file holds it: plain lists, which become a model only after every length and number was checked.

use crate::{
    ErrorStatistics, FreeBarCoverage, FreeModel, InvalidModel, Model, ModelContent, ModuleModel, Provenance,
    SplineError, SplineGrid, TensorSpline,
    effect::{Chain, Effect, EffectKind},
    free_model::FreeFacts,
    interpolation::{from_coefficients, grid},
    module_model::{ModuleFacts, Tables},
    module_orbits::Orbits,
};
use actuator::Free;
use serde::{Deserialize, Serialize};

/// An effect by the names of its kind and its parameters, so that a file outlives their order in the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct EffectSetting {
    pub name: String,
    /// Names as the program prints them, values SI.
    pub parameters: Vec<(String, f64)>,
    pub frees: Vec<u32>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredSpline {
    pub nodes: Vec<Vec<f64>>,
    /// Coefficients, last axis fastest, outputs of a node together.
    pub coefficients: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is one of it, while a file is read or written")]
pub(crate) enum StoredContent {
    Free {
        facts: FreeFacts,
        scaled_reference: StoredSpline,
        states: StoredSpline,
        bars: Vec<f64>,
        coverage: FreeBarCoverage,
    },
    /// Tables of all nodes, or of the first of each orbit under the module's symmetry.
    Module { facts: ModuleFacts, nodes: Vec<Vec<f64>>, tables: Tables },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredModel {
    pub content: StoredContent,
    pub effects: Vec<EffectSetting>,
    pub provenance: Provenance,
}

fn nodes(grid: &SplineGrid) -> Vec<Vec<f64>> {
    grid.axes().iter().map(|axis| axis.nodes().to_vec()).collect()
}

impl StoredSpline {
    fn from_spline<const OUT: usize>(spline: &TensorSpline<OUT>) -> Self {
        StoredSpline {
            nodes: nodes(spline.grid()),
            coefficients: spline.coefficients().as_flattened().to_vec(),
        }
    }

    pub(crate) fn into_spline<const OUT: usize>(self) -> Result<TensorSpline<OUT>, SplineError> {
        from_coefficients(self.nodes, self.coefficients)
    }
}

impl From<&Effect> for EffectSetting {
    fn from(effect: &Effect) -> Self {
        let names = effect.kind.parameters().iter().map(|parameter| parameter.name.to_owned());
        EffectSetting {
            name: effect.kind.name().to_owned(),
            parameters: names.zip(effect.values.iter().copied()).collect(),
            frees: effect.frees.iter().map(|free| *free as u32).collect(),
        }
    }
}

impl TryFrom<EffectSetting> for Effect {
    type Error = InvalidModel;

    fn try_from(setting: EffectSetting) -> Result<Self, InvalidModel> {
        let Some(kind) = EffectKind::ALL.into_iter().find(|kind| kind.name() == setting.name) else {
            return Err(InvalidModel::UnknownEffect(setting.name));
        };
        let known: Vec<&str> = kind.parameters().iter().map(|parameter| parameter.name).collect();
        let found: Vec<&str> = setting.parameters.iter().map(|(name, _)| name.as_str()).collect();
        if known != found {
            let (found, expected) = (found.join(", "), known.join(", "));
            return Err(InvalidModel::EffectParameters { effect: setting.name, found, expected });
        }
        let values = setting.parameters.iter().map(|(_, value)| *value).collect();
        Ok(Effect { kind, frees: setting.frees.iter().map(|free| *free as usize).collect(), values })
    }
}

impl From<&Model> for StoredModel {
    fn from(model: &Model) -> Self {
        let content = match &model.content {
            ModelContent::Free(free) => StoredContent::Free {
                facts: free.facts().clone(),
                scaled_reference: StoredSpline::from_spline(free.splines().scaled_reference()),
                states: StoredSpline::from_spline(free.splines().states()),
                bars: free.splines().bars().as_flattened().to_vec(),
                coverage: free.bar_coverage(),
            },
            ModelContent::Module(module) => {
                let splines = module.splines();
                let whole = Tables::of(splines);
                // Of nodes that symmetry makes of each other one is kept, where that loses no bit.
                let orbits = Orbits::new(module.module(), splines.grid());
                let reduced = orbits.reduced(&whole);
                let tables = if orbits.spread(&reduced).as_ref() == Some(&whole) { reduced } else { whole };
                StoredContent::Module { facts: module.facts().clone(), nodes: nodes(splines.grid()), tables }
            }
        };
        StoredModel {
            content,
            effects: model.effects.effects.iter().map(EffectSetting::from).collect(),
            provenance: model.provenance.clone(),
        }
    }
}

fn check_free(free: &Free) -> Result<(), InvalidModel> {
    let tube = free.tube;
    let fibre = free.winding.fibre;
    let positive = [tube.length, tube.inner_radius, tube.wall, free.elastomer.shear_modulus()];
    let finite = [free.winding.angle_from_hoop(), fibre.axial_stiffness, fibre.diameter];
    if positive.iter().all(|value| value.is_finite() && *value > 0.0)
        && finite.iter().all(|value| value.is_finite())
    {
        Ok(())
    } else {
        Err(InvalidModel::Inconsistent("a FREE has a dimension that cannot be"))
    }
}

fn check_errors(statistics: &[ErrorStatistics]) -> Result<(), InvalidModel> {
    if statistics.iter().all(ErrorStatistics::is_sound) {
        Ok(())
    } else {
        Err(InvalidModel::Inconsistent("an error statistic is not a number"))
    }
}

fn check_module(facts: &ModuleFacts, grid: &SplineGrid, tables: &Tables) -> Result<(), InvalidModel> {
    let wrong = |problem| Err(InvalidModel::Inconsistent(problem));
    let frees = facts.module.frees.len();
    if [grid.axes().len(), facts.limits.pressure_max.len(), facts.limit_pressures.len()] != [frees; 3] {
        return wrong("it has not as many pressures as FREEs");
    }
    if Some(tables.slopes.len()) != tables.chart.len().checked_mul(facts.parameters.len()) {
        return wrong("it has not as many tables of slopes as parameters");
    }
    let (tip, base, limits) = (&facts.module.tip, &facts.module.base, &facts.limits);
    let numbers = [tip.plate_mass, tip.payload, base.free_mass, limits.pressure_rate, limits.idle_pressure];
    let finite = numbers
        .iter()
        .chain(&base.gravity)
        .chain(&limits.pressure_max)
        .chain(facts.module.frees.iter().flat_map(|placed| &placed.position))
        .chain(&facts.errors.worst_at)
        .all(|value| value.is_finite());
    if !finite {
        return wrong("a number of its module is not finite");
    }
    facts.module.frees.iter().try_for_each(|placed| check_free(&placed.free))?;
    check_errors(&[facts.errors.position, facts.errors.rotation])
}

fn check_free_facts(facts: &FreeFacts) -> Result<(), InvalidModel> {
    check_free(&facts.free)?;
    let errors = &facts.errors;
    if errors.worst_at.iter().flatten().any(|value| !value.is_finite()) {
        return Err(InvalidModel::Inconsistent("the place of its worst error is not a number"));
    }
    check_errors(&[errors.limit_pressure])?;
    [errors.held_out, errors.held_out_below_nine_tenths, errors.fitted]
        .iter()
        .try_for_each(|set| check_errors(&[set.axial_stretch, set.expansion, set.twist_per_length]))
}

impl TryFrom<StoredModel> for Model {
    type Error = InvalidModel;

    fn try_from(stored: StoredModel) -> Result<Self, InvalidModel> {
        let content = match stored.content {
            StoredContent::Free { facts, scaled_reference, states, bars, coverage } => {
                check_free_facts(&facts)?;
                ModelContent::Free(FreeModel::assemble(
                    facts,
                    scaled_reference.into_spline()?,
                    states.into_spline()?,
                    (bars, coverage),
                )?)
            }
            StoredContent::Module { facts, nodes, tables } => {
                let grid = grid(nodes)?;
                check_module(&facts, &grid, &tables)?;
                let orbits = Orbits::new(&facts.module, &grid);
                let is_reduced =
                    orbits.count() < grid.node_count() && tables.chart.len() == 6 * orbits.count();
                let tables = if is_reduced { orbits.spread(&tables) } else { Some(tables) };
                let tables =
                    tables.ok_or(InvalidModel::Inconsistent("its tables are not of its symmetry"))?;
                ModelContent::Module(ModuleModel::assemble(facts, grid, tables)?)
            }
        };
        let effects = stored.effects.into_iter().map(Effect::try_from).collect::<Result<_, _>>()?;
        let model = Model { content, effects: Chain { effects }, provenance: stored.provenance };
        model.effects.check(model.frees())?;
        Ok(model)
    }
}
