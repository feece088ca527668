use super::{Answer, Hyperelastic, Tangent, flat};
use actuator::OgdenForm;
use nalgebra::{Matrix3, SVector};

/// W = c (l1^alpha + l2^alpha + l3^alpha - 3) of the principal stretches l, with c = 2 mu/alpha^2 or, as the paper prints
/// it, 2 mu/alpha.
///
/// Alone it is not at rest at F = 1: it is meant for incompressible rubber, inside [`super::Isochoric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ogden {
    /// c, Pa.
    factor: f64,
    /// The exponent alpha.
    alpha: f64,
}

impl Ogden {
    /// The term of parameter `shear_modulus` (mu, Pa) and exponent `alpha` (not zero).
    pub fn new(shear_modulus: f64, alpha: f64, form: OgdenForm) -> Self {
        let factor = match form {
            OgdenForm::InitialModulus => 2.0 * shear_modulus / (alpha * alpha),
            OgdenForm::Printed => 2.0 * shear_modulus / alpha,
        };
        Ogden { factor, alpha }
    }
}

/// (x^m - y^m)/(x - y) for positive x and y, exact to rounding however close they are; m y^(m-1) where they meet.
fn divided_difference_of_power(x: f64, y: f64, m: f64) -> f64 {
    let log_ratio = ((x - y) / y).ln_1p();
    let slope = if log_ratio == 0.0 { m } else { (m * log_ratio).exp_m1() / log_ratio.exp_m1() };
    slope * y.powf(m - 1.0)
}

impl Hyperelastic for Ogden {
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        // With C = F^T F = sum of c_a N_a N_a: W = c sum(c_a^(alpha/2) - 1), S = 2 dW/dC = sum of s_a N_a N_a with
        // s_a = c alpha c_a^m, m = alpha/2 - 1. In the frame of the N_a, dS_ab = D_ab dC_ab with D_ab the divided difference of
        // s between c_a and c_b: no case of equal stretches is special, and any frame of equal ones serves.
        let f = deformation_gradient;
        let eigen = f.tr_mul(f).symmetric_eigen();
        let (c, n) = (eigen.eigenvalues, eigen.eigenvectors);
        let m = 0.5 * self.alpha - 1.0;
        let coefficient = self.factor * self.alpha;
        let power = c.map(|value| value.powf(m));
        let energy = self.factor * (power.dot(&c) - 3.0);
        let s = n * Matrix3::from_diagonal(&(coefficient * power)) * n.transpose();

        // dP = dF S + F dS and dC_ab = g_a.(dF N_b) + g_b.(dF N_a) with g = F N.
        let g = f * n;
        let mut tangent = Tangent::zeros();
        for i in 0..3 {
            for j in 0..3 {
                for l in 0..3 {
                    tangent[(flat(i, j), flat(i, l))] = s[(j, l)];
                }
            }
        }
        for a in 0..3 {
            for b in a..3 {
                let mut direction = SVector::<f64, 9>::zeros();
                for i in 0..3 {
                    for j in 0..3 {
                        direction[flat(i, j)] = g[(i, a)] * n[(j, b)] + g[(i, b)] * n[(j, a)];
                    }
                }
                let weight = if a == b { 0.5 } else { 1.0 };
                let slope = coefficient * divided_difference_of_power(c[a], c[b], m);
                tangent.ger(weight * slope, &direction, &direction, 1.0);
            }
        }
        Answer { energy, stress: f * s, tangent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divided_differences_are_exact_for_close_and_equal_numbers() {
        // x^3 has (x^3 - y^3)/(x - y) = x^2 + xy + y^2 without cancellation.
        for gap in [0.0, 1e-16, 1e-12, 1e-8, 1e-3, 0.7] {
            let (x, y) = (1.3 + gap, 1.3);
            let exact = x * x + x * y + y * y;
            assert!((divided_difference_of_power(x, y, 3.0) / exact - 1.0).abs() < 1e-14, "gap {gap}");
        }
    }
}
