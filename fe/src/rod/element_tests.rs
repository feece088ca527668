use super::*;
use crate::{ThickTube, rigid_motion::joined, rod::specimens::free};
use actuator::Handedness;
use nalgebra::UnitQuaternion;

/// Stiffnesses that change with pressure, stretch, twist and ends, for tests of derivatives.
struct Varying;

impl BendingLaw for Varying {
    fn respond(&self, p: f64, stretch: f64, twist: f64, ends: f64) -> BendingResponse {
        let sizes = [4e-4 * (1.0 + 1e-3 * ends), 3e-3, 10.0];
        let (a, b, c) = (1.7 * (stretch - 1.0), 0.02 * twist, 1.0 + p / 5e4);
        let value = c * (1.0 + a + b + a * a - 0.5 * a * b + 0.3 * b * b);
        let slopes = [c * 1.7 * (1.0 + 2.0 * a - 0.5 * b), c * 0.02 * (1.0 - 0.5 * a + 0.6 * b)];
        let curvatures = [c * 1.7 * 1.7 * 2.0, c * 1.7 * 0.02 * -0.5, c * 0.02 * 0.02 * 0.6];
        let signs = [1.0, -1.0, 0.5];
        BendingResponse {
            stiffness: std::array::from_fn(|i| sizes[i] * (1.0 + signs[i] * value)),
            slopes: slopes.map(|slope| std::array::from_fn(|i| sizes[i] * signs[i] * slope)),
            curvatures: curvatures.map(|curvature| std::array::from_fn(|i| sizes[i] * signs[i] * curvature)),
        }
    }

    fn respond_tied(&self, p: f64, stretch: f64, twist: f64, ends: f64) -> BendingResponse {
        self.respond(1.5 * p, stretch, twist, ends)
    }
}

#[test]
fn element_derivatives_match_differences() {
    let tube = ThickTube::new(&free(30.0, Handedness::Right));
    for (hand, held_at) in
        [(1.0, None), (-1.0, None), (1.0, Some([7e-3, -4e-3])), (-1.0, Some([-7e-3, 4e-3]))]
    {
        let law = ElementLaw {
            section: &tube,
            hand,
            bending: &Varying,
            bending_scale: 0.8,
            held_at,
            length: 0.02,
            ends: 50.0,
        };
        let a = Frame {
            rotation: UnitQuaternion::from_scaled_axis(Vector3::new(0.3, -0.5, 1.4)),
            position: Vector3::new(0.01, 0.02, 0.03),
        };
        let b = a.moved(&joined(Vector3::new(1e-3, -2e-3, 0.0216), Vector3::new(0.3, -0.2, -0.5 * hand)));
        let element = law.evaluate(&a, &b, 3e4, true).unwrap();
        // Natural units: 10 mm, 1 N. Fourth-order differences of step 1e-3.
        let unit = |i: usize| Vector6::ith(i, if i < 3 { 1e-2 } else { 1.0 });
        let move_both = |i: usize, e: f64| {
            if i < 6 { (a.moved(&(unit(i) * e)), b) } else { (a, b.moved(&(unit(i - 6) * e))) }
        };
        let energy = |i: usize, j: usize, e: f64, f: f64| {
            // Along exp(e u_i + f u_j) on one node, or on two.
            let (mut at_a, mut at_b) = (Vector6::zeros(), Vector6::zeros());
            for (k, step) in [(i, e), (j, f)] {
                if k < 6 { at_a += unit(k) * step } else { at_b += unit(k - 6) * step }
            }
            law.evaluate(&a.moved(&at_a), &b.moved(&at_b), 3e4, false).unwrap().energy
        };
        let h = 1e-3;
        for i in 0..12 {
            let value = |e: f64| {
                let (a, b) = move_both(i, e);
                law.evaluate(&a, &b, 3e4, false).unwrap().energy
            };
            let slope = (value(-2.0 * h) - 8.0 * value(-h) + 8.0 * value(h) - value(2.0 * h)) / (12.0 * h);
            let exact = element.gradient[i / 6].dot(&unit(i % 6));
            assert!((slope - exact).abs() < 1e-9, "{i}: {slope} {exact}");
            for j in 0..12 {
                let mixed = |s: f64| {
                    let s = s * h;
                    (energy(i, j, s, s) - energy(i, j, s, -s) - energy(i, j, -s, s) + energy(i, j, -s, -s))
                        / (4.0 * s * s)
                };
                let difference = (4.0 * mixed(1.0) - mixed(2.0)) / 3.0;
                let [aa, ab, bb] = element.tangent;
                let block = match (i < 6, j < 6) {
                    (true, true) => aa,
                    (true, false) => ab,
                    (false, true) => ab.transpose(),
                    (false, false) => bb,
                };
                let exact = unit(i % 6).dot(&(block * unit(j % 6)));
                // Energies of 1e-3 J: rounding leaves 1e-19/1e-6.
                assert!((difference - exact).abs() < 1e-9, "{i} {j}: {difference} {exact}");
            }
        }
        let pressed = |p: f64| law.evaluate(&a, &b, p, false).unwrap().gradient;
        for node in 0..2 {
            let slope = (pressed(3.1e4)[node] - pressed(2.9e4)[node]) / 2e3;
            assert!((slope - element.pressure_gradient[node]).amax() < 1e-5 * slope.amax());
        }
        let softer = ElementLaw { bending_scale: 0.4, ..law }.evaluate(&a, &b, 3e4, false).unwrap();
        for node in 0..2 {
            let half = element.gradient[node] - softer.gradient[node];
            assert!((half - element.bending_gradient[node] * 0.5).amax() < 1e-12);
        }
    }
}
