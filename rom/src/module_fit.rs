use crate::{
    MAX_AXES, ModuleErrors, ModuleModel, SplineError, SplineGrid, error_bars,
    interpolation::{coefficients, grid},
    module_model::{ModuleFacts, Tables},
    module_orbits::Orbits,
    stable_region::StableRegion,
};
use actuator::{ModuleMap, units::KPA};

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
    /// Nodes that are unstable, were not computed or did not converge, and leave nothing to fit.
    #[error(
        "{missing} of {total} states of the map are missing or unstable, first at pressures {first}, and no cell of the grid has a stable state at every corner; finish the sweep (freeact map --resume) or take a smaller greatest pressure"
    )]
    NoStableCell {
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
    /// Parts that do not belong together.
    #[error("the module's model does not hold together: {problem}")]
    Inconsistent {
        /// What is wrong.
        problem: &'static str,
    },
    /// The grid cannot carry a spline.
    #[error("the map's pressures cannot be interpolated: {0}")]
    Spline(#[from] SplineError),
}

pub(crate) fn in_words(pressures: &[f64]) -> String {
    let kpa: Vec<String> = pressures.iter().map(|pressure| format!("{:.3}", pressure / KPA)).collect();
    format!("[{}] kPa", kpa.join(", "))
}

/// A table of six numbers a node, with room where the node has none.
type Holed = Vec<Option<[f64; 6]>>;

/// The chart and the slopes along each parameter at the stable nodes of a map.
fn tables(map: &ModuleMap) -> Result<(Holed, Vec<Holed>), ModuleFitError> {
    let total = map.node_count();
    let mut chart = vec![None; total];
    let mut slopes = vec![vec![None; total]; map.parameters.len()];
    for (node, state) in map.states.iter().enumerate() {
        let Some(state) = state else { continue };
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
        if state.negative_pivots == 0 {
            chart[node] = Some(values);
            for (table, slope) in slopes.iter_mut().zip(&state.slopes) {
                table[node] = Some(*slope);
            }
        }
    }
    Ok((chart, slopes))
}

impl ModuleModel {
    /// Fits the stable states of the map; its `checks` are not fitted but judged on, see [`ModuleModel::errors`].
    ///
    /// Where nodes are unstable or missing, the splines are continued smoothly over them and the domain ends at the cells that they
    /// are corners of.
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
        let (chart, slopes) = tables(map)?;
        let grid: SplineGrid = grid(map.pressures.clone())?;
        let region = StableRegion::new(&grid, chart.iter().map(Option::is_some).collect());
        if !region.has_cell() {
            let missing: Vec<usize> = (0..total).filter(|node| chart[*node].is_none()).collect();
            let shown: Vec<String> =
                missing.iter().take(3).map(|node| in_words(&map.node_pressures(*node))).collect();
            let first = shown.join(", ");
            return Err(ModuleFitError::NoStableCell { missing: missing.len(), total, first });
        }
        let mut fitted = Vec::new();
        for table in &slopes {
            fitted.extend(coefficients(&grid, region.continued(&grid, table))?);
        }
        let orbits = Orbits::new(&map.module, &grid);
        let tables = orbits.symmetrised(Tables {
            chart: coefficients(&grid, region.continued(&grid, &chart))?,
            slopes: fitted,
            clearance: region.clearance(&grid),
            bars: Vec::new(),
        });
        let facts = ModuleFacts {
            module: map.module.clone(),
            limits: map.limits.clone(),
            parameters: map.parameters.clone(),
            limit_pressures: map.limit_pressures.clone(),
            unstable: region.outside().count() as u64,
            errors: ModuleErrors::default(),
        };
        // The scale of the errors is symmetric where the map is; its last bits are made so too.
        let scale = orbits.symmetrised_bars(error_bars::scale(&grid, &chart));
        let model = Self::assemble(facts, grid, tables)?;
        Ok(error_bars::judged(model, map, scale))
    }
}
