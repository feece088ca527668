use super::*;
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Points moved from a deformed state at random, by a fixed sequence.
pub(super) fn shaken(positions: &[[f64; 3]], amount: f64) -> Vec<[f64; 3]> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    positions.iter().map(|x| x.map(|x| x + amount * next())).collect()
}

pub(super) fn evaluated(element: &FibreElement, positions: &[[f64; 3]]) -> (f64, Vec<f64>, Vec<f64>) {
    let unknowns = 3 * element.blocks().len();
    let (mut gradient, mut tangent) = (vec![f64::NAN; unknowns], vec![f64::NAN; unknowns * unknowns]);
    let energy = element.evaluate(positions, &[], &mut gradient, &mut tangent).unwrap();
    (energy, gradient, tangent)
}

fn point(element: &FibreElement, unknown: usize) -> (usize, usize) {
    match element.blocks()[unknown / 3] {
        Block::Point(point) => (point as usize, unknown % 3),
        Block::Rotation(node) => panic!("a truss does not turn node {node}"),
    }
}

#[test]
fn gradient_and_tangent_are_derivatives_of_the_energy() {
    let crossing = [winding(40.0, Handedness::Right, 6, 0.3e-3), winding(55.0, Handedness::Left, 4, 0.0)];
    for law in [FibreLaw::Linear, FibreLaw::TensionOnly] {
        let mut specimen = specimen(&crossing);
        specimen.windings.iter_mut().for_each(|winding| winding.fibre.law = law);
        let (grid, fibres) = trusses(&specimen, mesh(12, 6, true));
        let mut positions = shaken(&moved(&grid, 1.1, 10.0, 1.1), 2e-4);
        // Central differences with 1e-6 of a cell's size, 3 mm: truncation and rounding below 1e-8 of the largest entry.
        let step = 3e-9;
        for element in fibres.elements.iter().step_by(5) {
            let (energy, gradient, tangent) = evaluated(element, &positions);
            assert!((energy - element.energy(&positions, &[]).unwrap()).abs() <= 1e-14 * energy.abs());
            let unknowns = gradient.len();
            let largest = |values: &[f64]| values.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
            for unknown in 0..unknowns {
                let (p, axis) = point(element, unknown);
                let centre = positions[p][axis];
                let [plus, minus] = [step, -step].map(|h| {
                    positions[p][axis] = centre + h;
                    evaluated(element, &positions)
                });
                positions[p][axis] = centre;
                let slope = (plus.0 - minus.0) / (2.0 * step);
                assert!((slope - gradient[unknown]).abs() <= 1e-6 * largest(&gradient), "{slope}");
                for row in 0..unknowns {
                    let slope = (plus.1[row] - minus.1[row]) / (2.0 * step);
                    let entry = tangent[unknown * unknowns + row];
                    assert!((slope - entry).abs() <= 1e-6 * largest(&tangent), "{slope} {entry}");
                }
            }
        }
    }
}

#[test]
fn homogeneous_deformation_gives_the_exact_stretch() {
    let deformation = Matrix3::new(1.1, 0.2, -0.1, 0.05, 0.9, 0.3, -0.2, 0.1, 1.2);
    let families = [winding(90.0, Handedness::Right, 6, 0.2e-3), winding(50.0, Handedness::Left, 5, 0.2e-3)];
    let specimen = specimen(&families);
    let errors = [1, 2, 4].map(|factor| {
        let (grid, fibres) = trusses(&specimen, mesh(24, 24, true).refined(factor));
        let positions: Vec<[f64; 3]> =
            grid.points.iter().map(|x| (deformation * Vector3::from(*x)).into()).collect();
        let reference = all_states(&fibres, &grid.points);
        let mut largest = [0.0_f64; 2];
        for (state, before) in all_states(&fibres, &positions).iter().zip(reference) {
            let family = usize::from(state.fibre >= 6);
            let angle = before.position[1].atan2(before.position[0]);
            let (sine, cosine) = families[family].angle_from_hoop().sin_cos();
            let around = cosine * families[family].handedness.sign();
            let tangent = Vector3::new(-angle.sin() * around, angle.cos() * around, sine);
            let error = (state.stretch - (deformation * tangent).norm()).abs();
            largest[family] = largest[family].max(error);
            let tension = STIFFNESS * (state.stretch - 1.0);
            assert!((state.tension - tension).abs() < 1e-9);
        }
        largest
    });
    // Straight fibres are interpolated exactly. Across the faces the stretch is that of sampled metrics: second order where
    // it varies, as it does around the tube.
    assert!(errors.iter().all(|error| error[0] < 1e-12), "{errors:?}");
    assert!(orders(&errors.map(|error| error[1])).iter().all(|order| *order > 1.8), "{errors:?}");
    assert!(errors[2][1] < 1e-3, "{errors:?}");
}

/// Largest error of the stretch^2 against the section's formula (r^2 (k + psi)^2 + lambda^2)/(R^2 k^2 + 1).
fn section_errors(windings: &[Winding], mesh: SolidMesh) -> Vec<[f64; 2]> {
    let specimen = specimen(windings);
    let (radius, [stretch, twist, widening]) = (specimen.tube.outer_radius(), [1.12, -30.0, 1.08]);
    let each = |factor| {
        let (grid, fibres) = trusses(&specimen, mesh.refined(factor));
        let mut largest = [0.0_f64; 2];
        for state in all_states(&fibres, &moved(&grid, stretch, twist, widening)) {
            let family = usize::from(state.fibre >= windings[0].fibres);
            let k = windings[family].handedness.sign() * windings[family].turn_per_length(radius);
            let r = radius * widening;
            let exact = ((r * (k + twist)).powi(2) + stretch * stretch) / ((radius * k).powi(2) + 1.0);
            largest[family] = largest[family].max((state.stretch.powi(2) - exact).abs());
        }
        largest
    };
    [1, 2, 4].map(each).to_vec()
}

#[test]
fn stretched_twisted_and_widened_helices_follow_the_section() {
    let families = [winding(35.0, Handedness::Right, 6, 0.0), winding(50.0, Handedness::Left, 6, 0.0)];
    let errors = section_errors(&families, mesh(24, 24, true));
    // The places where a quadratic's slope is best make both ways of fourth order: a fibre next to inextensible bears no less.
    let [on_lines, across] = [0, 1].map(|family| errors.iter().map(|e| e[family]).collect::<Vec<_>>());
    for errors in [on_lines, across] {
        assert!(orders(&errors).iter().all(|order| (order - 4.0).abs() < 0.3), "{errors:?}");
        assert!(errors[0] < 3e-4, "{errors:?}");
    }
}

#[test]
fn a_slack_thread_carries_nothing_and_a_truss_pushes() {
    let linear = winding(60.0, Handedness::Right, 6, 0.3e-3);
    let mut thread = linear;
    thread.fibre.law = FibreLaw::TensionOnly;
    for (stretch, pulled, follows) in
        [(0.95, false, true), (1.05, true, true), (0.95, false, false), (1.05, true, false)]
    {
        let energies = [linear, thread].map(|winding| {
            let (grid, fibres) = trusses(&specimen(&[winding]), mesh(12, 12, follows));
            let positions = moved(&grid, stretch, 0.0, stretch);
            let length: f64 = all_states(&fibres, &grid.points).iter().map(|state| state.weight).sum();
            let mut total = 0.0;
            for element in &fibres.elements {
                let (energy, gradient, tangent) = evaluated(element, &positions);
                total += energy;
                let silent = gradient.iter().chain(&tangent).all(|value| *value == 0.0);
                assert_eq!(silent, !pulled && winding.fibre.law == FibreLaw::TensionOnly);
                for state in element.states(&positions, &[]) {
                    let expected = if silent { 0.0 } else { STIFFNESS * (stretch - 1.0) };
                    assert!((state.tension - expected).abs() < 1e-9);
                }
            }
            // Every direction is stretched alike.
            let whole = 0.5 * STIFFNESS * 0.05_f64.powi(2) * length;
            assert!((total - if total == 0.0 { 0.0 } else { whole }).abs() < 1e-12 * whole);
            total
        });
        assert!(energies[0] > 0.0);
        assert_eq!(energies[1], if pulled { energies[0] } else { 0.0 });
    }
}

#[test]
fn turning_the_whole_changes_nothing() {
    let crossing = [winding(40.0, Handedness::Right, 6, 0.3e-3), winding(55.0, Handedness::Left, 4, 0.0)];
    let (grid, fibres) = trusses(&specimen(&crossing), mesh(12, 6, true));
    let positions = shaken(&moved(&grid, 1.05, 10.0, 1.02), 1e-4);
    let turn = Rotation3::from_scaled_axis(Vector3::new(2.0, -1.0, 2.5));
    let turned: Vec<[f64; 3]> = positions
        .iter()
        .map(|x| (turn * Vector3::from(*x) + Vector3::new(0.1, FRAC_PI_2, -0.3)).into())
        .collect();
    for element in &fibres.elements {
        let (before, after) = (evaluated(element, &positions), evaluated(element, &turned));
        // Coordinates of about 1.6 m lose three digits to those of 5 mm.
        assert!((before.0 - after.0).abs() < 1e-9 * before.0);
        let scale = before.1.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
        for (pull, pulled) in before.1.chunks(3).zip(after.1.chunks(3)) {
            let expected = turn * Vector3::from_row_slice(pull);
            assert!((expected - Vector3::from_row_slice(pulled)).norm() < 1e-9 * scale);
        }
    }
}
