//! Rigid motions H = (rotation, position) and their logarithms d = (translation, rotation) in R^6, translation first, as seen
//! from the moving frame: a perturbation is H exp(xi).

use nalgebra::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// A cross-section's frame in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Rotation from the section's frame to the base frame.
    pub rotation: UnitQuaternion<f64>,
    /// Position of the section's centre, m.
    pub position: Vector3<f64>,
}

/// Translation and rotation halves.
pub(crate) fn halves(d: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (d.fixed_rows::<3>(0).into(), d.fixed_rows::<3>(3).into())
}

pub(crate) fn joined(translation: Vector3<f64>, rotation: Vector3<f64>) -> Vector6<f64> {
    Vector6::new(translation.x, translation.y, translation.z, rotation.x, rotation.y, rotation.z)
}

/// `A = (1 - cos)/angle^2` and `B = (angle - sin)/angle^3` with their derivatives in angle^2, as series of `square = angle^2`;
/// entire functions, and 30 terms hold 13 digits up to a full turn.
pub(crate) fn exponential_coefficients(square: f64) -> [f64; 4] {
    let (mut a, mut b, mut a1, mut b1) = (0.0, 0.0, 0.0, 0.0);
    // (-square)^k / (2k + 2)! and, for the slopes, its derivative.
    let (mut term, mut slope) = (0.5, 0.0);
    for k in 0..30 {
        let n = k as f64;
        a += term;
        a1 += slope;
        b += term / (2.0 * n + 3.0);
        b1 += slope / (2.0 * n + 3.0);
        let divisor = (2.0 * n + 3.0) * (2.0 * n + 4.0);
        slope = -(slope * square + term) / divisor;
        term *= -square / divisor;
    }
    [a, b, a1, b1]
}

impl Frame {
    /// H exp(xi).
    pub(crate) fn moved(&self, xi: &Vector6<f64>) -> Frame {
        let (v, w) = halves(xi);
        let [a, b, ..] = exponential_coefficients(w.norm_squared());
        let shift = v + w.cross(&v) * a + w.cross(&w.cross(&v)) * b;
        let mut rotation = self.rotation * UnitQuaternion::from_scaled_axis(w);
        rotation.renormalize();
        Frame { rotation, position: self.position + self.rotation * shift }
    }

    /// log(H^-1 other): rotation below pi.
    pub(crate) fn log_to(&self, other: &Frame) -> Vector6<f64> {
        let w = (self.rotation.inverse() * other.rotation).scaled_axis();
        let x = self.rotation.inverse_transform_vector(&(other.position - self.position));
        let c = log_coefficients(w.norm_squared()).translation;
        joined(x - w.cross(&x) * 0.5 + w.cross(&w.cross(&x)) * c, w)
    }
}

/// zeta(2), zeta(4), ...: by zeta(2n) = 2/(2n + 1) sum_k zeta(2k) zeta(2n - 2k).
static ZETA: LazyLock<[f64; 33]> = LazyLock::new(|| {
    let mut zeta = [PI * PI / 6.0; 33];
    for n in 2..=33 {
        let sum: f64 = (1..n).map(|k| zeta[k - 1] * zeta[n - k - 1]).sum();
        zeta[n - 1] = 2.0 * sum / (2 * n + 1) as f64;
    }
    zeta
});

/// Coefficients of the inverse Jacobians of the exponential.
struct LogCoefficients {
    /// `log` of a translation: `x - w x x / 2 + c w x (w x x)`.
    translation: f64,
    /// Of ad^2, of ad^4, and their derivatives in angle^2.
    second: [f64; 2],
    fourth: [f64; 2],
}

/// With `x = (angle/2 pi)^2`: `c = 2 sum zeta(2n) x^n/angle^2`, `A = sum (4 - 2n) zeta(2n) x^n/angle^2`,
/// `B = sum (2 - 2n) zeta(2n) x^n/angle^4` (from (y/2) cot(y/2) = 1 - 2 sum zeta(2n) x^n). At angles below pi, x < 1/4, and 33
/// terms hold all digits.
fn log_coefficients(square: f64) -> LogCoefficients {
    const UNIT: f64 = TAU * TAU;
    let x = square / UNIT;
    // sum_n>=from factor(n) zeta(2n) x^(n - from) and its derivative, by Horner's rule from the highest term.
    let sum = |from: usize, factor: fn(f64) -> f64| {
        let mut pair = [0.0; 2];
        for (index, zeta) in ZETA.iter().enumerate().skip(from - 1).rev() {
            pair[1] = pair[1] * x + pair[0];
            pair[0] = pair[0] * x + factor((index + 1) as f64) * zeta;
        }
        pair
    };
    let (second, fourth) = (sum(1, |n| 4.0 - 2.0 * n), sum(2, |n| 2.0 - 2.0 * n));
    LogCoefficients {
        translation: sum(1, |_| 2.0)[0] / UNIT,
        second: [second[0] / UNIT, second[1] / (UNIT * UNIT)],
        fourth: [fourth[0] / (UNIT * UNIT), fourth[1] / (UNIT * UNIT * UNIT)],
    }
}

/// The matrix C(f) with `ad_e^T f = C(f) e`.
fn coadjoint(f: &Vector6<f64>) -> Matrix6<f64> {
    let (force, moment) = halves(f);
    let mut matrix = Matrix6::zeros();
    let cross = force.cross_matrix();
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&cross);
    matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&cross);
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&moment.cross_matrix());
    matrix
}

/// How the logarithm d = log(H_a^-1 H_b) varies: `delta d = right^T xi_b - left^T xi_a`, and how a force `f` pulled back by
/// it varies with d.
pub(crate) struct LogVariation {
    /// J_r^-T(d) = I + ad^T/2 + A ad^T^2 + B ad^T^4.
    pub right: Matrix6<f64>,
    /// J_l^-T(d), the same with -1/2.
    pub left: Matrix6<f64>,
    /// d(J_r^-T f)/dd at constant f.
    pub right_slope: Matrix6<f64>,
    /// d(J_l^-T f)/dd at constant f.
    pub left_slope: Matrix6<f64>,
}

impl LogVariation {
    pub fn new(d: &Vector6<f64>, f: &Vector6<f64>) -> Self {
        let (v, w) = halves(d);
        let LogCoefficients { second, fourth, .. } = log_coefficients(w.norm_squared());
        let mut ad = Matrix6::zeros();
        let minus_w: Matrix3<f64> = -w.cross_matrix();
        ad.fixed_view_mut::<3, 3>(0, 0).copy_from(&minus_w);
        ad.fixed_view_mut::<3, 3>(3, 3).copy_from(&minus_w);
        ad.fixed_view_mut::<3, 3>(3, 0).copy_from(&-v.cross_matrix());
        let ad2 = ad * ad;
        let even = Matrix6::identity() + ad2 * second[0] + ad2 * ad2 * fourth[0];
        let half = ad * 0.5;
        let f1 = ad * f;
        let f2 = ad * f1;
        let f3 = ad * f2;
        let f4 = ad * f3;
        let c = coadjoint(f);
        let c1 = coadjoint(&f1);
        let pair = c1 + ad * c;
        // The derivative of ad^4 f: four places for the varied ad.
        let four = coadjoint(&f3) + ad * coadjoint(&f2) + ad2 * pair;
        let along_w = joined(Vector3::zeros(), w * 2.0);
        let even_slope =
            pair * second[0] + four * fourth[0] + (f2 * second[1] + f4 * fourth[1]) * along_w.transpose();
        LogVariation {
            right: even + half,
            left: even - half,
            right_slope: even_slope + c * 0.5,
            left_slope: even_slope - c * 0.5,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> [Vector6<f64>; 4] {
        [
            Vector6::new(0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
            Vector6::new(0.1, -0.2, 1.1, 1e-5, 2e-5, -1e-5),
            Vector6::new(0.3, 0.1, 0.9, 0.4, -0.7, 0.2),
            Vector6::new(-0.3, 0.4, 1.2, 1.2, -1.0, 2.1),
        ]
    }

    const ORIGIN: Frame = Frame {
        rotation: UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.0, 0.0, 0.0, 0.0)),
        position: Vector3::new(0.0, 0.0, 0.0),
    };

    #[test]
    fn logarithm_returns_the_exponent() {
        let start = ORIGIN.moved(&Vector6::new(1.0, 2.0, 3.0, -0.5, 0.8, 1.5));
        for d in samples() {
            assert!((start.log_to(&start.moved(&d)) - d).amax() < 1e-13, "{d}");
        }
    }

    #[test]
    fn logarithm_varies_as_said() {
        let f = Vector6::new(0.3, -1.0, 2.0, 0.7, 0.4, -0.9);
        for d in samples() {
            let (a, b) = (ORIGIN, ORIGIN.moved(&d));
            let vary = LogVariation::new(&d, &f);
            // Fourth-order differences with step 1e-3: truncation and rounding below 1e-11.
            let h = 1e-3;
            for i in 0..6 {
                let mut unit = Vector6::zeros();
                unit[i] = 1.0;
                let slope = |value: &dyn Fn(f64) -> Vector6<f64>| {
                    (value(-2.0 * h) - value(-h) * 8.0 + value(h) * 8.0 - value(2.0 * h)) / (12.0 * h)
                };
                let right = slope(&|e| a.log_to(&b.moved(&(unit * e))));
                assert!((right - vary.right.transpose().column(i)).amax() < 1e-10, "{d} {i}");
                let left = slope(&|e| a.moved(&(unit * e)).log_to(&b));
                assert!((left + vary.left.transpose().column(i)).amax() < 1e-10, "{d} {i}");
                let pulled = slope(&|e| LogVariation::new(&(d + unit * e), &f).right * f);
                assert!((pulled - vary.right_slope.column(i)).amax() < 1e-10, "{d} {i}");
                let pulled = slope(&|e| LogVariation::new(&(d + unit * e), &f).left * f);
                assert!((pulled - vary.left_slope.column(i)).amax() < 1e-10, "{d} {i}");
            }
        }
    }
}
