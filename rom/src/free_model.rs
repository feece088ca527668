use crate::{FreeErrors, SplineAxis, TensorSpline, free_fit::FreeFitError};
use actuator::{Free, units::DEG, units::KPA, units::MPA};
use serde::{Deserialize, Serialize};

/// A point at which a FREE's model has no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OutsideFree {
    /// Pressure below zero, or above what the model covers.
    #[error("pressure of {:.3} kPa is outside the model's domain, 0 to {:.3} kPa at this winding angle and shear modulus", pressure / KPA, upper / KPA)]
    Pressure {
        /// The pressure asked for, Pa.
        pressure: f64,
        /// Greatest pressure of the domain, Pa.
        upper: f64,
    },
    /// Winding angle outside the map's.
    #[error("winding angle of {:.3} deg from the hoop is outside the model's domain, {:.3} to {:.3} deg", angle / DEG, lower / DEG, upper / DEG)]
    WindingAngle {
        /// The angle asked for, rad.
        angle: f64,
        /// Least angle of the domain, rad.
        lower: f64,
        /// Greatest angle of the domain, rad.
        upper: f64,
    },
    /// Shear modulus outside the map's.
    #[error("shear modulus of {:.4} MPa is outside the model's domain, {:.4} to {:.4} MPa", modulus / MPA, lower / MPA, upper / MPA)]
    ShearModulus {
        /// The modulus asked for, Pa.
        modulus: f64,
        /// Least modulus of the domain, Pa.
        lower: f64,
        /// Greatest modulus of the domain, Pa.
        upper: f64,
    },
}

/// Deformation of a FREE and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeEvaluation {
    /// Axial stretch.
    pub axial_stretch: f64,
    /// Expansion b/B, with b the outer radius of equal area.
    pub expansion: f64,
    /// Twist per reference length, rad/m, with the sign of the FREE's hand.
    pub twist_per_length: f64,
    /// `jacobian[input][output]`: inputs pressure (Pa), winding angle (rad), shear modulus (Pa); outputs axial stretch, expansion,
    /// twist per length. Along an axis of a single node the model knows no derivative and gives zero.
    pub jacobian: [[f64; 3]; 3],
}

/// What of a FREE's model is not a spline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FreeFacts {
    pub free: Free,
    /// Whether the path of each node (angle by angle, modulus fastest) ends in a limit point.
    pub limited: Vec<bool>,
    pub errors: FreeErrors,
}

/// Pressure, winding angle and shear modulus to the deformation of a FREE far from its caps: splines fitted from an
/// [`actuator::FreeMap`] by [`FreeModel::fit`].
///
/// Near a limit point the deformation behaves as sqrt(p_limit - p), which no spline in p follows. The splines are therefore over
/// s = 1 - sqrt(1 - p/p_reference), in which deformation is smooth through the fold; p_reference(angle, modulus) is the limit
/// pressure. Towards small angles limit pressure and stretch rise steeply; modulus/p_reference over the angle and 1/stretch over
/// the angle's square root are nearly parabolas, so that is what the splines hold. Where a path met no limit point, p_reference = p_end/(1 - [`crate::LIMIT_MARGIN`]).
/// The domain is 0 <= p <= (1 - [`crate::LIMIT_MARGIN`]) p_reference over the box of the map's angles and moduli.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeModel {
    facts: FreeFacts,
    /// modulus/p_reference over (angle, modulus).
    scaled_reference: TensorSpline<1>,
    /// 1/(axial stretch), expansion, twist per length over (square root of the angle, modulus, s).
    states: TensorSpline<3>,
    /// Greatest p/p_reference of the domain: where the path coordinate ends.
    usable: f64,
}

/// p_reference and its derivatives along angle and modulus.
struct Reference {
    pressure: f64,
    slopes: [f64; 2],
}

/// The value itself, or the nearest end where it misses that by rounding: degrees and megapascals do not convert back exactly.
fn snap(axis: &SplineAxis, value: f64) -> Option<f64> {
    let (lower, upper) = axis.range();
    let rounding = 1e-9 * upper.abs().max(lower.abs());
    (lower - rounding <= value && value <= upper + rounding).then(|| value.clamp(lower, upper))
}

impl FreeModel {
    /// Puts the parts together; refuses parts that do not belong together.
    pub(crate) fn assemble(
        facts: FreeFacts,
        scaled_reference: TensorSpline<1>,
        states: TensorSpline<3>,
    ) -> Result<Self, FreeFitError> {
        let bad = |problem| Err(FreeFitError::Inconsistent { problem });
        let (of_reference, of_states) = (scaled_reference.grid().axes(), states.grid().axes());
        if of_reference.len() != 2 || of_states.len() != 3 || of_reference[1] != of_states[1] {
            return bad("its splines are not over the same moduli");
        }
        if of_reference[0].range().0 <= 0.0 {
            return bad("a winding angle is not positive");
        }
        if !of_reference[0].nodes().iter().map(|angle| angle.sqrt()).eq(of_states[0].nodes().iter().copied())
        {
            return bad("its splines are not over the same winding angles");
        }
        if facts.limited.len() != scaled_reference.grid().node_count() {
            return bad("it does not say of every path how it ends");
        }
        let (rest, top) = of_states[2].range();
        if rest != 0.0 || top <= 0.0 || top >= 1.0 {
            return bad("its path coordinate does not run from zero to less than one");
        }
        if of_reference[1].range().0 <= 0.0 {
            return bad("a shear modulus is not positive");
        }
        let usable = 1.0 - (1.0 - top).powi(2);
        Ok(FreeModel { facts, scaled_reference, states, usable })
    }

    /// Winding angles and shear moduli of the grid: (rad, Pa).
    fn axes(&self) -> (&SplineAxis, &SplineAxis) {
        let axes = self.scaled_reference.grid().axes();
        (&axes[0], &axes[1])
    }

    /// The angle and modulus, snapped to the domain.
    fn inside(&self, winding_angle: f64, shear_modulus: f64) -> Result<[f64; 2], OutsideFree> {
        let (angles, moduli) = self.axes();
        let Some(angle) = snap(angles, winding_angle) else {
            let (lower, upper) = angles.range();
            return Err(OutsideFree::WindingAngle { angle: winding_angle, lower, upper });
        };
        let Some(modulus) = snap(moduli, shear_modulus) else {
            let (lower, upper) = moduli.range();
            return Err(OutsideFree::ShearModulus { modulus: shear_modulus, lower, upper });
        };
        Ok([angle, modulus])
    }

    fn reference(&self, point: [f64; 2]) -> Result<Reference, OutsideFree> {
        let (mut value, mut gradient) = ([0.0], [[0.0]; 2]);
        let [angle, modulus] = point;
        let (lower, upper) = self.axes().0.range();
        self.scaled_reference
            .evaluate(&point, &mut value, &mut gradient)
            .map_err(|_| OutsideFree::WindingAngle { angle, lower, upper })?;
        let softness = value[0];
        if softness <= 0.0 {
            // No pressure then lies inside.
            return Ok(Reference { pressure: 0.0, slopes: [0.0; 2] });
        }
        // p = modulus/g(angle, modulus): dp/dangle = -p g'/g, dp/dmodulus = p/modulus - p g'/g.
        let pressure = modulus / softness;
        let along_angle = -pressure * gradient[0][0] / softness;
        let along_modulus = match self.axes().1.degree() {
            0 => 0.0,
            _ => pressure / modulus - pressure * gradient[1][0] / softness,
        };
        Ok(Reference { pressure, slopes: [along_angle, along_modulus] })
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
        let [angle, modulus] = self.inside(winding_angle, shear_modulus)?;
        let reference = self.reference([angle, modulus])?;
        let upper = self.usable * reference.pressure;
        // A reference pressure that is not positive leaves no domain, not even at zero.
        if !(upper > 0.0 && -reach <= pressure && pressure <= upper + reach) {
            return Err(OutsideFree::Pressure { pressure, upper });
        }
        let nearest = pressure.clamp(0.0, upper);
        // s = 1 - sqrt(1 - q) with q = p/p_reference, written without cancellation.
        let q = nearest / reference.pressure;
        let root = (1.0 - q).sqrt();
        let s = (q / (1.0 + root)).min(self.states.grid().axes()[2].range().1);
        let along_pressure = 1.0 / (2.0 * root * reference.pressure);
        let along_reference = -q * along_pressure;
        let (mut value, mut gradient) = ([0.0; 3], [[0.0; 3]; 3]);
        self.states
            .evaluate(&[angle.sqrt(), modulus, s], &mut value, &mut gradient)
            .map_err(|_| OutsideFree::Pressure { pressure, upper })?;
        // The spline holds 1/stretch: d(stretch) = -stretch^2 d(1/stretch).
        let stretch = 1.0 / value[0];
        if !(stretch.is_finite() && stretch > 0.0) {
            return Err(OutsideFree::Pressure { pressure, upper });
        }
        value[0] = stretch;
        for row in &mut gradient {
            row[0] *= -stretch * stretch;
        }
        let [along_root_angle, along_modulus, along_s] = gradient;
        let along_angle = along_root_angle.map(|slope| 0.5 * slope / angle.sqrt());
        let mut jacobian = [[0.0; 3]; 3];
        for output in 0..3 {
            jacobian[0][output] = along_s[output] * along_pressure;
            let through_reference = along_s[output] * along_reference;
            jacobian[1][output] = along_angle[output] + through_reference * reference.slopes[0];
            jacobian[2][output] = along_modulus[output] + through_reference * reference.slopes[1];
            value[output] += jacobian[0][output] * (pressure - nearest);
        }
        let [axial_stretch, expansion, twist_per_length] = value;
        Ok(FreeEvaluation { axial_stretch, expansion, twist_per_length, jacobian })
    }

    /// Greatest pressure (Pa) of the domain at a winding angle (rad) and shear modulus (Pa).
    pub fn greatest_pressure(&self, winding_angle: f64, shear_modulus: f64) -> Result<f64, OutsideFree> {
        let reference = self.reference(self.inside(winding_angle, shear_modulus)?)?;
        Ok(self.usable * reference.pressure)
    }

    /// Limit pressure (Pa) at a winding angle (rad) and shear modulus (Pa); `None` where a path around this point met none.
    pub fn limit_pressure(&self, winding_angle: f64, shear_modulus: f64) -> Result<Option<f64>, OutsideFree> {
        let point = self.inside(winding_angle, shear_modulus)?;
        let (angles, moduli) = self.axes();
        // Nodes on either side; only the node itself where the point is on it.
        let around = |axis: &SplineAxis, value: f64| {
            let nodes = axis.nodes();
            let below = nodes.partition_point(|node| *node <= value).max(1) - 1;
            below..=below + usize::from(nodes[below] < value && below + 1 < nodes.len())
        };
        let limited = around(angles, point[0])
            .all(|i| around(moduli, point[1]).all(|j| self.facts.limited[i * moduli.nodes().len() + j]));
        let reference = self.reference(point)?;
        Ok(limited.then_some(reference.pressure))
    }

    /// The FREE of the map; its own angle and modulus are one point of the domain.
    pub fn free(&self) -> &Free {
        &self.facts.free
    }

    /// Winding angles of the map's nodes, from the hoop, rad.
    pub fn winding_angles(&self) -> &[f64] {
        self.axes().0.nodes()
    }

    /// Shear moduli of the map's nodes, Pa.
    pub fn shear_moduli(&self) -> &[f64] {
        self.axes().1.nodes()
    }

    /// Errors on the paths that were not fitted, and on those that were.
    pub fn errors(&self) -> &FreeErrors {
        &self.facts.errors
    }

    pub(crate) fn set_errors(&mut self, errors: FreeErrors) {
        self.facts.errors = errors;
    }

    pub(crate) fn facts(&self) -> &FreeFacts {
        &self.facts
    }

    pub(crate) fn scaled_reference(&self) -> &TensorSpline<1> {
        &self.scaled_reference
    }

    pub(crate) fn states(&self) -> &TensorSpline<3> {
        &self.states
    }
}

#[cfg(test)]
mod tests;
