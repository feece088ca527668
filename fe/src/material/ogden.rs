use super::{Answer, Hyperelastic, Tangent, eigen::symmetric_eigen, flat};
use actuator::{OgdenForm, OgdenTerm, OgdenTerms};
use nalgebra::{Matrix3, SVector, Vector3};

/// W = sum over the terms of c (l1^alpha + l2^alpha + l3^alpha - 3) of the principal stretches l, with c = 2 mu/alpha^2 or, as
/// the paper prints it, 2 mu/alpha.
///
/// Alone it is not at rest at F = 1: it is meant for incompressible rubber, inside [`super::Isochoric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ogden {
    terms: [Term; OgdenTerms::MOST],
    count: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Term {
    /// c, Pa.
    pub factor: f64,
    /// The exponent alpha.
    pub alpha: f64,
}

impl Ogden {
    /// The single term of parameter `shear_modulus` (mu, Pa) and exponent `alpha` (not zero).
    pub fn new(shear_modulus: f64, alpha: f64, form: OgdenForm) -> Self {
        let factor = match form {
            OgdenForm::InitialModulus => 2.0 * shear_modulus / (alpha * alpha),
            OgdenForm::Printed => 2.0 * shear_modulus / alpha,
        };
        let mut terms = [Term::default(); OgdenTerms::MOST];
        terms[0] = Term { factor, alpha };
        Ogden { terms, count: 1 }
    }

    /// Several terms of the form 2 mu/alpha^2.
    pub fn series(given: &OgdenTerms) -> Self {
        let mut terms = [Term::default(); OgdenTerms::MOST];
        for (term, OgdenTerm { shear_modulus, alpha }) in terms.iter_mut().zip(given.as_slice()) {
            *term = Term { factor: 2.0 * shear_modulus / (alpha * alpha), alpha: *alpha };
        }
        Ogden { terms, count: given.as_slice().len() }
    }

    pub(crate) fn terms(&self) -> &[Term] {
        &self.terms[..self.count]
    }

    #[inline]
    fn spectral_answer(&self, f: &Matrix3<f64>, isochoric: bool) -> Answer {
        // With C = F^T F = sum of c_a N_a N_a: S = 2 dW/dC = sum of s_a N_a N_a. In the frame of the N_a, dS_aa = sum of
        // M_ab dC_bb with M the derivatives of s by c, and dS_ab = D_ab dC_ab with D_ab the divided difference of s between c_a
        // and c_b: no case of equal stretches is special, and any frame of equal ones serves.
        let (c, n) = symmetric_eigen(&f.tr_mul(f));
        if c.min().is_nan() || c.min() <= 0.0 {
            return Answer::NAN;
        }
        let log = c.map(f64::ln);
        let log_volume = if isochoric { log.sum() / 3.0 } else { 0.0 };
        // Of all terms: t_a = l_a dW/dl_a = sum of c alpha q_a with q = l^alpha, T_a = dt_a/d(ln c_a), and the divided
        // differences of t/c between c_a and c_b (pairs 01, 02, 12).
        let mut energy = 0.0;
        let (mut t, mut slope, mut divided) = (Vector3::zeros(), Vector3::zeros(), [0.0; 3]);
        for Term { factor, alpha } in self.terms() {
            let half = 0.5 * alpha;
            let power = log.map(|log| (half * (log - log_volume)).exp());
            let coefficient = factor * alpha;
            energy += factor * (power.sum() - 3.0);
            t += coefficient * power;
            slope += coefficient * half * power;
            for (divided, (a, b)) in divided.iter_mut().zip(PAIRS) {
                let ratio =
                    divided_difference([c[a], c[b]], [log[a], log[b]], [power[a], power[b]], half - 1.0);
                *divided += coefficient * ratio;
            }
        }
        // Without change of volume c becomes J^(-2/3) c: s_a = (t_a - mean t)/c_a, and ln c_b acts on t_a as d_ab - 1/3.
        let (mean, mean_slope) = if isochoric { (t.mean(), slope.mean()) } else { (0.0, 0.0) };
        let third = if isochoric { 1.0 / 3.0 } else { 0.0 };
        let s = (t.add_scalar(-mean)).component_div(&c);
        let normal = Matrix3::from_fn(|a, b| {
            let own = if a == b { slope[a] - (t[a] - mean) } else { 0.0 };
            (own - third * (slope[a] + slope[b] - mean_slope)) / (c[a] * c[b])
        });

        // dP = dF S + F dS and dC_ab = g_a.(dF N_b) + g_b.(dF N_a) with g = F N.
        let g = f * n;
        let mut second_piola = Matrix3::zeros();
        for a in 0..3 {
            second_piola += s[a] * n.column(a) * n.column(a).transpose();
        }
        let mut tangent = Tangent::zeros();
        for i in 0..3 {
            for j in 0..3 {
                for l in 0..3 {
                    tangent[(flat(i, j), flat(i, l))] = second_piola[(j, l)];
                }
            }
        }
        let product = |a: usize, b: usize| -> SVector<f64, 9> {
            SVector::from_fn(|index, _| g[(index / 3, a)] * n[(index % 3, b)])
        };
        let own: [SVector<f64, 9>; 3] = std::array::from_fn(|a| product(a, a));
        for a in 0..3 {
            let mixed = normal[(a, 0)] * own[0] + normal[(a, 1)] * own[1] + normal[(a, 2)] * own[2];
            tangent.ger(2.0, &own[a], &mixed, 1.0);
        }
        for (divided, (a, b)) in divided.iter().zip(PAIRS) {
            let direction = product(a, b) + product(b, a);
            tangent.ger(divided + mean / (c[a] * c[b]), &direction, &direction, 1.0);
        }
        Answer { energy, stress: f * second_piola, tangent }
    }
}

const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// (p/x - q/y)/(x - y) for p = k x^(m + 1), q = k y^(m + 1), exact to rounding however close x and y are; m p/x^2 where they meet.
#[inline]
fn divided_difference([x, y]: [f64; 2], [log_x, log_y]: [f64; 2], [p, q]: [f64; 2], m: f64) -> f64 {
    let difference = x - y;
    // Far apart nothing cancels.
    if (m * (log_x - log_y)).abs() > 0.5 {
        return (p / x - q / y) / difference;
    }
    let relative = difference / y;
    let log_ratio = if relative.abs() < 0.5 { relative.ln_1p() } else { log_x - log_y };
    let slope = if log_ratio == 0.0 { m } else { (m * log_ratio).exp_m1() / relative };
    slope * q / (y * y)
}

impl Hyperelastic for Ogden {
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        self.spectral_answer(deformation_gradient, false)
    }

    fn isochoric_answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        let volume_ratio = deformation_gradient.determinant();
        if volume_ratio.is_nan() || volume_ratio <= 0.0 {
            return Answer::NAN;
        }
        self.spectral_answer(deformation_gradient, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divided_differences_are_exact_for_close_and_equal_numbers() {
        // x^3 has (x^3 - y^3)/(x - y) = x^2 + xy + y^2 without cancellation.
        for gap in [0.0, 1e-16, 1e-12, 1e-8, 1e-3, 0.1, 0.7, 5.0] {
            let (x, y): (f64, f64) = (1.3 + gap, 1.3);
            let exact = x * x + x * y + y * y;
            let found = divided_difference([x, y], [x.ln(), y.ln()], [x.powi(4), y.powi(4)], 3.0);
            assert!((found / exact - 1.0).abs() < 1e-14, "gap {gap}: {found} {exact}");
        }
    }
}
