//! A module with a closed-form pose: an arc of constant curvature whose length, bend and twist are polynomials of the
//! pressures. Stands in for a fitted model in tests and examples.
#![allow(dead_code)]

use actuator::PoseChart;
use rom::{OutOfDomain, PoseEvaluation, PoseModel};

pub const LENGTH: f64 = 0.17;

/// FREEs on a circle, each with a hand (+1 or -1) and its own share of everything.
pub struct AnalyticModule {
    domain: Vec<(f64, f64)>,
    /// Direction of each FREE from the module's axis.
    directions: Vec<[f64; 2]>,
    /// Twist (rad) at full pressure that each FREE adds, signed.
    twists: Vec<f64>,
    /// Exponent 1: slopes at rest do not vanish; 2: they do.
    first_power: f64,
}

impl AnalyticModule {
    /// FREEs of the given twists (rad at 70 kPa), domain 0 to 70 kPa.
    pub fn new(twists: &[f64]) -> Self {
        let n = twists.len();
        let directions = (0..n)
            .map(|free| (std::f64::consts::TAU * (free as f64 + 0.5) / n as f64).sin_cos())
            .map(|(sine, cosine)| [cosine, sine])
            .collect();
        AnalyticModule { domain: vec![(0.0, 70e3); n], directions, twists: twists.to_vec(), first_power: 1.0 }
    }

    /// Four FREEs, right and left in turn.
    pub fn alternating() -> Self {
        Self::new(&[-1.1, 1.0, -0.9, 1.05])
    }

    /// Four right-handed FREEs that turn the tip by more than a turn.
    pub fn all_right() -> Self {
        Self::new(&[-2.4, -2.2, -2.5, -2.3])
    }

    /// The same with pressures that do nothing to first order at rest.
    pub fn flat_at_rest(mut self) -> Self {
        self.first_power = 0.0;
        self
    }
}

/// sin(t)/t, (1 - cos t)/t^2 and their derivatives with respect to q = t^2.
fn arc(q: f64) -> (f64, f64, f64, f64) {
    if q < 1e-4 {
        return (
            1.0 - q / 6.0 + q * q / 120.0,
            0.5 - q / 24.0 + q * q / 720.0,
            -1.0 / 6.0 + q / 60.0,
            -1.0 / 24.0 + q / 360.0,
        );
    }
    let t = q.sqrt();
    let (s, c) = (t.sin() / t, (1.0 - t.cos()) / q);
    (s, c, (t.cos() - s) / (2.0 * q), (0.5 * s - c) / q)
}

impl PoseModel for AnalyticModule {
    fn domain(&self) -> &[(f64, f64)] {
        &self.domain
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        let n = self.domain.len();
        let (mut twist, mut bend, mut length) = (0.0, [0.0; 2], LENGTH);
        let mut slopes = [[0.0; 4]; 8];
        for free in 0..n {
            let (pressure, (lower, upper)) = (pressures[free], self.domain[free]);
            if !(lower <= pressure && pressure <= upper) {
                return Err(OutOfDomain::Pressure { free, pressure, lower, upper });
            }
            let x = pressure / 70e3;
            let (first, second) = (self.first_power, 0.35);
            let share = 1.0 / n as f64;
            twist += self.twists[free] * (first * x + second * x * x);
            let dtwist = self.twists[free] * (first + 2.0 * second * x);
            // A FREE that lengthens bends the module away from itself; each is a little different.
            let strength = 1.3 + 0.1 * free as f64;
            let (ex, ey) = (self.directions[free][0], self.directions[free][1]);
            let (bending, dbending) = (strength * (first * x + 0.2 * x * x), strength * (first + 0.4 * x));
            bend[0] -= ey * bending;
            bend[1] += ex * bending;
            let (stretch, dstretch) = (0.25 * (first * x + 0.3 * x * x * x), 0.25 * (first + 0.9 * x * x));
            length += LENGTH * share * stretch;
            slopes[free] = [dtwist, -ey * dbending, ex * dbending, LENGTH * share * dstretch];
        }
        let q = bend[0] * bend[0] + bend[1] * bend[1];
        let (s, c, ds, dc) = arc(q);
        into.chart =
            PoseChart { twist, bend, position: [length * c * bend[1], -length * c * bend[0], length * s] };
        for (free, [dtwist, dbx, dby, dlength]) in slopes.into_iter().enumerate().take(n) {
            let dq = 2.0 * (bend[0] * dbx + bend[1] * dby);
            let per_pascal = [
                dtwist,
                dbx,
                dby,
                dlength * c * bend[1] + length * (dc * dq * bend[1] + c * dby),
                -dlength * c * bend[0] - length * (dc * dq * bend[0] + c * dbx),
                dlength * s + length * ds * dq,
            ]
            .map(|slope| slope / 70e3);
            into.jacobian[free] = per_pascal;
        }
        Ok(())
    }
}

/// Numbers from 0 to 1, the same each time (SplitMix64).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn pressures(&mut self, bounds: &control::Bounds) -> Vec<f64> {
        bounds
            .lower
            .iter()
            .zip(&bounds.upper)
            .map(|(lower, upper)| lower + (upper - lower) * self.next())
            .collect()
    }
}

/// Bounds from `lower` to `upper` (Pa) for every FREE.
pub fn bounds(frees: usize, lower: f64, upper: f64) -> control::Bounds {
    control::Bounds { lower: vec![lower; frees], upper: vec![upper; frees], limit: vec![70e3; frees] }
}

/// Chart at pressures.
pub fn chart_at(model: &impl PoseModel, pressures: &[f64]) -> PoseChart {
    let mut evaluation = PoseEvaluation::new(pressures.len(), 0);
    model.evaluate(pressures, &mut evaluation).unwrap();
    evaluation.chart
}
