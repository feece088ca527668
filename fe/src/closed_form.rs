use crate::{
    SectionLaw, SectionResponse,
    jet::Jet,
    material::{InvariantDerivatives, InvariantEnergy, Rubber},
    smeared_threads::SmearedThreads,
};
use actuator::{Free, FreeState};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Closed form of a FREE far from its caps: an incompressible thick tube under uniform stretch, twist and inflation, its fibres
/// smeared over the outer surface. The oracle the finite elements are tested with.
///
/// The tube A <= R <= B deforms by `r^2 = a^2 + (R^2 - A^2)/lambda`, `theta = Theta + tau Z`, `z = lambda Z`. The principal
/// stretches squared are `R^2/(lambda^2 r^2)` and the two roots of `y^2 - (r^2/R^2 + r^2 tau^2 + lambda^2) y + lambda^2 r^2/R^2`.
/// A fibre of turn `k = cot(angle)/B` has `stretch^2 = (b^2 (k + tau)^2 + lambda^2)/(B^2 k^2 + 1)`. Minimised is the enthalpy
/// `Phi = integral 2 pi R W dR + n EA/2 sqrt(B^2 k^2 + 1) (stretch - 1)^2 - p pi a^2 lambda`, per reference length; tension-only
/// fibres carry no energy below stretch 1. Right-handed whatever the FREE's hand; callers mirror.
///
/// W is that of any isotropic rubber; the small strain of a linear elastic one is taken in the cylindrical frames before and
/// after, as the section's elements do.
#[derive(Clone, Debug)]
pub struct ThickTube {
    inner_radius: f64,
    outer_radius: f64,
    rubber: Rubber,
    /// Initial shear modulus, Pa: the unit of stress.
    stress_unit: f64,
    /// Radii squared over A^2 and weights (2 pi R dR) of the integration through the wall.
    points: Vec<(f64, f64)>,
    threads: Option<SmearedThreads>,
}

/// A state of the tube: squared inner radius over A^2, stretch, twist times B.
type Unknowns = Vector3<f64>;

/// Why the closed form has no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ClosedFormError {
    /// There is no stable state reachable from rest.
    #[error("no equilibrium at {:.3} kPa reachable from rest; the last one found is at {:.3} kPa: stay below the limit pressure", pressure / 1e3, last / 1e3)]
    NoEquilibrium {
        /// Pressure asked for, Pa.
        pressure: f64,
        /// Greatest pressure of the path from rest where one was found, Pa.
        last: f64,
    },
}

/// Points through the wall: the integrand is analytic, ten give 13 digits at the walls in use.
const POINTS: usize = 10;
/// Relative size of the last Newton step: the next one would be its square.
const TOLERANCE: f64 = 1e-9;

impl ThickTube {
    /// The tube of a FREE with its fibres smeared.
    pub fn new(free: &Free) -> Self {
        let mut tube = Self::bare(free);
        tube.threads = Some(SmearedThreads::of(free));
        tube
    }

    /// The tube with its threads wound loosely: longer than their helix at rest by this share of it. Threads that carry tension only
    /// do nothing before the tube has filled them.
    pub fn with_slack(mut self, slack: f64) -> Self {
        self.threads = self.threads.map(|threads| threads.with_slack(slack));
        self
    }

    /// The tube of a FREE without any fibre.
    pub fn bare(free: &Free) -> Self {
        let (a, b) = (free.tube.inner_radius, free.tube.outer_radius());
        let points = gauss_legendre(POINTS)
            .into_iter()
            .map(|(at, weight)| {
                let radius = 0.5 * (a + b) + 0.5 * (b - a) * at;
                ((radius / a).powi(2), PI * radius * (b - a) * weight)
            })
            .collect();
        ThickTube {
            inner_radius: a,
            outer_radius: b,
            rubber: free.elastomer.into(),
            stress_unit: free.elastomer.initial_shear_modulus(),
            points,
            threads: None,
        }
    }

    /// Phi with its first and second derivatives in the dimensionless unknowns, J/m.
    fn enthalpy(&self, pressure: f64, at: &Unknowns) -> Jet {
        let [area, stretch, twist] = [0, 1, 2].map(|i| Jet::variable(at[i], i));
        let a2 = self.inner_radius * self.inner_radius;
        let ratio2 = a2 / (self.outer_radius * self.outer_radius);
        let (stretch2, twist2) = (stretch * stretch, twist * twist);
        let shrink = stretch.powf(-1.0);
        let mut total = Jet::constant(0.0);
        for &(radius2, weight) in &self.points {
            // All radii over A: x = (r/A)^2.
            let x = area + shrink * (radius2 - 1.0);
            let radial = (stretch2 * x).powf(-1.0) * radius2;
            let hoop = x * (1.0 / radius2);
            let shear = x * twist2 * ratio2;
            total = total + self.energy(radial, hoop, shear, stretch2) * weight;
        }
        // (b/B)^2
        let outer = (area + shrink * (1.0 / ratio2 - 1.0)) * ratio2;
        let threads = self.threads.and_then(|threads| threads.energy(outer, stretch, twist));
        total = threads.map_or(total, |threads| total + threads);
        total - area * stretch * (pressure * PI * a2)
    }

    /// W of F with the rows (sqrt(radial), 0, 0), (0, sqrt(hoop), sqrt(shear)), (0, 0, sqrt(axial)) and det F = 1.
    fn energy(&self, radial: Jet, hoop: Jet, shear: Jet, axial: Jet) -> Jet {
        match &self.rubber {
            Rubber::Ogden(ogden) => {
                let plane = (hoop + shear + axial) * 0.5;
                let difference = hoop + shear - axial;
                let split = difference * difference * 0.25 + shear * axial;
                let mut sum = Jet::constant(0.0);
                for term in ogden.0.terms() {
                    let half = 0.5 * term.alpha;
                    let pair = pair_of_powers(half, plane.value, split.value);
                    let powers = radial.powf(half) + Jet::compose2(plane, split, pair);
                    sum = sum + (powers - Jet::constant(3.0)) * term.factor;
                }
                sum
            }
            Rubber::LinearElastic(material) => {
                // mu (|e|^2 - (tr e)^2/3), e_theta,z = sqrt(shear)/2.
                let [r, h, l] = [radial, hoop, axial].map(|square| square.powf(0.5) - Jet::constant(1.0));
                let trace = r + h + l;
                let shape = r * r + h * h + l * l + shear * 0.5 - trace * trace * (1.0 / 3.0);
                shape * material.shear_modulus
            }
            Rubber::NeoHookean(material) => invariant_energy(&material.0, radial, hoop, shear, axial),
            Rubber::MooneyRivlin(material) => invariant_energy(&material.0, radial, hoop, shear, axial),
            Rubber::Yeoh(material) => invariant_energy(&material.0, radial, hoop, shear, axial),
            Rubber::Gent(material) => invariant_energy(&material.0, radial, hoop, shear, axial),
            Rubber::ArrudaBoyce(material) => invariant_energy(&material.0, radial, hoop, shear, axial),
            Rubber::StVenantKirchhoff(material) => invariant_energy(&material.0, radial, hoop, shear, axial),
        }
    }

    /// The free, closed tube at a pressure (Pa), followed from rest: stretch, expansion and twist of a right-handed winding.
    /// Errors above the limit pressure.
    pub fn free_state(&self, pressure: f64) -> Result<FreeState, ClosedFormError> {
        let mut at = Unknowns::new(1.0, 1.0, 0.0);
        let (mut done, mut step) = (0.0, pressure);
        loop {
            let goal = if (pressure - done).abs() <= step.abs() { pressure } else { done + step };
            match self.minimise(goal, at) {
                Some((found, residual)) => {
                    at = found;
                    done = goal;
                    if done == pressure {
                        return Ok(self.state(pressure, &at, residual));
                    }
                }
                None if step.abs() < 1e-9 * pressure.abs() => {
                    return Err(ClosedFormError::NoEquilibrium { pressure, last: done });
                }
                None => step *= 0.5,
            }
        }
    }

    /// Newton's minimum near a state; `None` when it wanders off or stops at a state that is not stable.
    fn minimise(&self, pressure: f64, start: Unknowns) -> Option<(Unknowns, f64)> {
        let mut at = start;
        for _ in 0..30 {
            let phi = self.enthalpy(pressure, &at);
            let factor = phi.hessian.cholesky()?;
            let step = factor.solve(&-phi.gradient);
            if step.amax() > 0.3 {
                return None;
            }
            at += step;
            if step.amax() < TOLERANCE {
                let scale = self.stress_unit * self.inner_radius * self.inner_radius;
                return Some((at, self.enthalpy(pressure, &at).gradient.amax() / scale));
            }
        }
        None
    }

    /// Limit state of the free, closed tube: the greatest pressure of the path from rest, which is followed by the inner
    /// radius. `None` when the pressure still rises at four times the radius.
    pub fn limit_state(&self) -> Option<FreeState> {
        let mut best = (0.0, 0.0, Unknowns::new(1.0, 1.0, 0.0));
        let mut last = (Unknowns::new(1.0, 1.0, 0.0), 0.0);
        let mut radius = 1.0;
        loop {
            radius += 0.005;
            if radius > 4.0 {
                return None;
            }
            let (at, pressure) = self.at_radius(radius, last)?;
            if pressure < best.1 {
                break;
            }
            best = (radius, pressure, at);
            last = (at, pressure);
        }
        // Golden section on the bracket of three radii.
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let (mut low, mut high) = (best.0 - 0.005, radius);
        while high - low > 1e-7 {
            let [left, right] = [high - golden * (high - low), low + golden * (high - low)];
            let [at_left, at_right] = [self.at_radius(left, last)?, self.at_radius(right, last)?];
            if at_left.1 < at_right.1 { low = left } else { high = right }
        }
        let (at, pressure) = self.at_radius(0.5 * (low + high), last)?;
        Some(self.state(pressure, &at, 0.0))
    }

    /// Equilibrium (state and pressure) of the free tube at a given a/A, near another one.
    fn at_radius(&self, radius: f64, near: (Unknowns, f64)) -> Option<(Unknowns, f64)> {
        let a2 = self.inner_radius * self.inner_radius;
        let scale = self.stress_unit;
        let (mut at, mut pressure) = near;
        at[0] = radius * radius;
        for _ in 0..30 {
            let phi = self.enthalpy(pressure, &at);
            // Unknowns stretch, twist, pressure/scale; d Phi/dp = -pi A^2 area stretch.
            let mut matrix = phi.hessian;
            matrix.set_column(0, &(Vector3::new(-at[1], -at[0], 0.0) * (PI * a2 * scale)));
            let step = matrix.lu().solve(&-phi.gradient)?;
            pressure += step[0] * scale;
            at += Vector3::new(0.0, step[1], step[2]);
            if step.amax() < TOLERANCE {
                return Some((at, pressure));
            }
        }
        None
    }

    fn state(&self, pressure: f64, at: &Unknowns, residual: f64) -> FreeState {
        let ratio2 = (self.inner_radius / self.outer_radius).powi(2);
        FreeState {
            pressure,
            axial_stretch: at[1],
            expansion: ((at[0] + (1.0 / ratio2 - 1.0) / at[1]) * ratio2).sqrt(),
            twist_per_length: at[2] / self.outer_radius,
            residual,
            middle: None,
            section: None,
            mesh_error: None,
        }
    }

    /// The response at a gauge pressure (Pa), stretch and twist per reference length (rad/m): Phi is minimised over the inner
    /// radius. `None` when the tube has no stable radius there (it balloons).
    pub fn section(
        &self,
        pressure: f64,
        axial_stretch: f64,
        twist_per_length: f64,
    ) -> Option<SectionResponse> {
        if !(pressure.is_finite() && axial_stretch > 0.0 && twist_per_length.is_finite()) {
            return None;
        }
        let mut at = Unknowns::new(1.0 / axial_stretch, axial_stretch, twist_per_length * self.outer_radius);
        let mut bracket = (0.0, f64::INFINITY);
        // The wall must not turn inside out, and Newton's step is bounded because a fibre that tightens stiffens it suddenly.
        for _ in 0..100 {
            let phi = self.enthalpy(pressure, &at);
            let (slope, curvature) = (phi.gradient[0], phi.hessian[(0, 0)]);
            if !(slope.is_finite() && curvature.is_finite()) {
                return None;
            }
            // Past the greatest pressure that the wall holds: what lies beyond is another branch, if anything.
            if curvature <= 0.0 && slope < 0.0 {
                return None;
            }
            if slope < 0.0 {
                bracket.0 = at[0]
            } else {
                bracket.1 = at[0]
            }
            let step = if curvature > 0.0 { -slope / curvature } else { -slope.signum() };
            let mut step = step.clamp(-0.05 * at[0], 0.05 * at[0]);
            // Across the radius where the fibres tighten Newton's method could go to and fro for ever.
            let next = at[0] + step;
            if !(next > bracket.0 && next < bracket.1) && step.abs() > TOLERANCE * at[0] {
                step = 0.5 * (bracket.0 + bracket.1) - at[0];
            }
            at[0] += step;
            if step.abs() < TOLERANCE * at[0] {
                let phi = self.enthalpy(pressure, &at);
                return (phi.hessian[(0, 0)] > 0.0).then(|| self.condense(&phi));
            }
        }
        None
    }

    /// Eliminates the radius: K - k k^T / k_rr, then back to dimensions.
    fn condense(&self, phi: &Jet) -> SectionResponse {
        let h: &Matrix3<f64> = &phi.hessian;
        let condensed = |i: usize, j: usize| h[(i, j)] - h[(i, 0)] * h[(j, 0)] / h[(0, 0)];
        let b = self.outer_radius;
        let coupling = b * condensed(1, 2);
        SectionResponse {
            energy: phi.value,
            force: phi.gradient[1],
            torque: b * phi.gradient[2],
            stiffness: [[condensed(1, 1), coupling], [coupling, b * b * condensed(2, 2)]],
        }
    }
}

impl SectionLaw for ThickTube {
    /// Where the tube has no stable radius, every number of the response is NaN.
    fn respond(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> SectionResponse {
        let nan = f64::NAN;
        self.section(pressure, axial_stretch, twist_per_length).unwrap_or(SectionResponse {
            energy: nan,
            force: nan,
            torque: nan,
            stiffness: [[nan; 2]; 2],
        })
    }
}

/// W(I1, I2) of the F of [`ThickTube::energy`]: the block of hoop and axis has the determinant 1/sqrt(radial).
fn invariant_energy<M: InvariantEnergy>(material: &M, radial: Jet, hoop: Jet, shear: Jet, axial: Jet) -> Jet {
    let plane = hoop + shear + axial;
    let first = radial + plane;
    let second = if M::SECOND_INVARIANT { hoop * axial + radial * plane } else { Jet::constant(3.0) };
    let InvariantDerivatives { energy, first: [w1, w2], second: [w11, w12, w22] } =
        material.derivatives(first.value, second.value);
    Jet::compose2(first, second, [energy, w1, w2, w11, w12, w22])
}

/// `(m + d)^e + (m - d)^e` with `q = d^2` and its derivatives: value, g_m, g_q, g_mm, g_mq, g_qq.
///
/// Even in d, hence smooth in q through q = 0, where the two principal stretches meet (the state of rest); there it is summed as
/// the series `2 sum_k binomial(e, 2k) m^(e - 2k) q^k`.
fn pair_of_powers(e: f64, m: f64, q: f64) -> [f64; 6] {
    if q < 0.01 * m * m {
        let mut g = [0.0; 6];
        let mut term = 2.0 * m.powf(e);
        let ratio = q / (m * m);
        // 1e-2^9 is below rounding.
        for k in 0..10 {
            let (n, left) = (k as f64, e - 2.0 * k as f64);
            // term = c m^left; powers of q are multiplied in as they are needed.
            let q_k = ratio.powi(k);
            let q_k1 = if k >= 1 { n * ratio.powi(k - 1) / (m * m) } else { 0.0 };
            let q_k2 = if k >= 2 { n * (n - 1.0) * ratio.powi(k - 2) / m.powi(4) } else { 0.0 };
            g[0] += term * q_k;
            g[1] += term * q_k * left / m;
            g[2] += term * q_k1;
            g[3] += term * q_k * left * (left - 1.0) / (m * m);
            g[4] += term * q_k1 * left / m;
            g[5] += term * q_k2;
            term *= left * (left - 1.0) / ((2.0 * n + 1.0) * (2.0 * n + 2.0));
        }
        return g;
    }
    let d = q.sqrt();
    let (upper, lower) = (m + d, m - d);
    let [h, h1, h2] = [
        [upper.powf(e), lower.powf(e)],
        [e * upper.powf(e - 1.0), e * lower.powf(e - 1.0)],
        [e * (e - 1.0) * upper.powf(e - 2.0), e * (e - 1.0) * lower.powf(e - 2.0)],
    ];
    let slope = (h1[0] - h1[1]) / (2.0 * d);
    [
        h[0] + h[1],
        h1[0] + h1[1],
        slope,
        h2[0] + h2[1],
        (h2[0] - h2[1]) / (2.0 * d),
        (h2[0] + h2[1]) / (4.0 * q) - slope / (2.0 * q),
    ]
}

/// Points in (-1, 1) and weights of Gauss's rule, by Newton's method on the Legendre polynomial.
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (mut previous, mut value) = (1.0, x);
                for k in 2..=count {
                    let k = k as f64;
                    (previous, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k);
                }
                slope = n * (x * value - previous) / (x * x - 1.0);
                let step = value / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
#[path = "closed_form_tests.rs"]
mod tests;
