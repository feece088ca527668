use crate::{FreeBarCoverage, FreeErrors, SplineAxis, TensorSpline, free_fit::FreeFitError};
use actuator::Free;
use evaluator::FreeSplines;
use serde::{Deserialize, Serialize};

/// A point at which a FREE's model has no answer.
pub type OutsideFree = evaluator::OutsideFree<f64>;

/// Deformation of a FREE and its derivatives.
pub type FreeEvaluation = evaluator::FreeEvaluation<f64>;

/// What of a FREE's model is not a spline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FreeFacts {
    pub free: Free,
    /// Whether the path of each node (angle by angle, modulus fastest) ends in a limit point.
    pub limited: Vec<bool>,
    pub errors: FreeErrors,
}

/// Pressure, winding angle and shear modulus to the deformation of a FREE far from its caps: splines fitted from an
/// [`actuator::FreeMap`] by [`FreeModel::fit`]; see [`FreeSplines`] for what they are over.
///
/// Where a path met no limit point, p_reference = p_end/(1 - [`crate::LIMIT_MARGIN`]). The domain is
/// 0 <= p <= (1 - [`crate::LIMIT_MARGIN`]) p_reference over the box of the map's angles and moduli.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeModel {
    facts: FreeFacts,
    splines: FreeSplines<f64, Vec<f64>>,
    coverage: FreeBarCoverage,
}

impl FreeModel {
    /// Puts the parts together; refuses parts that do not belong together.
    pub(crate) fn assemble(
        facts: FreeFacts,
        scaled_reference: TensorSpline<1>,
        states: TensorSpline<3>,
        (bars, coverage): (Vec<f64>, FreeBarCoverage),
    ) -> Result<Self, FreeFitError> {
        let paths = scaled_reference.grid().node_count();
        let splines = FreeSplines::new(scaled_reference, states, bars)
            .map_err(|problem| FreeFitError::Inconsistent { problem })?;
        if facts.limited.len() != paths {
            return Err(FreeFitError::Inconsistent { problem: "it does not say of every path how it ends" });
        }
        Ok(FreeModel { facts, splines, coverage })
    }

    /// The splines, as a controller evaluates them.
    pub fn splines(&self) -> &FreeSplines<f64, Vec<f64>> {
        &self.splines
    }

    /// Deformation and derivatives at a pressure (Pa), winding angle from the hoop (rad) and shear modulus (Pa). Allocates nothing.
    pub fn evaluate(
        &self,
        pressure: f64,
        winding_angle: f64,
        shear_modulus: f64,
    ) -> Result<FreeEvaluation, OutsideFree> {
        self.evaluate_near(pressure, winding_angle, shear_modulus, 0.0)
    }

    /// As [`FreeModel::evaluate`], but the pressure may lie up to `reach` (Pa) outside the domain: the deformation is then continued
    /// linearly in pressure from the nearest point inside, with the derivatives of that point.
    pub fn evaluate_near(
        &self,
        pressure: f64,
        winding_angle: f64,
        shear_modulus: f64,
        reach: f64,
    ) -> Result<FreeEvaluation, OutsideFree> {
        self.splines.evaluate(pressure, winding_angle, shear_modulus, reach)
    }

    /// Greatest pressure (Pa) of the domain at a winding angle (rad) and shear modulus (Pa).
    pub fn greatest_pressure(&self, winding_angle: f64, shear_modulus: f64) -> Result<f64, OutsideFree> {
        self.splines.greatest_pressure(winding_angle, shear_modulus)
    }

    /// Limit pressure (Pa) at a winding angle (rad) and shear modulus (Pa); `None` where a path around this point met none.
    pub fn limit_pressure(&self, winding_angle: f64, shear_modulus: f64) -> Result<Option<f64>, OutsideFree> {
        let point = self.splines.inside(winding_angle, shear_modulus)?;
        let (angles, moduli) = self.splines.axes();
        // Nodes on either side; only the node itself where the point is on it.
        let around = |axis: &SplineAxis, value: f64| {
            let nodes = axis.nodes();
            let below = nodes.partition_point(|node| *node <= value).max(1) - 1;
            below..=below + usize::from(nodes[below] < value && below + 1 < nodes.len())
        };
        let limited = around(angles, point[0])
            .all(|i| around(moduli, point[1]).all(|j| self.facts.limited[i * moduli.nodes().len() + j]));
        let reference = self.splines.reference_pressure(point[0], point[1])?;
        Ok(limited.then_some(reference))
    }

    /// The FREE of the map; its own angle and modulus are one point of the domain.
    pub fn free(&self) -> &Free {
        &self.facts.free
    }

    /// Winding angles of the map's nodes, from the hoop, rad.
    pub fn winding_angles(&self) -> &[f64] {
        self.splines.axes().0.nodes()
    }

    /// Shear moduli of the map's nodes, Pa.
    pub fn shear_moduli(&self) -> &[f64] {
        self.splines.axes().1.nodes()
    }

    /// Errors on the paths that were not fitted, and on those that were.
    pub fn errors(&self) -> &FreeErrors {
        &self.facts.errors
    }

    /// How often the error bars hold on states that took no part in setting them.
    pub fn bar_coverage(&self) -> FreeBarCoverage {
        self.coverage
    }

    pub(crate) fn set_errors(&mut self, errors: FreeErrors) {
        self.facts.errors = errors;
    }

    pub(crate) fn set_bars(&mut self, bars: Vec<f64>, coverage: FreeBarCoverage) {
        self.splines.set_bars(bars);
        self.coverage = coverage;
    }

    pub(crate) fn facts(&self) -> &FreeFacts {
        &self.facts
    }
}

#[cfg(test)]
mod tests;
