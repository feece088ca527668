use crate::{
    FreeErrors, FreeModel, LIMIT_MARGIN, SplineError, free_bars, free_model::FreeFacts,
    interpolation::interpolate,
};
use actuator::{FreeMap, FreePath, PathEnd, units::DEG, units::MPA};

/// Nodes along the path coordinate s. Deformation is smooth in it, and twice as many change no digit that the finite elements hold.
const PATH_NODES: usize = 25;
/// States closer than this in s to the one before are not fitted: their rounding would become a slope.
const LEAST_STEP: f64 = 1e-3;

/// Why a FREE's map cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FreeFitError {
    /// Paths that were not computed or did not converge.
    #[error(
        "{missing} of {total} paths of the map are missing, first at {first}; finish the sweep (freeact map --resume) or leave that angle or modulus out"
    )]
    Missing {
        /// How many.
        missing: usize,
        /// Of how many.
        total: usize,
        /// The first few, in words.
        first: String,
    },
    /// More axes than a model has.
    #[error(
        "the map extends over {axis} as well, a model of a FREE over pressure, winding angle and shear modulus only; make a map for one \
         value of {axis} and fit that"
    )]
    NamedAxis {
        /// The axis, by its name in files.
        axis: &'static str,
    },
    /// A path that cannot be one.
    #[error("the path at {place} {problem}; make the map again")]
    BadPath {
        /// Where, in words.
        place: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// Parts that do not belong together.
    #[error("the FREE's model does not hold together: {problem}")]
    Inconsistent {
        /// What is wrong.
        problem: &'static str,
    },
    /// The grid cannot carry a spline.
    #[error("the map cannot be interpolated: {0}")]
    Spline(#[from] SplineError),
}

fn in_words(angle: f64, modulus: f64) -> String {
    format!("{:.2} deg from the hoop, {:.4} MPa", angle / DEG, modulus / MPA)
}

/// The pressure that a path's coordinate refers to: see [`FreeModel`].
fn reference_pressure(path: &FreePath) -> Result<f64, &'static str> {
    let (Some(first), Some(last)) = (path.states.first(), path.states.last()) else {
        return Err("has no states");
    };
    let finite = path.states.iter().all(|state| {
        [state.pressure, state.axial_stretch, state.expansion, state.twist_per_length]
            .iter()
            .all(|value| value.is_finite())
    });
    if !finite {
        return Err("has a state that is not a finite number");
    }
    if path.states.iter().any(|state| state.axial_stretch <= 0.0) {
        return Err("has a stretch that is not positive");
    }
    if first.pressure != 0.0 {
        return Err("does not begin at zero pressure");
    }
    if last.pressure <= 0.0 {
        return Err("has no state under pressure");
    }
    if path.states.windows(2).any(|pair| pair[1].pressure < pair[0].pressure) {
        return Err("has pressures that fall");
    }
    Ok(match path.end {
        PathEnd::LimitPoint => last.pressure,
        PathEnd::Range => last.pressure / (1.0 - LIMIT_MARGIN),
    })
}

/// Samples 1/stretch, expansion and twist of a path at the nodes of s, through a spline on the path's own states.
fn resample(path: &FreePath, reference: f64, nodes: &[f64]) -> Result<Vec<[f64; 3]>, SplineError> {
    let mut places: Vec<f64> = Vec::with_capacity(path.states.len());
    let mut table: Vec<[f64; 3]> = Vec::with_capacity(path.states.len());
    for (index, state) in path.states.iter().enumerate() {
        let s = 1.0 - (1.0 - state.pressure / reference).max(0.0).sqrt();
        if places.last().is_some_and(|before| s - before < LEAST_STEP) {
            // The end is worth more than its neighbour, except that the state of rest is never given up.
            if index + 1 < path.states.len() || places.len() == 1 {
                continue;
            }
            places.pop();
            table.pop();
        }
        places.push(s);
        table.push([1.0 / state.axial_stretch, state.expansion, state.twist_per_length]);
    }
    let spline = interpolate(vec![places], table)?;
    let end = spline.grid().axes()[0].range().1;
    let mut samples = Vec::with_capacity(nodes.len());
    for node in nodes {
        let (mut value, mut gradient) = ([0.0; 3], [[0.0; 3]]);
        // The end of a path without limit point is the last node, up to rounding.
        let outside = spline.evaluate(&[node.min(end)], &mut value, &mut gradient);
        outside.map_err(|_| SplineError::NotFinite { what: "path coordinate", index: samples.len() })?;
        samples.push(value);
    }
    Ok(samples)
}

impl FreeModel {
    /// Fits the map; its `checks` are not fitted but judged on, see [`FreeModel::errors`]. One angle or one modulus is enough: that
    /// value is then the domain.
    pub fn fit(map: &FreeMap) -> Result<Self, FreeFitError> {
        if let Some(axis) = map.named_axes().first() {
            return Err(FreeFitError::NamedAxis { axis: axis.parameter.name() });
        }
        for (axis, nodes) in [map.winding_angles(), map.shear_moduli()].into_iter().enumerate() {
            if nodes.is_empty() {
                return Err(SplineError::EmptyAxis { axis }.into());
            }
        }
        let points: Vec<(f64, f64)> = map
            .winding_angles()
            .iter()
            .flat_map(|angle| map.shear_moduli().iter().map(|modulus| (*angle, *modulus)))
            .collect();
        if map.paths.len() != points.len() {
            return Err(SplineError::Count { expected: points.len(), found: map.paths.len() }.into());
        }
        let missing: Vec<String> = points
            .iter()
            .zip(&map.paths)
            .filter(|(_, path)| path.is_none())
            .map(|((angle, modulus), _)| in_words(*angle, *modulus))
            .collect();
        if !missing.is_empty() {
            let first = missing[..missing.len().min(3)].join("; ");
            return Err(FreeFitError::Missing { missing: missing.len(), total: points.len(), first });
        }
        let top = 1.0 - LIMIT_MARGIN.sqrt();
        let nodes: Vec<f64> =
            (0..PATH_NODES).map(|node| top * node as f64 / (PATH_NODES - 1) as f64).collect();
        let (mut references, mut states, mut limited) = (Vec::new(), Vec::new(), Vec::new());
        for ((angle, modulus), path) in points.iter().zip(map.paths.iter().flatten()) {
            let bad = |problem| FreeFitError::BadPath { place: in_words(*angle, *modulus), problem };
            let reference = reference_pressure(path).map_err(bad)?;
            references.push([modulus / reference]);
            states.extend(resample(path, reference, &nodes)?);
            limited.push(path.end == PathEnd::LimitPoint);
        }
        let (angles, moduli) = (map.winding_angles().to_vec(), map.shear_moduli().to_vec());
        if let Some(angle) = angles.iter().find(|angle| **angle <= 0.0) {
            let place = in_words(*angle, moduli[0]);
            return Err(FreeFitError::BadPath { place, problem: "has a winding angle that is not positive" });
        }
        // See FreeModel for the coordinates.
        let roots = angles.iter().map(|angle| angle.sqrt()).collect();
        let scaled_reference = interpolate(vec![angles, moduli.clone()], references)?;
        let table = states.clone();
        let states = interpolate(vec![roots, moduli, nodes], states)?;
        let facts = FreeFacts { free: map.node.free, limited, errors: FreeErrors::default() };
        let mut model = Self::assemble(facts, scaled_reference, states, Default::default())?;
        model.set_errors(FreeErrors::of(&model, map));
        free_bars::set(&mut model, map, &table);
        Ok(model)
    }
}
