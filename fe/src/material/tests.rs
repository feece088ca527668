//! One list of tests for every material.

use super::*;
use actuator::OgdenForm;
use nalgebra::{Rotation3, Vector3};

const MU: f64 = 0.393e6;

fn materials() -> Vec<(&'static str, Rubber, f64)> {
    let ogden = |alpha, form| Rubber::from(Elastomer::Ogden { shear_modulus: MU, alpha, form });
    vec![
        ("neo-Hookean", Rubber::from(Elastomer::NeoHookean { shear_modulus: MU }), MU),
        ("Ogden 0.8", ogden(0.8, OgdenForm::InitialModulus), MU),
        ("Ogden 1.2", ogden(1.2, OgdenForm::InitialModulus), MU),
        ("Ogden 2", ogden(2.0, OgdenForm::InitialModulus), MU),
        ("Ogden -1.5", ogden(-1.5, OgdenForm::InitialModulus), MU),
        ("Ogden 1.2 as printed", ogden(1.2, OgdenForm::Printed), 1.2 * MU),
    ]
}

fn rotation(x: f64, y: f64, z: f64) -> Matrix3<f64> {
    Rotation3::from_scaled_axis(Vector3::new(x, y, z)).into_inner()
}

/// General, compressed, sheared, with two and three equal stretches, and with nearly equal ones.
fn deformations() -> Vec<Matrix3<f64>> {
    let diagonal = |a, b, c| Matrix3::from_diagonal(&Vector3::new(a, b, c));
    let (left, right) = (rotation(0.3, -0.7, 1.1), rotation(-0.2, 0.5, 0.4));
    vec![
        Matrix3::new(1.1, 0.3, -0.2, 0.1, 0.8, 0.25, -0.15, 0.05, 1.4),
        left * diagonal(2.5, 0.6, 0.7) * right,
        Matrix3::new(1.0, 0.9, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        Matrix3::identity(),
        left * diagonal(1.3, 1.3, 0.6) * right,
        left * diagonal(1.3, 1.3 * (1.0 + 1e-9), 0.6) * right,
        left * diagonal(1.3, 1.3 * (1.0 + 1e-5), 1.3 * (1.0 - 1e-7)) * right,
    ]
}

/// Largest difference between `derivative` and central differences of `value`, relative to `scale`.
fn difference_error<const N: usize>(
    at: &Matrix3<f64>,
    scale: f64,
    value: impl Fn(&Matrix3<f64>) -> [f64; N],
    derivative: impl Fn(usize, usize) -> [f64; N],
) -> f64 {
    // Fourth-order differences: truncation (1e-3)^4 = 1e-12 and rounding 1e-16/1e-3 = 1e-13.
    let step = 1e-3;
    let mut worst: f64 = 0.0;
    for k in 0..3 {
        for l in 0..3 {
            let shifted = |steps: f64| {
                let mut moved = *at;
                moved[(k, l)] += steps * step;
                value(&moved)
            };
            let (p1, m1, p2, m2) = (shifted(1.0), shifted(-1.0), shifted(2.0), shifted(-2.0));
            let exact = derivative(k, l);
            for n in 0..N {
                let slope = (8.0 * (p1[n] - m1[n]) - (p2[n] - m2[n])) / (12.0 * step);
                worst = worst.max((slope - exact[n]).abs() / scale);
            }
        }
    }
    worst
}

fn flat_array(matrix: &Matrix3<f64>) -> [f64; 9] {
    std::array::from_fn(|index| matrix[(index / 3, index % 3)])
}

#[test]
fn stress_is_the_derivative_of_energy_and_tangent_that_of_stress() {
    for (name, material, _) in materials() {
        for f in deformations() {
            let stress = material.first_piola_kirchhoff_stress(&f);
            let error = difference_error(&f, MU, |f| [material.energy(f)], |k, l| [stress[(k, l)]]);
            assert!(error < 1e-9, "{name}: stress off by {error:e} mu at {f}");
            let tangent = material.tangent(&f);
            let error = difference_error(
                &f,
                MU,
                |f| flat_array(&material.first_piola_kirchhoff_stress(f)),
                |k, l| std::array::from_fn(|n| tangent[(n, flat(k, l))]),
            );
            // The sixth derivatives of l^alpha grow as the smallest stretch falls to 0.6: 1e-8 is their share.
            assert!(error < 1e-8, "{name}: tangent off by {error:e} mu at {f}");
            assert!(
                (tangent - tangent.transpose()).abs().max() < 1e-13 * tangent.abs().max(),
                "{name}: symmetry"
            );
        }
    }
}

#[test]
fn tangent_is_continuous_where_stretches_become_equal() {
    let (left, right) = (rotation(0.3, -0.7, 1.1), rotation(-0.2, 0.5, 0.4));
    let at = |gap: f64| left * Matrix3::from_diagonal(&Vector3::new(1.3, 1.3 + gap, 0.6)) * right;
    for (name, material, _) in materials() {
        let equal = material.tangent(&at(0.0));
        for gap in [1e-14, 1e-12, 1e-10, 1e-8, 1e-6] {
            let change = (material.tangent(&at(gap)) - equal).abs().max() / equal.abs().max();
            // The tangent itself changes by a few times the gap; rounding of the frame adds 1e-14.
            assert!(change < 10.0 * gap + 1e-13, "{name}: gap {gap:e} changed the tangent by {change:e}");
        }
    }
}

#[test]
fn energy_does_not_see_rigid_rotation_before_or_after() {
    let turn = rotation(0.9, -1.3, 0.4);
    for (name, material, _) in materials() {
        for f in deformations() {
            let energy = material.energy(&f);
            assert!((material.energy(&(turn * f)) - energy).abs() < 1e-13 * MU, "{name}: not objective");
            assert!((material.energy(&(f * turn)) - energy).abs() < 1e-13 * MU, "{name}: not isotropic");
            let turned = material.first_piola_kirchhoff_stress(&(turn * f));
            let expected = turn * material.first_piola_kirchhoff_stress(&f);
            assert!(
                (turned - expected).abs().max() < 1e-12 * MU,
                "{name}: stress does not turn with the body"
            );
        }
    }
}

#[test]
fn rest_has_no_energy_and_no_stress_and_volume_change_costs_nothing() {
    for (name, material, _) in materials() {
        for size in [0.7, 1.0, 1.6] {
            let answer = material.answer(&(size * rotation(0.1, 0.2, 0.3)));
            assert!(
                answer.energy.abs() < 1e-14 * MU && answer.stress.abs().max() < 1e-13 * MU,
                "{name} at {size}"
            );
        }
    }
}

#[test]
fn small_strains_show_the_initial_modulus_and_three_times_it_in_tension() {
    for (name, material, initial) in materials() {
        let tangent = material.tangent(&Matrix3::identity());
        let shear = tangent[(flat(0, 1), flat(0, 1))];
        assert!((shear / initial - 1.0).abs() < 1e-12, "{name}: shear modulus {shear}");
        // Incompressible tension l, l^(-1/2), l^(-1/2): nominal stress = dW/dl, slope at l = 1 is E = 3 mu.
        let energy = |l: f64| {
            let side = l.sqrt().recip();
            material.energy(&Matrix3::from_diagonal(&Vector3::new(l, side, side)))
        };
        let step = 1e-3;
        let young = (energy(1.0 + step) + energy(1.0 - step) - 2.0 * energy(1.0)) / (step * step);
        // Second difference: truncation of order step^2.
        assert!((young / (3.0 * initial) - 1.0).abs() < 1e-5, "{name}: E = {young}");
    }
}

#[test]
fn ogden_with_exponent_two_is_neo_hookean() {
    let all = materials();
    for f in deformations() {
        let (a, b) = (all[0].1.answer(&f), all[3].1.answer(&f));
        assert!((a.energy - b.energy).abs() < 1e-13 * MU);
        assert!((a.stress - b.stress).abs().max() < 1e-12 * MU);
        assert!((a.tangent - b.tangent).abs().max() < 1e-12 * MU);
    }
}

#[test]
fn an_inverted_deformation_is_not_answered_with_a_plausible_number() {
    for (name, material, _) in materials() {
        let flat_body = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
        assert!(!material.energy(&flat_body).is_finite(), "{name}");
    }
}
