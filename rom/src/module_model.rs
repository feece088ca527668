use crate::{ErrorStatistics, MAX_AXES, OutOfDomain, PoseEvaluation, PoseModel, SplineError, TensorSpline};
use actuator::{Limits, MapParameter, Module, ModuleMap, PoseChart, grid_places, units::KPA};
use serde::{Deserialize, Serialize};

/// Fraction of a FREE's own limit pressure that a model leaves unused: near the limit the slopes grow without bound.
pub const LIMIT_MARGIN: f64 = 0.02;

/// Why a module map cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModuleFitError {
    /// The map does not hold as many axes, limits and FREEs as its module has.
    #[error("the module has {frees} FREEs, but its map has {found} {what}; make the map again")]
    Shape {
        /// FREEs of the module.
        frees: usize,
        /// What is of another number.
        what: &'static str,
        /// How many there are.
        found: usize,
    },
    /// More FREEs than a spline has axes.
    #[error("a model takes up to {MAX_AXES} FREEs, this module has {frees}")]
    TooManyFrees {
        /// FREEs of the module.
        frees: usize,
    },
    /// Nodes that were not computed or did not converge.
    #[error(
        "{missing} of {total} states of the map are missing, first at pressures {first}; finish the sweep (freeact map --resume) or take a smaller greatest pressure"
    )]
    Missing {
        /// How many.
        missing: usize,
        /// Of how many.
        total: usize,
        /// The first few, in words.
        first: String,
    },
    /// A state whose numbers are not finite or whose slopes are not as many as the parameters.
    #[error("the state at pressures {pressures} {problem}; make the map again")]
    BadState {
        /// Where, in words.
        pressures: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// Nothing is left below the limit pressure.
    #[error(
        "FREE {} has its limit pressure at {:.3} kPa, below the map's first pressure of {:.3} kPa", free + 1, limit / KPA, lower / KPA
    )]
    NoDomain {
        /// Which FREE.
        free: usize,
        /// Its limit pressure, Pa.
        limit: f64,
        /// First pressure of the map, Pa.
        lower: f64,
    },
    /// The grid cannot carry a spline.
    #[error("the map's pressures cannot be interpolated: {0}")]
    Spline(#[from] SplineError),
}

/// Error of a module model on states of the finite elements that the fit never saw.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModuleErrors {
    /// Distance between model and finite elements, m.
    pub position: ErrorStatistics,
    /// Angle between them, rad.
    pub rotation: ErrorStatistics,
    /// Pressures (Pa) at which the position is worst.
    pub worst_at: Vec<f64>,
    /// Check states outside the model's domain, which were not judged.
    pub outside: usize,
    /// Judged states that are buckled.
    pub buckled: usize,
}

/// What of a module model is not a spline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModuleFacts {
    pub module: Module,
    pub limits: Limits,
    pub parameters: Vec<MapParameter>,
    pub limit_pressures: Vec<Option<f64>>,
    /// Nodes whose state is buckled, rising.
    pub buckled: Vec<u64>,
    pub errors: ModuleErrors,
}

/// Pressures of a module to its tip pose: splines over the pressures, fitted from a [`ModuleMap`].
///
/// The pose is held in the chart that does not wrap. The domain is the box of the map's grid, and at most
/// (1 - [`LIMIT_MARGIN`]) of each FREE's own limit pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleModel {
    facts: ModuleFacts,
    chart: TensorSpline<6>,
    /// Coefficients of d(chart)/d(parameter), one table a parameter, on the chart's grid.
    slopes: Vec<Vec<[f64; 6]>>,
    domain: Vec<(f64, f64)>,
}

fn in_words(pressures: &[f64]) -> String {
    let kpa: Vec<String> = pressures.iter().map(|pressure| format!("{:.3}", pressure / KPA)).collect();
    format!("[{}] kPa", kpa.join(", "))
}

impl ModuleModel {
    /// Fits the map; its `checks` are not fitted but judged on, see [`ModuleModel::errors`].
    pub fn fit(map: &ModuleMap) -> Result<Self, ModuleFitError> {
        let frees = map.module.frees.len();
        if frees == 0 || frees > MAX_AXES {
            return Err(ModuleFitError::TooManyFrees { frees });
        }
        for (what, found) in [
            ("pressure axes", map.pressures.len()),
            ("limit pressures", map.limit_pressures.len()),
            ("greatest pressures", map.limits.pressure_max.len()),
        ] {
            if found != frees {
                return Err(ModuleFitError::Shape { frees, what, found });
            }
        }
        let total = map.node_count();
        if map.states.len() != total {
            return Err(SplineError::Count { expected: total, found: map.states.len() }.into());
        }
        let missing: Vec<usize> = (0..total).filter(|node| map.states[*node].is_none()).collect();
        if !missing.is_empty() {
            let shown: Vec<String> =
                missing.iter().take(3).map(|node| in_words(&map.node_pressures(*node))).collect();
            let first = shown.join(", ");
            return Err(ModuleFitError::Missing { missing: missing.len(), total, first });
        }
        let mut chart = Vec::with_capacity(total);
        let mut slopes = vec![Vec::with_capacity(total); map.parameters.len()];
        let mut buckled = Vec::new();
        for (node, state) in map.states.iter().flatten().enumerate() {
            let bad = |problem| {
                Err(ModuleFitError::BadState { pressures: in_words(&map.node_pressures(node)), problem })
            };
            if state.slopes.len() != map.parameters.len() {
                return bad("does not carry one slope a parameter");
            }
            let values = state.chart.to_array();
            if !values.iter().chain(state.slopes.iter().flatten()).all(|value| value.is_finite()) {
                return bad("is not a finite number");
            }
            chart.push(values);
            for (table, slope) in slopes.iter_mut().zip(&state.slopes) {
                table.push(*slope);
            }
            if state.negative_pivots > 0 {
                buckled.push(node as u64);
            }
        }
        let chart = TensorSpline::interpolate(map.pressures.clone(), chart)?;
        let slopes =
            slopes.into_iter().map(|table| chart.grid().interpolate(table)).collect::<Result<_, _>>()?;
        let facts = ModuleFacts {
            module: map.module.clone(),
            limits: map.limits.clone(),
            parameters: map.parameters.clone(),
            limit_pressures: map.limit_pressures.clone(),
            buckled,
            errors: ModuleErrors::default(),
        };
        let mut model = Self::assemble(facts, chart, slopes)?;
        model.facts.errors = model.judge(map);
        Ok(model)
    }

    /// Puts the parts together and works out the domain.
    pub(crate) fn assemble(
        facts: ModuleFacts,
        chart: TensorSpline<6>,
        slopes: Vec<Vec<[f64; 6]>>,
    ) -> Result<Self, ModuleFitError> {
        let mut domain = Vec::with_capacity(facts.limit_pressures.len());
        for (free, (axis, limit)) in chart.grid().axes().iter().zip(&facts.limit_pressures).enumerate() {
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
        Ok(ModuleModel { facts, chart, slopes, domain })
    }

    fn judge(&self, map: &ModuleMap) -> ModuleErrors {
        let mut into = self.workspace();
        let mut errors = ModuleErrors::default();
        let (mut position, mut rotation) = (Vec::new(), Vec::new());
        for check in &map.checks {
            if check.pressures.len() != self.domain.len()
                || self.evaluate(&check.pressures, &mut into).is_err()
            {
                errors.outside += 1;
                continue;
            }
            errors.buckled += usize::from(check.state.negative_pivots > 0);
            let (ours, theirs) = (into.chart.to_pose(), check.state.chart.to_pose());
            let distance = (ours.position - theirs.position).norm();
            if position.iter().all(|other| *other < distance) {
                errors.worst_at.clone_from(&check.pressures);
            }
            position.push(distance);
            rotation.push(ours.rotation_distance(&theirs));
        }
        errors.position = ErrorStatistics::of(&position);
        errors.rotation = ErrorStatistics::of(&rotation);
        errors
    }

    /// Room for an evaluation of this model.
    pub fn workspace(&self) -> PoseEvaluation {
        PoseEvaluation::new(self.domain.len(), self.slopes.len())
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

    /// Pressures (Pa) of the nodes whose state is buckled (its tangent has a negative pivot). There the pose follows one of
    /// several branches, and a real module may follow another.
    pub fn buckled_nodes(&self) -> Vec<Vec<f64>> {
        let axes = self.chart.grid().axes();
        let pressures = |node: &u64| {
            let places = grid_places(axes.iter().map(|axis| axis.nodes().len()), *node as usize);
            places.into_iter().zip(axes).map(|(place, axis)| axis.nodes()[place]).collect()
        };
        self.facts.buckled.iter().map(pressures).collect()
    }

    /// Whether a corner of the grid cell around these pressures is buckled. Pressures outside are taken as the nearest inside.
    /// Allocates nothing.
    pub fn is_near_buckling(&self, pressures: &[f64]) -> bool {
        if self.facts.buckled.is_empty() {
            return false;
        }
        let axes = self.chart.grid().axes();
        (0..1usize << axes.len()).any(|corner| {
            let mut node = 0;
            for (bit, (axis, pressure)) in axes.iter().zip(pressures).enumerate() {
                let nodes = axis.nodes();
                let above = nodes.partition_point(|node| node <= pressure).clamp(1, nodes.len().max(2) - 1);
                let index = if corner >> bit & 1 == 1 { above } else { above - 1 };
                node = node * nodes.len() + index.min(nodes.len() - 1);
            }
            self.facts.buckled.binary_search(&(node as u64)).is_ok()
        })
    }

    pub(crate) fn facts(&self) -> &ModuleFacts {
        &self.facts
    }

    pub(crate) fn chart(&self) -> &TensorSpline<6> {
        &self.chart
    }

    pub(crate) fn slopes(&self) -> &[Vec<[f64; 6]>] {
        &self.slopes
    }
}

impl PoseModel for ModuleModel {
    fn domain(&self) -> &[(f64, f64)] {
        &self.domain
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        assert_eq!(pressures.len(), self.domain.len(), "there is one pressure per FREE");
        assert_eq!(into.jacobian.len(), self.domain.len(), "room for one derivative per FREE");
        for (free, (&pressure, &(lower, upper))) in pressures.iter().zip(&self.domain).enumerate() {
            if !(lower <= pressure && pressure <= upper) {
                return Err(OutOfDomain { free, pressure, lower, upper });
            }
        }
        let basis = self.chart.grid().locate(pressures).map_err(|outside| OutOfDomain {
            free: outside.axis,
            pressure: outside.value,
            lower: outside.lower,
            upper: outside.upper,
        })?;
        let mut values = [0.0; 6];
        basis.value_and_gradient(self.chart.coefficients(), &mut values, &mut into.jacobian);
        into.chart = PoseChart::from_array(values);
        for (table, slope) in self.slopes.iter().zip(&mut into.slopes) {
            *slope = basis.value(table);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
