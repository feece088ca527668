//! One list of tests for every material.

use super::*;
use actuator::{Elastomer, OgdenForm, OgdenTerm, OgdenTerms, chain_stiffening};
use nalgebra::{Rotation3, Vector3};

const MU: f64 = 0.393e6;

/// Constants of the size of natural rubber's, and the initial shear modulus that belongs to them.
fn elastomers() -> Vec<(&'static str, Elastomer, f64)> {
    let ogden = |alpha, form| Elastomer::Ogden { shear_modulus: MU, alpha, form };
    let term = |share: f64, alpha| OgdenTerm { shear_modulus: share * MU, alpha };
    let series = [term(0.9, 1.3), term(0.02, 5.0), term(0.08, -2.0)];
    let terms = OgdenTerms::new(&series).unwrap();
    vec![
        ("neo-Hookean", Elastomer::NeoHookean { shear_modulus: MU }, MU),
        ("Ogden 0.8", ogden(0.8, OgdenForm::InitialModulus), MU),
        ("Ogden 1.2", ogden(1.2, OgdenForm::InitialModulus), MU),
        ("Ogden 2", ogden(2.0, OgdenForm::InitialModulus), MU),
        ("Ogden -1.5", ogden(-1.5, OgdenForm::InitialModulus), MU),
        ("Ogden 1.2 as printed", ogden(1.2, OgdenForm::Printed), 1.2 * MU),
        ("Ogden, three terms", Elastomer::OgdenSeries { terms }, MU),
        ("Mooney-Rivlin", Elastomer::MooneyRivlin { c10: 0.45 * MU, c01: 0.05 * MU }, MU),
        ("Yeoh", Elastomer::Yeoh { c10: 0.5 * MU, c20: -0.01 * MU, c30: 0.002 * MU }, MU),
        ("Gent", Elastomer::Gent { shear_modulus: MU, locking_invariant: 40.0 }, MU),
        ("Arruda-Boyce", Elastomer::ArrudaBoyce { shear_modulus: MU, locking_stretch: 2.5 }, MU),
        ("St Venant-Kirchhoff", Elastomer::StVenantKirchhoff { shear_modulus: MU }, MU),
        ("linear elastic", Elastomer::LinearElastic { shear_modulus: MU }, MU),
    ]
}

fn materials() -> Vec<(&'static str, Rubber, f64)> {
    elastomers().into_iter().map(|(name, elastomer, initial)| (name, elastomer.into(), initial)).collect()
}

fn is_objective(rubber: &Rubber) -> bool {
    !matches!(rubber, Rubber::LinearElastic(_))
}

/// The energies by themselves, with a response to volume.
fn with_volume() -> Vec<(&'static str, Box<dyn Hyperelastic>)> {
    let mut all: Vec<(&'static str, Box<dyn Hyperelastic>)> = vec![
        ("St Venant-Kirchhoff", Box::new(StVenantKirchhoff { first_lame: 0.7 * MU, shear_modulus: MU })),
        ("linear elastic", Box::new(LinearElastic { first_lame: 0.7 * MU, shear_modulus: MU })),
    ];
    for (name, rubber, _) in materials() {
        match rubber {
            Rubber::NeoHookean(inner) => all.push((name, Box::new(inner.0))),
            Rubber::Ogden(inner) => all.push((name, Box::new(inner.0))),
            Rubber::MooneyRivlin(inner) => all.push((name, Box::new(inner.0))),
            Rubber::Yeoh(inner) => all.push((name, Box::new(inner.0))),
            Rubber::Gent(inner) => all.push((name, Box::new(inner.0))),
            Rubber::ArrudaBoyce(inner) => all.push((name, Box::new(inner.0))),
            Rubber::StVenantKirchhoff(inner) => all.push((name, Box::new(inner.0))),
            Rubber::LinearElastic(_) => {}
        }
    }
    all
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
    let incompressible =
        materials().into_iter().map(|(name, rubber, _)| (name, Box::new(rubber) as Box<dyn Hyperelastic>));
    for (name, material) in incompressible.chain(with_volume()) {
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
    for (name, material, _) in materials().into_iter().filter(|(_, rubber, _)| is_objective(rubber)) {
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
        let turn = if is_objective(&material) { rotation(0.1, 0.2, 0.3) } else { Matrix3::identity() };
        for size in [0.7, 1.0, 1.6] {
            let answer = material.answer(&(size * turn));
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
    for (name, material, _) in materials().into_iter().filter(|(_, rubber, _)| is_objective(rubber)) {
        for thickness in [0.0, -0.5] {
            let body = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, thickness));
            assert!(!material.energy(&body).is_finite(), "{name}");
        }
    }
}

#[test]
fn energies_free_of_volume_agree_with_the_chain_rule() {
    for (name, material) in with_volume() {
        for f in deformations() {
            let (direct, rule) =
                (material.isochoric_answer(&f), isochoric::by_chain_rule(material.as_ref(), &f));
            assert!((direct.energy - rule.energy).abs() < 1e-13 * MU, "{name}: energy");
            assert!((direct.stress - rule.stress).abs().max() < 1e-12 * MU, "{name}: stress");
            let scale = MU + rule.tangent.abs().max();
            assert!((direct.tangent - rule.tangent).abs().max() < 1e-12 * scale, "{name}: tangent");
        }
    }
}

#[test]
fn volume_is_felt_by_the_laws_that_have_a_bulk_modulus() {
    // Both are Hooke's law at small strain: dP11/dF11 = lambda + 2 mu, dP11/dF22 = lambda.
    for (name, material) in with_volume().into_iter().take(2) {
        let tangent = material.tangent(&Matrix3::identity());
        assert!((tangent[(0, 0)] / (2.7 * MU) - 1.0).abs() < 1e-14, "{name}");
        assert!((tangent[(0, 4)] / (0.7 * MU) - 1.0).abs() < 1e-14, "{name}");
    }
}

/// Nominal stress along the first axis of an incompressible body with stretches l whose third side is free: P11 - P33 l3/l1.
fn nominal_stress(material: &Rubber, stretches: [f64; 3]) -> f64 {
    let stress = material.first_piola_kirchhoff_stress(&Matrix3::from_diagonal(&Vector3::from(stretches)));
    stress[(0, 0)] - stress[(2, 2)] * stretches[2] / stretches[0]
}

#[test]
fn nominal_stresses_meet_the_published_formulas() {
    for (name, elastomer, _) in elastomers() {
        let rubber = Rubber::from(elastomer);
        for l in [0.6f64, 0.95, 1.0, 1.3, 2.2] {
            let (i1_uniaxial, i1_planar) = (l * l + 2.0 / l, l * l + 1.0 + 1.0 / (l * l));
            // Equibiaxial tension of 2.2 is I1 = 9.7.
            let i1_equibiaxial = 2.0 * l * l + l.powi(-4);
            let modes = [
                ([l, l.sqrt().recip(), l.sqrt().recip()], i1_uniaxial, l - l.powi(-2), 1.0 / l),
                ([l, l, l.powi(-2)], i1_equibiaxial, l - l.powi(-5), l * l),
                ([l, 1.0, 1.0 / l], i1_planar, l - l.powi(-3), 1.0),
            ];
            for (stretches, i1, shape, second) in modes {
                let ogden = |mu: f64, alpha: f64| {
                    let [long, _, thin] = stretches.map(|stretch| stretch.powf(alpha));
                    2.0 * mu / alpha * (long - thin) / l
                };
                let x = i1 - 3.0;
                // 2 (l1^2 - l3^2)/l1 (dW/dI1 + l2^2 dW/dI2).
                let expected = match elastomer {
                    Elastomer::NeoHookean { shear_modulus } => shear_modulus * shape,
                    Elastomer::Ogden { shear_modulus, alpha, form: OgdenForm::InitialModulus } => {
                        ogden(shear_modulus, alpha)
                    }
                    Elastomer::Ogden { shear_modulus, alpha, .. } => ogden(shear_modulus * alpha, alpha),
                    Elastomer::OgdenSeries { terms } => {
                        terms.as_slice().iter().map(|term| ogden(term.shear_modulus, term.alpha)).sum()
                    }
                    Elastomer::MooneyRivlin { c10, c01 } => 2.0 * shape * (c10 + second * c01),
                    Elastomer::Yeoh { c10, c20, c30 } => {
                        2.0 * shape * (c10 + 2.0 * c20 * x + 3.0 * c30 * x * x)
                    }
                    Elastomer::Gent { shear_modulus, locking_invariant: jm } => {
                        shear_modulus * jm / (jm - x) * shape
                    }
                    Elastomer::ArrudaBoyce { shear_modulus, locking_stretch: lm } => {
                        let y = i1 / (lm * lm);
                        let series = 0.5
                            + y / 10.0
                            + 11.0 / 350.0 * y.powi(2)
                            + 19.0 / 1750.0 * y.powi(3)
                            + 519.0 / 134_750.0 * y.powi(4);
                        2.0 * shear_modulus / chain_stiffening(lm) * shape * series
                    }
                    Elastomer::StVenantKirchhoff { shear_modulus } => {
                        let [long, _, thin] =
                            stretches.map(|stretch| (stretch.powi(4) - stretch.powi(2)) / l);
                        shear_modulus * (long - thin)
                    }
                    Elastomer::LinearElastic { shear_modulus } => {
                        let mean = stretches.iter().sum::<f64>() / 3.0;
                        let [long, _, thin] = stretches.map(|stretch| (stretch - mean) * stretch / l);
                        2.0 * shear_modulus * (long - thin)
                    }
                };
                let found = nominal_stress(&rubber, stretches);
                let scale = MU + expected.abs();
                assert!(
                    (found - expected).abs() < 1e-12 * scale,
                    "{name}, {stretches:?}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn chains_of_gent_lock() {
    let rubber = Rubber::from(Elastomer::Gent { shear_modulus: MU, locking_invariant: 2.0 });
    let bar = |l: f64| Matrix3::from_diagonal(&Vector3::new(l, l.sqrt().recip(), l.sqrt().recip()));
    // I1 = l^2 + 2/l = 3 + Jm, by bisection.
    let mut range = (1.0, 3.0);
    for _ in 0..60 {
        let l: f64 = 0.5 * (range.0 + range.1);
        if l * l + 2.0 / l < 5.0 { range.0 = l } else { range.1 = l }
    }
    let near = rubber.answer(&bar(range.0 - 1e-6));
    assert!(near.energy.is_finite() && near.stress[(0, 0)] > 1e5 * MU, "{}", near.stress);
    for beyond in [range.1 + 1e-9, 2.5, 10.0] {
        let answer = rubber.answer(&bar(beyond));
        assert!(answer.energy.is_nan() && answer.stress[(0, 0)].is_nan() && answer.tangent[(0, 0)].is_nan());
    }
}

#[test]
fn a_rotation_strains_what_is_linear() {
    let rubber = Rubber::from(Elastomer::LinearElastic { shear_modulus: MU });
    // e = diag(cos - 1, cos - 1, 0): |dev e|^2 = 2/3 (1 - cos)^2.
    let energy = rubber.energy(&rotation(0.0, 0.0, 0.5));
    assert!((energy / (2.0 / 3.0 * MU * (1.0 - 0.5f64.cos()).powi(2)) - 1.0).abs() < 1e-12);
}
