//! Orders of convergence on a thick tube: displacements of third order, pressures of second.

use super::problem::{Mode, Problem};
use crate::{
    closed_form::gauss_legendre,
    material::Rubber,
    solid::{element::ElementLaw, shape::interpolation},
};
use actuator::{Elastomer, OgdenForm};

/// Exponent of Ogden's energy, shear modulus 1.
const ALPHA: f64 = 1.2;
/// Tube 1 <= R <= 2, bore widened to 1.4, stretched by 1.1.
const INNER: f64 = 1.0;
const OUTER: f64 = 2.0;
const BORE: f64 = 1.4;
const STRETCH: f64 = 1.1;

/// r(R) of the incompressible tube.
fn radius(reference: f64) -> f64 {
    (BORE * BORE + (reference * reference - INNER * INNER) / STRETCH).sqrt()
}

/// Powers `2/alpha lambda^alpha` of the stretches (radial, hoop, axial).
fn powers(reference: f64) -> [f64; 3] {
    let r = radius(reference);
    [reference / (STRETCH * r), r / reference, STRETCH].map(|stretch| 2.0 / ALPHA * stretch.powf(ALPHA))
}

/// Mean Cauchy stress: sigma_r + mean - power_r, with sigma_r = -integral from r to b of (sigma_theta - sigma_r)/r dr.
fn mean_stress(reference: f64) -> f64 {
    let half = 0.5 * (OUTER - reference);
    let radial: f64 = gauss_legendre(12)
        .into_iter()
        .map(|(at, weight)| {
            let place = reference + half * (1.0 + at);
            let [radial, hoop, _] = powers(place);
            // dr/r = R dR/(lambda r^2)
            -half * weight * (hoop - radial) * place / (STRETCH * radius(place).powi(2))
        })
        .sum();
    let [first, second, third] = powers(reference);
    radial + (first + second + third) / 3.0 - first
}

/// Relative L2 errors of displacement and pressure, and of the elements' mean pressures, with `n` elements through the wall.
///
/// Meshed is one element around (0.6/n rad) and one along. The solution is the same at all heights and for all elements around, and
/// symmetric about each element's middle plane, also the discrete one: its unknowns are the radii of the points at the
/// element's edge and in its middle.
fn errors(n: usize) -> [f64; 3] {
    let elastomer = Elastomer::Ogden { shear_modulus: 1.0, alpha: ALPHA, form: OgdenForm::InitialModulus };
    // 1/K is what the tube would differ by from the incompressible one.
    let law = ElementLaw { material: Rubber::from(elastomer), bulk: 1e7 };
    let size = 0.6 / n as f64;
    let problem = Problem::mapped([n, 1, 1], law, |share| {
        let (r, angle) = (INNER + (OUTER - INNER) * share[0], size * (share[1] - 0.5));
        [r * angle.cos(), r * angle.sin(), size * share[2]]
    });
    let exact = |x: [f64; 3]| {
        let reference = x[0].hypot(x[1]);
        let factor = radius(reference) / reference;
        [factor * x[0], factor * x[1], STRETCH * x[2]]
    };
    let lines = 2 * n + 1;
    let mut modes: Vec<Mode> = vec![vec![]; 2 * (lines - 1)];
    for (p, x) in problem.points.iter().enumerate() {
        let (i, j) = (p % lines, p / lines % 3);
        if i > 0 {
            let r = x[0].hypot(x[1]);
            modes[2 * (i - 1) + j % 2].push((p, [x[0] / r, x[1] / r, 0.0]));
        }
    }
    let mut x: Vec<[f64; 3]> = problem.points.iter().map(|&x| exact(x)).collect();
    let mut q = vec![[0.0; 4]; n];
    assert!(problem.equilibrate(&modes, &mut x, &mut q) < 1e-7);

    let [mut displacement, mut moved, mut pressure, mut size, mut means] = [0.0; 5];
    let rule = gauss_legendre(5);
    for ((element, shape), q) in problem.elements.iter().zip(&problem.shapes).zip(&q) {
        // The pressure's functions are 1 and X - middle over half the size: found again from their values.
        let mut middle = [0.0; 3];
        let half = 0.5 * shape.volume().cbrt();
        let [mut mean, mut mean_exact, mut volume] = [0.0; 3];
        let at = |values: &[f64; 27], x: &[[f64; 3]], i: usize| -> f64 {
            (0..27).map(|a| values[a] * x[element[a]][i]).sum()
        };
        let mut samples = vec![];
        for u in &rule {
            for v in &rule {
                for w in &rule {
                    let (values, slopes) = interpolation([u.0, v.0, w.0]);
                    let place: [f64; 3] = std::array::from_fn(|i| at(&values, &problem.points, i));
                    let j = nalgebra::Matrix3::from_fn(|i, m| at(&slopes[m], &problem.points, i));
                    let weight = u.1 * v.1 * w.1 * j.determinant();
                    let found: [f64; 3] = std::array::from_fn(|i| at(&values, &x, i));
                    volume += weight;
                    (0..3).for_each(|i| middle[i] += weight * place[i]);
                    samples.push((place, found, weight));
                }
            }
        }
        middle.iter_mut().for_each(|x| *x /= volume);
        for (place, found, weight) in samples {
            let right = exact(place);
            displacement += weight * (0..3).map(|i| (found[i] - right[i]).powi(2)).sum::<f64>();
            moved += weight * (0..3).map(|i| (right[i] - place[i]).powi(2)).sum::<f64>();
            let value = q[0] + (0..3).map(|i| q[i + 1] * (place[i] - middle[i]) / half).sum::<f64>();
            let right = mean_stress(place[0].hypot(place[1]));
            pressure += weight * (value - right).powi(2);
            size += weight * right * right;
            mean += weight * value;
            mean_exact += weight * right;
        }
        means += (mean - mean_exact).powi(2) / volume;
    }
    [(displacement / moved).sqrt(), (pressure / size).sqrt(), (means / size).sqrt()]
}

#[test]
fn displacements_converge_by_third_order_and_pressures_by_second() {
    let errors = [2, 4, 8, 16].map(errors);
    println!("L2 errors of displacement, pressure, mean pressure: {errors:?}");
    for (finer, pair) in errors.windows(2).enumerate() {
        let orders: [f64; 3] = std::array::from_fn(|i| (pair[0][i] / pair[1][i]).log2());
        println!("orders {orders:.3?}");
        assert!((orders[0] - 3.0).abs() < 0.2, "{errors:?}");
        assert!((orders[1] - 2.0).abs() < 0.2, "{errors:?}");
        // Means converge faster, down to 1/K = 1e-7.
        assert!(finer == 2 || orders[2] > 2.5, "{errors:?}");
    }
}
