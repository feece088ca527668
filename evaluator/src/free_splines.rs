use crate::{
    Axis, Real, TensorSpline,
    effect::{Chain, Effect},
    multilinear,
};
use core::fmt;

/// A point at which a FREE's model has no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutsideFree<T> {
    /// Pressure below zero, or above what the model covers.
    Pressure {
        /// The pressure asked for, Pa.
        pressure: T,
        /// Greatest pressure of the domain, Pa.
        upper: T,
    },
    /// Winding angle outside the map's.
    WindingAngle {
        /// The angle asked for, from the hoop, rad.
        angle: T,
        /// Least angle of the domain, rad.
        lower: T,
        /// Greatest angle of the domain, rad.
        upper: T,
    },
    /// Shear modulus outside the map's.
    ShearModulus {
        /// The modulus asked for, Pa.
        modulus: T,
        /// Least modulus of the domain, Pa.
        lower: T,
        /// Greatest modulus of the domain, Pa.
        upper: T,
    },
}

impl<T: Real> fmt::Display for OutsideFree<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OutsideFree::Pressure { pressure, upper } => {
                let [pressure, upper] = [pressure, upper].map(|pascal| pascal.to_f64() / 1e3);
                write!(
                    f,
                    "pressure of {pressure:.3} kPa is outside the model's domain, 0 to {upper:.3} kPa at this winding angle and shear modulus"
                )
            }
            OutsideFree::WindingAngle { angle, lower, upper } => {
                let [angle, lower, upper] =
                    [angle, lower, upper].map(|radians| radians.to_f64().to_degrees());
                write!(
                    f,
                    "winding angle of {angle:.3} deg from the hoop is outside the model's domain, {lower:.3} to {upper:.3} deg"
                )
            }
            OutsideFree::ShearModulus { modulus, lower, upper } => {
                let [modulus, lower, upper] = [modulus, lower, upper].map(|pascal| pascal.to_f64() / 1e6);
                write!(
                    f,
                    "shear modulus of {modulus:.4} MPa is outside the model's domain, {lower:.4} to {upper:.4} MPa"
                )
            }
        }
    }
}

impl<T: Real> core::error::Error for OutsideFree<T> {}

/// Deformation of a FREE and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeEvaluation<T> {
    /// Axial stretch.
    pub axial_stretch: T,
    /// Expansion b/B, with b the outer radius of equal area.
    pub expansion: T,
    /// Twist per reference length, rad/m, with the sign of the FREE's hand.
    pub twist_per_length: T,
    /// `jacobian[input][output]`: inputs pressure (Pa), winding angle (rad), shear modulus (Pa); outputs axial stretch, expansion,
    /// twist per length. Along an axis of a single node the model knows no derivative and gives zero.
    pub jacobian: [[T; 3]; 3],
}

/// Pressure, winding angle and shear modulus to the deformation of a FREE far from its caps, by splines. `R` holds numbers `T`.
///
/// Near a limit point the deformation behaves as sqrt(p_limit - p), which no spline in p follows. The splines are therefore over
/// s = 1 - sqrt(1 - p/p_reference), in which deformation is smooth through the fold; p_reference(angle, modulus) is the limit
/// pressure. Towards small angles limit pressure and stretch rise steeply; modulus/p_reference over the angle and 1/stretch over
/// the angle's square root are nearly parabolas, so that is what the splines hold.
/// The domain is 0 <= p <= usable p_reference over the box of the angles and moduli, with 1 - usable = (1 - s_end)^2.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeSplines<T, R> {
    /// modulus/p_reference over (angle, modulus).
    scaled_reference: TensorSpline<T, R, 1>,
    /// 1/(axial stretch), expansion, twist per length over (square root of the angle, modulus, s).
    states: TensorSpline<T, R, 3>,
    /// Greatest p/p_reference of the domain: where the path coordinate ends.
    usable: T,
    /// Of each node of the states the error bars of stretch, expansion and twist per length (rad/m); empty where none are known.
    bars: R,
}

/// p_reference and its derivatives along angle and modulus.
struct Reference<T> {
    pressure: T,
    slopes: [T; 2],
}

/// The value itself, or the nearest end where it misses that by rounding: degrees and megapascals do not convert back exactly.
fn snap<T: Real, R: AsRef<[T]>>(axis: &Axis<T, R>, value: T) -> Option<T> {
    let (lower, upper) = axis.range();
    let rounding = T::ROUNDING * upper.greater(lower);
    (lower - rounding <= value && value <= upper + rounding).then(|| value.greater(lower).lesser(upper))
}

impl<T: Real, R: AsRef<[T]>> FreeSplines<T, R> {
    /// Puts the two splines together, with error bars of stretch, expansion and twist per length (rad/m) of every node of the states, or
    /// none; says what is wrong where they do not belong together.
    pub fn new(
        scaled_reference: TensorSpline<T, R, 1>,
        states: TensorSpline<T, R, 3>,
        bars: R,
    ) -> Result<Self, &'static str> {
        let expected = states.grid().node_count() * 3;
        if ![0, expected].contains(&bars.as_ref().len()) || !bars.as_ref().iter().all(|bar| bar.is_finite()) {
            return Err("it has not three error bars per node");
        }
        let (of_reference, of_states) = (scaled_reference.grid().axes(), states.grid().axes());
        if of_reference.len() != 2 || of_states.len() != 3 || of_reference[1].nodes() != of_states[1].nodes()
        {
            return Err("its splines are not over the same moduli");
        }
        if of_reference[0].range().0 <= T::ZERO {
            return Err("a winding angle is not positive");
        }
        let (angles, roots) = (of_reference[0].nodes(), of_states[0].nodes());
        let same = |(angle, root): (&T, &T)| {
            let off = *root - angle.sqrt();
            off.greater(-off) <= T::ROUNDING * *root
        };
        if angles.len() != roots.len() || !angles.iter().zip(roots).all(same) {
            return Err("its splines are not over the same winding angles");
        }
        let (rest, top) = of_states[2].range();
        if rest != T::ZERO || top <= T::ZERO || top >= T::ONE {
            return Err("its path coordinate does not run from zero to less than one");
        }
        if of_reference[1].range().0 <= T::ZERO {
            return Err("a shear modulus is not positive");
        }
        let usable = T::ONE - (T::ONE - top) * (T::ONE - top);
        Ok(FreeSplines { scaled_reference, states, usable, bars })
    }

    /// The spline of modulus/p_reference over (angle, modulus).
    pub fn scaled_reference(&self) -> &TensorSpline<T, R, 1> {
        &self.scaled_reference
    }

    /// The splines of 1/(axial stretch), expansion and twist per length over (square root of the angle, modulus, s).
    pub fn states(&self) -> &TensorSpline<T, R, 3> {
        &self.states
    }

    /// Error bars of every node of the states; empty where none are known.
    pub fn bars(&self) -> &[[T; 3]] {
        self.bars.as_ref().as_chunks().0
    }

    /// Sets the error bars of stretch, expansion and twist per length (rad/m) of every node of the states, or none.
    ///
    /// # Panics
    /// When they are neither three a node nor none.
    pub fn set_bars(&mut self, bars: R) {
        let expected = 3 * self.states.grid().node_count();
        assert!([0, expected].contains(&bars.as_ref().len()), "there are three bars a node, or none");
        self.bars = bars;
    }

    /// What 95 of 100 errors of stretch, expansion and twist per length (rad/m) against the finite elements stay below around a
    /// pressure (Pa), winding angle (rad) and shear modulus (Pa); `None` where the model was made without states to judge it by.
    ///
    /// # Errors
    /// Where angle or modulus lie outside. A pressure outside counts as the nearest inside.
    pub fn error_bars(
        &self,
        pressure: T,
        winding_angle: T,
        shear_modulus: T,
    ) -> Result<Option<[T; 3]>, OutsideFree<T>> {
        let [angle, modulus] = self.inside(winding_angle, shear_modulus)?;
        let reference = self.reference([angle, modulus])?.pressure;
        if self.bars().is_empty() || reference <= T::ZERO {
            return Ok(None);
        }
        let share = (pressure / reference).greater(T::ZERO).lesser(self.usable);
        let s = T::ONE - (T::ONE - share).sqrt();
        Ok(Some(multilinear(self.states.grid(), self.bars(), &[angle.sqrt(), modulus, s])))
    }

    /// Winding angles and shear moduli of the grid: (rad, Pa).
    pub fn axes(&self) -> (&Axis<T, R>, &Axis<T, R>) {
        let axes = self.scaled_reference.grid().axes();
        (&axes[0], &axes[1])
    }

    /// The angle and modulus, an end of the domain where they miss it by rounding.
    pub fn inside(&self, winding_angle: T, shear_modulus: T) -> Result<[T; 2], OutsideFree<T>> {
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

    fn reference(&self, point: [T; 2]) -> Result<Reference<T>, OutsideFree<T>> {
        let (mut value, mut gradient) = ([T::ZERO], [[T::ZERO]; 2]);
        let [angle, modulus] = point;
        let (lower, upper) = self.axes().0.range();
        let reference = &self.scaled_reference;
        reference
            .grid()
            .value_and_gradient(reference.coefficients(), &point, &mut value, &mut gradient)
            .map_err(|_| OutsideFree::WindingAngle { angle, lower, upper })?;
        let softness = value[0];
        if softness <= T::ZERO {
            // No pressure then lies inside.
            return Ok(Reference { pressure: T::ZERO, slopes: [T::ZERO; 2] });
        }
        // p = modulus/g(angle, modulus): dp/dangle = -p g'/g, dp/dmodulus = p/modulus - p g'/g.
        let pressure = modulus / softness;
        let along_angle = -pressure * gradient[0][0] / softness;
        let along_modulus = match self.axes().1.degree() {
            0 => T::ZERO,
            _ => pressure / modulus - pressure * gradient[1][0] / softness,
        };
        Ok(Reference { pressure, slopes: [along_angle, along_modulus] })
    }

    /// The limit pressure (Pa), or that which stands for one where the map met none.
    pub fn reference_pressure(&self, winding_angle: T, shear_modulus: T) -> Result<T, OutsideFree<T>> {
        Ok(self.reference(self.inside(winding_angle, shear_modulus)?)?.pressure)
    }

    /// Greatest pressure (Pa) of the domain at a winding angle (rad) and shear modulus (Pa).
    pub fn greatest_pressure(&self, winding_angle: T, shear_modulus: T) -> Result<T, OutsideFree<T>> {
        Ok(self.usable * self.reference_pressure(winding_angle, shear_modulus)?)
    }

    /// Deformation and derivatives at a pressure (Pa), winding angle from the hoop (rad) and shear modulus (Pa). The pressure may lie
    /// up to `reach` (Pa) outside the domain: the deformation is then continued linearly in pressure from the nearest point
    /// inside, with the derivatives of that point.
    pub fn evaluate(
        &self,
        pressure: T,
        winding_angle: T,
        shear_modulus: T,
        reach: T,
    ) -> Result<FreeEvaluation<T>, OutsideFree<T>> {
        let [angle, modulus] = self.inside(winding_angle, shear_modulus)?;
        let reference = self.reference([angle, modulus])?;
        let upper = self.usable * reference.pressure;
        // A reference pressure that is not positive leaves no domain, not even at zero.
        if !(upper > T::ZERO && -reach <= pressure && pressure <= upper + reach) {
            return Err(OutsideFree::Pressure { pressure, upper });
        }
        let nearest = pressure.greater(T::ZERO).lesser(upper);
        // s = 1 - sqrt(1 - q) with q = p/p_reference, written without cancellation.
        let q = nearest / reference.pressure;
        let root = (T::ONE - q).sqrt();
        let s = (q / (T::ONE + root)).lesser(self.states.grid().axes()[2].range().1);
        let along_pressure = T::constant(0.5) / (root * reference.pressure);
        let along_reference = -q * along_pressure;
        let (mut value, mut gradient) = ([T::ZERO; 3], [[T::ZERO; 3]; 3]);
        let root_angles = self.states.grid().axes()[0].range();
        let root_angle = angle.sqrt().greater(root_angles.0).lesser(root_angles.1);
        let (states, at) = (&self.states, [root_angle, modulus, s]);
        states
            .grid()
            .value_and_gradient(states.coefficients(), &at, &mut value, &mut gradient)
            .map_err(|_| OutsideFree::Pressure { pressure, upper })?;
        // The spline holds 1/stretch: d(stretch) = -stretch^2 d(1/stretch).
        let stretch = T::ONE / value[0];
        if !(stretch.is_finite() && stretch > T::ZERO) {
            return Err(OutsideFree::Pressure { pressure, upper });
        }
        value[0] = stretch;
        for row in &mut gradient {
            row[0] *= -stretch * stretch;
        }
        let [along_root_angle, along_modulus, along_s] = gradient;
        let per_root = T::constant(0.5) / root_angle;
        let mut jacobian = [[T::ZERO; 3]; 3];
        for output in 0..3 {
            jacobian[0][output] = along_s[output] * along_pressure;
            let through_reference = along_s[output] * along_reference;
            jacobian[1][output] =
                along_root_angle[output] * per_root + through_reference * reference.slopes[0];
            jacobian[2][output] = along_modulus[output] + through_reference * reference.slopes[1];
            value[output] += jacobian[0][output] * (pressure - nearest);
        }
        let [axial_stretch, expansion, twist_per_length] = value;
        Ok(FreeEvaluation { axial_stretch, expansion, twist_per_length, jacobian })
    }

    /// Deformation and derivatives at the end of `step` seconds at a pressure (Pa) in the FREE, with the effects, whose memory goes on;
    /// what it remembers of the past is held fixed in the derivatives. Winding angle (rad) and shear modulus (Pa) are those before
    /// the effects.
    ///
    /// # Errors
    /// Where the model has no answer; the memory has then gone on all the same.
    ///
    /// # Panics
    /// When the chain is not of one FREE, or `memory` is shorter than [`Chain::memory`].
    pub fn evaluate_after<'e, I>(
        &self,
        chain: &Chain<I>,
        memory: &mut [T],
        step: T,
        pressure: T,
        winding_angle: T,
        shear_modulus: T,
    ) -> Result<FreeEvaluation<T>, OutsideFree<T>>
    where
        T: 'e,
        I: Iterator<Item = Effect<'e, T>> + Clone,
    {
        let (mut answered, mut gain) = ([pressure], [T::ONE]);
        chain.deform_with_gains(memory, step, &mut answered, &mut gain);
        let angle = winding_angle + chain.winding_angle();
        let mut found = self.evaluate(answered[0], angle, shear_modulus, T::ZERO)?;
        for slope in &mut found.jacobian[0] {
            *slope *= gain[0];
        }
        Ok(found)
    }
}
