use crate::{MAX_AXES, PointBasis, Real, SplineGrid, multilinear};
use core::fmt;

/// Numbers of a pose chart.
const CHART: usize = 6;

/// Pressures at which a module's model has no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutsideModule<T> {
    /// A pressure below or above what the model covers.
    Pressure {
        /// Index of the FREE.
        free: usize,
        /// The pressure asked for, Pa.
        pressure: T,
        /// Least pressure of the domain, Pa.
        lower: T,
        /// Greatest pressure of the domain, Pa.
        upper: T,
    },
    /// Pressures at or beyond the boundary of the stable states that the map found.
    Unstable {
        /// How far beyond (Pa), a distance in the space of the pressures.
        beyond: T,
    },
}

impl<T: Real> fmt::Display for OutsideModule<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OutsideModule::Pressure { free, pressure, lower, upper } => {
                let [pressure, lower, upper] = [pressure, lower, upper].map(|pascal| pascal.to_f64() / 1e3);
                write!(
                    f,
                    "pressure {} of {pressure:.3} kPa is outside the model's domain, {lower:.3} to {upper:.3} kPa",
                    free + 1
                )
            }
            OutsideModule::Unstable { beyond } => {
                let beyond = beyond.to_f64() / 1e3;
                write!(
                    f,
                    "these pressures are {beyond:.3} kPa beyond the stable states that the finite elements found: the module buckles on the way, or has no equilibrium there"
                )
            }
        }
    }
}

impl<T: Real> core::error::Error for OutsideModule<T> {}

/// Pressures of a module to the chart of its tip pose, by splines. `R` holds numbers `T`.
///
/// The domain is a box of pressures, less what lies at or beyond the boundary of the stable states of the map.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleSplines<T, R> {
    grid: SplineGrid<T, R>,
    /// Coefficients of the chart.
    chart: R,
    /// Coefficients of d(chart)/d(parameter), one table a parameter after the other.
    slopes: R,
    parameters: usize,
    domain: [(T, T); MAX_AXES],
    /// Of each node the distance (Pa) to the boundary of the stable states, negative beyond; empty where all are stable.
    clearance: R,
    /// Of each node the error bars of position (m) and rotation (rad); empty where none are known.
    bars: R,
}

impl<T: Real, R: AsRef<[T]>> ModuleSplines<T, R> {
    /// Puts the tables of one grid together; says what is wrong where they do not belong together. `domain` holds least and greatest
    /// pressure (Pa) of each FREE.
    pub fn new(
        grid: SplineGrid<T, R>,
        (chart, slopes): (R, R),
        domain: impl IntoIterator<Item = (T, T)>,
        (clearance, bars): (R, R),
    ) -> Result<Self, &'static str> {
        let (frees, nodes) = (grid.axes().len(), grid.node_count());
        let entry = nodes.checked_mul(CHART).ok_or("it has too many nodes")?;
        if chart.as_ref().len() != entry {
            return Err("it has not one pose per node");
        }
        if slopes.as_ref().len() % entry != 0 {
            return Err("it has not one slope per node and parameter");
        }
        let parameters = slopes.as_ref().len() / entry;
        if ![0, nodes].contains(&clearance.as_ref().len()) || ![0, 2 * nodes].contains(&bars.as_ref().len()) {
            return Err("it has not one distance to its boundary, or not two error bars, per node");
        }
        let tables = [&chart, &slopes, &clearance, &bars];
        if !tables.iter().all(|table| table.as_ref().iter().all(|number| number.is_finite())) {
            return Err("a number of its tables is not finite");
        }
        let mut box_of_pressures = [(T::ZERO, T::ZERO); MAX_AXES];
        let mut count = 0;
        for (free, (lower, upper)) in domain.into_iter().enumerate() {
            let Some(axis) = grid.axes().get(free) else {
                return Err("its domain has more sides than FREEs");
            };
            let (first, last) = axis.range();
            if !(first <= lower && lower <= upper && upper <= last) {
                return Err("its domain is not within its grid");
            }
            box_of_pressures[free] = (lower, upper);
            count += 1;
        }
        if count != frees {
            return Err("its domain has fewer sides than FREEs");
        }
        Ok(ModuleSplines { grid, chart, slopes, parameters, domain: box_of_pressures, clearance, bars })
    }

    /// The grid of pressures.
    pub fn grid(&self) -> &SplineGrid<T, R> {
        &self.grid
    }

    /// Coefficients of the chart, last FREE fastest.
    pub fn chart(&self) -> &[[T; CHART]] {
        self.chart.as_ref().as_chunks().0
    }

    /// Coefficients of d(chart)/d(parameter) of one parameter.
    pub fn slopes(&self, parameter: usize) -> &[[T; CHART]] {
        let entry = self.grid.node_count() * CHART;
        self.slopes.as_ref()[parameter * entry..(parameter + 1) * entry].as_chunks().0
    }

    /// Number of parameters with slopes.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// Least and greatest pressure (Pa) of each FREE.
    pub fn domain(&self) -> &[(T, T)] {
        &self.domain[..self.grid.axes().len()]
    }

    /// Of each node the distance (Pa) to the boundary of the stable states, negative beyond; empty where all are stable.
    pub fn clearances(&self) -> &[T] {
        self.clearance.as_ref()
    }

    /// Of each node the error bars of position (m) and rotation (rad); empty where none are known.
    pub fn bars(&self) -> &[[T; 2]] {
        self.bars.as_ref().as_chunks().0
    }

    /// How much (Pa) every pressure may change at once without leaving the domain, negative outside: the distance to the box's sides,
    /// and to the states that are unstable or that the finite elements could not reach. The latter is interpolated linearly
    /// between nodes, and is as coarse as the grid.
    ///
    /// # Panics
    /// When there are not as many pressures as FREEs.
    pub fn clearance(&self, pressures: &[T]) -> T {
        assert_eq!(pressures.len(), self.domain().len(), "there is one pressure per FREE");
        let mut least = self.stable_distance(pressures);
        for (pressure, (lower, upper)) in pressures.iter().zip(self.domain()) {
            let to_side = (*pressure - *lower).lesser(*upper - *pressure);
            least = Some(least.map_or(to_side, |least| least.lesser(to_side)));
        }
        least.unwrap_or_default()
    }

    /// Sets the error bars of position (m) and rotation (rad) of every node.
    ///
    /// # Panics
    /// When they are not two a node.
    pub fn set_bars(&mut self, bars: R) {
        assert_eq!(bars.as_ref().len(), 2 * self.grid.node_count(), "there are two bars a node");
        self.bars = bars;
    }

    /// Distance (Pa) to the boundary of the stable states; `None` where all are.
    fn stable_distance(&self, pressures: &[T]) -> Option<T> {
        let table: &[[T; 1]] = self.clearance.as_ref().as_chunks().0;
        (!table.is_empty()).then(|| multilinear(&self.grid, table, pressures)[0])
    }

    /// What 95 of 100 errors of position (m) and rotation (rad) against the finite elements stay below around these pressures; `None`
    /// where the model was made without states to judge it by.
    ///
    /// # Panics
    /// When there are not as many pressures as FREEs.
    pub fn error_bars(&self, pressures: &[T]) -> Option<[T; 2]> {
        let table = self.bars();
        (!table.is_empty()).then(|| multilinear(&self.grid, table, pressures))
    }

    /// Whether the model answers at these pressures.
    ///
    /// # Errors
    /// Which side of the box they pass, or how far beyond the stable states they lie.
    ///
    /// # Panics
    /// When there are not as many pressures as FREEs.
    pub fn check(&self, pressures: &[T]) -> Result<(), OutsideModule<T>> {
        assert_eq!(pressures.len(), self.domain().len(), "there is one pressure per FREE");
        for (free, (&pressure, &(lower, upper))) in pressures.iter().zip(self.domain()).enumerate() {
            if !(lower <= pressure && pressure <= upper) {
                return Err(OutsideModule::Pressure { free, pressure, lower, upper });
            }
        }
        match self.stable_distance(pressures) {
            Some(distance) if distance <= T::ZERO => Err(OutsideModule::Unstable { beyond: -distance }),
            _ => Ok(()),
        }
    }

    fn locate(&self, pressures: &[T]) -> Result<PointBasis<T>, OutsideModule<T>> {
        self.check(pressures)?;
        self.grid.locate(pressures).map_err(|outside| OutsideModule::Pressure {
            free: outside.axis,
            pressure: outside.value,
            lower: outside.lower,
            upper: outside.upper,
        })
    }

    /// The chart (twist, bend x, bend y, rad; x, y, z, m), `jacobian[free]` = d(chart)/d(pressure), per Pa, and d(chart)/d(parameter)
    /// of as many parameters as `slopes` has room for.
    ///
    /// # Errors
    /// Where the model has no answer.
    ///
    /// # Panics
    /// When there are not as many pressures, or not as many derivatives, as FREEs.
    #[inline]
    pub fn evaluate(
        &self,
        pressures: &[T],
        chart: &mut [T; CHART],
        jacobian: &mut [[T; CHART]],
        slopes: &mut [[T; CHART]],
    ) -> Result<(), OutsideModule<T>> {
        assert_eq!(jacobian.len(), self.domain().len(), "room for one derivative per FREE");
        let basis = self.locate(pressures)?;
        basis.value_and_gradient(self.chart(), chart, jacobian);
        for (parameter, slope) in slopes.iter_mut().enumerate().take(self.parameters) {
            *slope = basis.value(self.slopes(parameter));
        }
        Ok(())
    }

    /// As [`ModuleSplines::evaluate`], of the chart plus the sum of `factors[parameter]` times the slopes along each parameter, with all its
    /// derivatives.
    ///
    /// # Errors
    /// Where the model has no answer.
    ///
    /// # Panics
    /// When there are not as many pressures, or not as many derivatives, as FREEs, or more factors than parameters.
    pub fn evaluate_loaded(
        &self,
        pressures: &[T],
        factors: &[T],
        chart: &mut [T; CHART],
        jacobian: &mut [[T; CHART]],
    ) -> Result<(), OutsideModule<T>> {
        assert_eq!(jacobian.len(), self.domain().len(), "room for one derivative per FREE");
        let basis = self.locate(pressures)?;
        basis.value_and_gradient(self.chart(), chart, jacobian);
        let (mut value, mut gradient) = ([T::ZERO; CHART], [[T::ZERO; CHART]; MAX_AXES]);
        let gradient = &mut gradient[..jacobian.len()];
        for (parameter, factor) in factors.iter().enumerate().filter(|(_, factor)| **factor != T::ZERO) {
            basis.value_and_gradient(self.slopes(parameter), &mut value, gradient);
            let added = value.iter().chain(gradient.as_flattened());
            for (sum, slope) in chart.iter_mut().chain(jacobian.as_flattened_mut()).zip(added) {
                *sum += *factor * *slope;
            }
        }
        Ok(())
    }

    /// The mixed partial derivative of the chart of the given order along each pressure.
    ///
    /// # Errors
    /// Where the model has no answer.
    ///
    /// # Panics
    /// When the pressures or the orders are not as many as FREEs.
    pub fn partial(&self, pressures: &[T], orders: &[usize]) -> Result<[T; CHART], OutsideModule<T>> {
        self.locate(pressures)?;
        match self.grid.locate_partial(pressures, orders) {
            Ok(basis) => Ok(basis.value(self.chart())),
            Err(outside) => Err(OutsideModule::Pressure {
                free: outside.axis,
                pressure: outside.value,
                lower: outside.lower,
                upper: outside.upper,
            }),
        }
    }
}
