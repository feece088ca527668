use crate::{pose_error::pose_error, target::Goal};
use actuator::PoseChart;
use nalgebra::{DMatrix, DVector, Vector6};
use rom::{OutOfDomain, PoseEvaluation, PoseModel};

/// Pressures, the pose error there and its derivative.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Pa; always within the box, to the bit.
    pub pressures: Vec<f64>,
    pub chart: PoseChart,
    /// Weighted pose error, m.
    pub error: Vector6<f64>,
    /// d(error)/d(pressure / scale), 6 rows, m.
    pub jacobian: DMatrix<f64>,
}

/// Weighted pose error (m) that stands for a pose that there is not.
const BARRIER: f64 = 1e6;

impl Point {
    /// Whether the module has no stable state there.
    pub fn is_unstable(&self) -> bool {
        self.error[0] == BARRIER
    }

    /// Half the squared weighted error, m^2: what is minimised.
    pub fn cost(&self) -> f64 {
        0.5 * self.error.norm_squared()
    }

    /// Gradient of the cost with respect to pressure / scale, m^2.
    pub fn gradient(&self) -> DVector<f64> {
        self.jacobian.tr_mul(&self.error)
    }
}

/// A model, a goal and the box the pressures are sought in. Steps are counted in units of `scale`.
pub(crate) struct Problem<'m, M: PoseModel + ?Sized> {
    pub model: &'m M,
    pub goal: Goal,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    /// Width of the widest side of the box, Pa.
    pub scale: f64,
    evaluation: PoseEvaluation,
    /// Evaluations so far.
    pub evaluations: usize,
}

impl<'m, M: PoseModel + ?Sized> Problem<'m, M> {
    pub fn new(model: &'m M, goal: Goal, lower: Vec<f64>, upper: Vec<f64>) -> Self {
        let scale = lower.iter().zip(&upper).map(|(lower, upper)| upper - lower).fold(0.0, f64::max);
        Problem {
            model,
            goal,
            // A box without width has one point, and no step to be scaled.
            scale: if scale > 0.0 { scale } else { 1.0 },
            evaluation: PoseEvaluation::new(lower.len(), 0),
            lower,
            upper,
            evaluations: 0,
        }
    }

    pub fn count(&self) -> usize {
        self.lower.len()
    }

    pub fn is_fixed(&self, free: usize) -> bool {
        self.lower[free] == self.upper[free]
    }

    /// Room left below and above a pressure, in units of `scale`: never positive and never negative.
    pub fn room(&self, pressures: &[f64], free: usize) -> (f64, f64) {
        let at = pressures[free];
        ((self.lower[free] - at) / self.scale, (self.upper[free] - at) / self.scale)
    }

    pub fn clamp(&self, pressures: &mut [f64]) {
        for ((pressure, lower), upper) in pressures.iter_mut().zip(&self.lower).zip(&self.upper) {
            *pressure = pressure.clamp(*lower, *upper);
        }
    }

    /// `pressures + fraction scale step`, in the box; a step that takes up the room to a bound ends on it exactly.
    pub fn moved(&self, pressures: &[f64], step: &DVector<f64>, fraction: f64) -> Vec<f64> {
        let mut moved = pressures.to_vec();
        for (free, pressure) in moved.iter_mut().enumerate() {
            let step = fraction * step[free];
            let (below, above) = self.room(pressures, free);
            *pressure = if step <= below {
                self.lower[free]
            } else if step >= above {
                self.upper[free]
            } else {
                *pressure + self.scale * step
            };
        }
        self.clamp(&mut moved);
        moved
    }

    /// The pose error at pressures of the box; in words, what keeps the model from answering. Where the module has no stable state the
    /// error is [`BARRIER`], which no search prefers to any pose.
    pub fn evaluate(&mut self, pressures: Vec<f64>) -> Result<Point, String> {
        self.evaluations += 1;
        match self.model.evaluate(&pressures, &mut self.evaluation) {
            Err(OutOfDomain::Unstable { .. }) => {
                let (chart, error) = (PoseChart::default(), Vector6::from_element(BARRIER));
                return Ok(Point { pressures, chart, error, jacobian: DMatrix::zeros(6, self.count()) });
            }
            answer => answer.map_err(|outside| outside.to_string())?,
        }
        let chart = self.evaluation.chart;
        let (error, by_chart) = pose_error(&self.goal, &chart);
        let mut jacobian = DMatrix::zeros(6, self.count());
        for (mut column, by_pressure) in jacobian.column_iter_mut().zip(&self.evaluation.jacobian) {
            column.copy_from(&(by_chart * Vector6::from(*by_pressure) * self.scale));
        }
        if !error.iter().chain(jacobian.iter()).all(|value| value.is_finite()) {
            return Err(format!(
                "the model's pose or Jacobian is not a number at pressures {pressures:?} Pa; fit the model again"
            ));
        }
        Ok(Point { pressures, chart, error, jacobian })
    }

    /// `sum_k weights_k d2(error_k)`, the part of second derivatives that Gauss-Newton leaves out, from differences of the
    /// Jacobian; in units of `scale`.
    pub fn curvature(&mut self, point: &Point, weights: &Vector6<f64>) -> Result<DMatrix<f64>, String> {
        let n = self.count();
        let here = point.jacobian.tr_mul(weights);
        let mut curvature = DMatrix::zeros(n, n);
        for free in (0..n).filter(|&free| !self.is_fixed(free)).collect::<Vec<_>>() {
            // Into the wider side, so that the box is kept: a part in 1e5 of the box loses five digits to curvature and five
            // to rounding, plenty for a Newton step.
            let (below, above) = self.room(&point.pressures, free);
            let towards = if above >= -below { above.min(1.0) } else { below.max(-1.0) };
            let mut pressures = point.pressures.clone();
            pressures[free] += 1e-5 * towards * self.scale;
            let step = (pressures[free] - point.pressures[free]) / self.scale;
            if step != 0.0 {
                let there = self.evaluate(pressures)?.jacobian.tr_mul(weights);
                curvature.set_column(free, &((there - &here) / step));
            }
        }
        Ok((&curvature + curvature.transpose()) * 0.5)
    }

    /// How far (m) from stationary: the largest projected gradient `|P(p - g) - p|` over the Jacobian's norm, relative to the
    /// error, which is taken as 1 mm at least.
    pub fn stationarity(&self, point: &Point) -> f64 {
        let norm = point.jacobian.norm();
        if norm == 0.0 {
            return 0.0;
        }
        let gradient = point.gradient() / (norm * point.error.norm().max(1e-3));
        (0..self.count())
            .map(|free| {
                let (below, above) = self.room(&point.pressures, free);
                (-gradient[free]).clamp(below.min(0.0), above.max(0.0)).abs()
            })
            .fold(0.0, f64::max)
    }
}
