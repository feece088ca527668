use actuator::PoseChart;

/// A pressure at which a model has no answer: beyond a limit pressure or beyond what its map covers.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("pressure {} of {:.3} kPa is outside the model's domain, {:.3} to {:.3} kPa", free + 1, pressure / 1e3, lower / 1e3, upper / 1e3)]
pub struct OutOfDomain {
    /// Index of the FREE.
    pub free: usize,
    /// The pressure asked for, Pa.
    pub pressure: f64,
    /// Least pressure of the domain, Pa.
    pub lower: f64,
    /// Greatest pressure of the domain, Pa.
    pub upper: f64,
}

/// Value and derivatives of a module's pose; made once with [`PoseEvaluation::new`] and filled by each evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseEvaluation {
    /// The pose, in the chart that does not wrap.
    pub chart: PoseChart,
    /// d(chart)/d(pressure of FREE i), per Pa, in the order of [`PoseChart::to_array`].
    pub jacobian: Vec<[f64; 6]>,
    /// d(chart)/d(parameter), in the order of the map's parameters.
    pub slopes: Vec<[f64; 6]>,
}

impl PoseEvaluation {
    /// Room for a model of `pressures` pressures and `parameters` parameters.
    pub fn new(pressures: usize, parameters: usize) -> Self {
        PoseEvaluation {
            chart: PoseChart::default(),
            jacobian: vec![[0.0; 6]; pressures],
            slopes: vec![[0.0; 6]; parameters],
        }
    }
}

/// What a controller calls: pressures to tip pose.
pub trait PoseModel {
    /// Least and greatest pressure (Pa) of each FREE: the box in which the model answers.
    fn domain(&self) -> &[(f64, f64)];
    /// Pose and derivatives at the pressures (Pa), without allocation.
    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain>;
}
