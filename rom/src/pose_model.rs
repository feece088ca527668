use actuator::PoseChart;

/// Pressures at which a model has no answer: beyond a limit pressure, beyond what its map covers, or beyond the stable states.
pub type OutOfDomain = evaluator::OutsideModule<f64>;

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

    /// How much (Pa) every pressure may change at once without leaving the domain; negative outside.
    fn clearance(&self, pressures: &[f64]) -> f64 {
        let to_side =
            |(pressure, (lower, upper)): (&f64, &(f64, f64))| (pressure - lower).min(upper - pressure);
        pressures.iter().zip(self.domain()).map(to_side).fold(f64::INFINITY, f64::min)
    }

    /// Pose and derivatives at the pressures (Pa), without allocation.
    ///
    /// Of d(chart)/d(parameter) it fills as many as `into` has room for: a caller that wants none makes no room. Room beyond
    /// the model's parameters is left as it was.
    ///
    /// # Panics
    /// When there are not as many pressures, or not as many derivatives in `into`, as the model has FREEs.
    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain>;

    /// As [`PoseModel::evaluate`], but a pressure may lie up to `reach` (Pa) outside the domain: the pose is then continued
    /// linearly from the nearest point inside, with the derivatives of that point. For measured pressures, whose noise passes
    /// zero. Without allocation.
    ///
    /// # Panics
    /// As [`PoseModel::evaluate`], and for more than [`crate::MAX_AXES`] pressures.
    fn evaluate_near(
        &self,
        pressures: &[f64],
        reach: f64,
        into: &mut PoseEvaluation,
    ) -> Result<(), OutOfDomain> {
        let domain = self.domain();
        let mut inside = [0.0; crate::MAX_AXES];
        let inside = &mut inside[..pressures.len()];
        for (free, ((nearest, &pressure), &(lower, upper))) in
            inside.iter_mut().zip(pressures).zip(domain).enumerate()
        {
            if !(lower - reach <= pressure && pressure <= upper + reach) {
                return Err(OutOfDomain::Pressure { free, pressure, lower, upper });
            }
            *nearest = pressure.clamp(lower, upper);
        }
        self.evaluate(inside, into)?;
        let mut values = into.chart.to_array();
        for ((pressure, nearest), slopes) in pressures.iter().zip(inside.iter()).zip(&into.jacobian) {
            for (value, slope) in values.iter_mut().zip(slopes) {
                *value += slope * (pressure - nearest);
            }
        }
        into.chart = PoseChart::from_array(values);
        Ok(())
    }
}

/// A model that is lent, to each of several threads say.
impl<M: PoseModel + ?Sized> PoseModel for &M {
    fn domain(&self) -> &[(f64, f64)] {
        (**self).domain()
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        (**self).evaluate(pressures, into)
    }

    fn clearance(&self, pressures: &[f64]) -> f64 {
        (**self).clearance(pressures)
    }

    fn evaluate_near(
        &self,
        pressures: &[f64],
        reach: f64,
        into: &mut PoseEvaluation,
    ) -> Result<(), OutOfDomain> {
        (**self).evaluate_near(pressures, reach, into)
    }
}
