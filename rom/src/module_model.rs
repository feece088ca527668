use crate::{
    ModuleErrors, ModuleFitError, OutOfDomain, PoseEvaluation, PoseModel, SplineGrid, effect::hanging_mass,
};
use actuator::{Limits, MapParameter, Module, PAYLOAD_STEP, PoseChart};
use evaluator::{LoadParameter, MAX_PARAMETERS, ModuleSplines, TipModel};
use serde::{Deserialize, Serialize};

/// Fraction of a FREE's own limit pressure that a model leaves unused: near the limit the slopes grow without bound.
pub const LIMIT_MARGIN: f64 = 0.02;

/// What of a module model is not a spline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModuleFacts {
    pub module: Module,
    pub limits: Limits,
    pub parameters: Vec<MapParameter>,
    pub limit_pressures: Vec<Option<f64>>,
    /// Number of nodes that are unstable or missing.
    pub unstable: u64,
    pub errors: ModuleErrors,
}

/// The tables of a module's model on one grid, see [`ModuleSplines`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tables {
    pub chart: Vec<f64>,
    pub slopes: Vec<f64>,
    pub clearance: Vec<f64>,
    pub bars: Vec<f64>,
}

impl Tables {
    /// The tables of splines.
    pub fn of(splines: &ModuleSplines<f64, Vec<f64>>) -> Self {
        let slopes = (0..splines.parameters()).flat_map(|parameter| splines.slopes(parameter));
        Tables {
            chart: splines.chart().as_flattened().to_vec(),
            slopes: slopes.flatten().copied().collect(),
            clearance: splines.clearances().to_vec(),
            bars: splines.bars().as_flattened().to_vec(),
        }
    }
}

/// Pressures of a module to its tip pose: splines over the pressures, fitted from an [`actuator::ModuleMap`].
///
/// The pose is held in the chart that does not wrap. The domain is the box of the map's grid, at most
/// (1 - [`LIMIT_MARGIN`]) of each FREE's own limit pressure, less what lies at or beyond the boundary of the stable states.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleModel {
    facts: ModuleFacts,
    splines: ModuleSplines<f64, Vec<f64>>,
}

impl ModuleModel {
    /// Puts the parts together and works out the domain.
    pub(crate) fn assemble(
        facts: ModuleFacts,
        grid: SplineGrid,
        tables: Tables,
    ) -> Result<Self, ModuleFitError> {
        let mut domain = Vec::with_capacity(facts.limit_pressures.len());
        for (free, (axis, limit)) in grid.axes().iter().zip(&facts.limit_pressures).enumerate() {
            let (lower, mut upper) = axis.range();
            if let Some(limit) = *limit {
                // A limit that is not a number leaves no domain either.
                let usable = (1.0 - LIMIT_MARGIN) * limit;
                if usable.is_nan() || usable < lower {
                    return Err(ModuleFitError::NoDomain { free, limit, lower });
                }
                upper = upper.min(usable);
            }
            domain.push((lower, upper));
        }
        let Tables { chart, slopes, clearance, bars } = tables;
        let splines = ModuleSplines::new(grid, (chart, slopes), domain, (clearance, bars))
            .map_err(|problem| ModuleFitError::Inconsistent { problem })?;
        Ok(ModuleModel { facts, splines })
    }

    /// The splines, as a controller evaluates them.
    pub fn splines(&self) -> &ModuleSplines<f64, Vec<f64>> {
        &self.splines
    }

    /// What the slopes are along, as the evaluator calls it.
    pub(crate) fn load_parameters(&self) -> impl Iterator<Item = LoadParameter> {
        self.facts.parameters.iter().map(|parameter| match parameter {
            MapParameter::Payload => LoadParameter::Payload,
            MapParameter::PayloadCurvature => LoadParameter::PayloadCurvature,
            MapParameter::BendingStiffness => LoadParameter::BendingStiffness,
        })
    }

    /// The model as a controller evaluates it with effects, with tables of its own.
    pub fn tip_model(&self) -> TipModel<f64, Vec<f64>> {
        let mut parameters = [None; MAX_PARAMETERS];
        for (place, parameter) in parameters.iter_mut().zip(self.load_parameters()) {
            *place = Some(parameter);
        }
        TipModel {
            splines: self.splines.clone(),
            parameters,
            hanging_mass: hanging_mass(self.module()),
            payload_step: PAYLOAD_STEP,
        }
    }

    /// The same model with error bars and what was found of its errors.
    pub(crate) fn with_errors(mut self, bars: Option<Vec<[f64; 2]>>, errors: ModuleErrors) -> Self {
        if let Some(bars) = bars {
            self.splines.set_bars(bars.into_flattened());
        }
        self.facts.errors = errors;
        self
    }

    /// Room for an evaluation of this model.
    pub fn workspace(&self) -> PoseEvaluation {
        PoseEvaluation::new(self.splines.domain().len(), self.splines.parameters())
    }

    /// The module.
    pub fn module(&self) -> &Module {
        &self.facts.module
    }

    /// Its limits; the greatest pressures may lie above the model's domain.
    pub fn limits(&self) -> &Limits {
        &self.facts.limits
    }

    /// The parameters whose slopes an evaluation returns, in order.
    pub fn parameters(&self) -> &[MapParameter] {
        &self.facts.parameters
    }

    /// Limit pressure of each FREE alone, Pa, where it has one.
    pub fn limit_pressures(&self) -> &[Option<f64>] {
        &self.facts.limit_pressures
    }

    /// Errors on the check states of the map; no states were judged where the map had none.
    pub fn errors(&self) -> &ModuleErrors {
        &self.facts.errors
    }

    /// Number of nodes of the map that are unstable or missing: the domain ends before them.
    pub fn unstable_nodes(&self) -> u64 {
        self.facts.unstable
    }

    pub(crate) fn facts(&self) -> &ModuleFacts {
        &self.facts
    }
}

impl PoseModel for ModuleModel {
    fn domain(&self) -> &[(f64, f64)] {
        self.splines.domain()
    }

    fn clearance(&self, pressures: &[f64]) -> f64 {
        self.splines.clearance(pressures)
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        let mut chart = [0.0; 6];
        self.splines.evaluate(pressures, &mut chart, &mut into.jacobian, &mut into.slopes)?;
        into.chart = PoseChart::from_array(chart);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
