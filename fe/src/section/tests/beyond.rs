//! States past the limit point.

use super::*;

fn beyond(free: &Free, ratio: f64) -> actuator::FreePath {
    let request = PathRequest { beyond_limit: Some(ratio), extra_states: 3, ..PathRequest::default() };
    solver(free, COARSE).free_path(&request).unwrap()
}

/// Phi of an incompressible Ogden tube with smeared fibres, at (inner radius, stretch, twist), by midpoints through the wall.
fn enthalpy(free: &Free, pressure: f64, [inner, stretch, twist]: [f64; 3]) -> f64 {
    let (a, b) = (free.tube.inner_radius, free.tube.outer_radius());
    let (mu, alpha) = (0.393e6, 1.2);
    const POINTS: usize = 400;
    let mut energy = 0.0;
    for i in 0..POINTS {
        let radius = a + (b - a) * (i as f64 + 0.5) / POINTS as f64;
        let r = (inner * inner + (radius * radius - a * a) / stretch).sqrt();
        let radial = radius / (stretch * r);
        let (trace, determinant) =
            ((r / radius).powi(2) + (r * twist).powi(2) + stretch * stretch, (r * stretch / radius).powi(2));
        let root = (0.25 * trace * trace - determinant).max(0.0).sqrt();
        let principal = [radial, (0.5 * trace + root).sqrt(), (0.5 * trace - root).sqrt()];
        let sum: f64 = principal.iter().map(|stretch| stretch.powf(alpha)).sum();
        let density = 2.0 * mu / (alpha * alpha) * (sum - 3.0);
        energy += std::f64::consts::TAU * radius * density * (b - a) / POINTS as f64;
    }
    let turn = free.winding.turn_per_length(b);
    let outer = (inner * inner + (b * b - a * a) / stretch).sqrt();
    let length = (b * b * turn * turn + 1.0).sqrt();
    let fibre = (outer * (turn + twist)).hypot(stretch) / length;
    let stiffness = free.winding.fibres as f64 * free.winding.fibre.axial_stiffness * length;
    energy + 0.5 * stiffness * (fibre - 1.0).powi(2)
        - pressure * std::f64::consts::PI * inner * inner * stretch
}

#[test]
fn the_falling_branch_is_that_of_the_closed_form() {
    for angle in [20.0, 40.0, 70.0] {
        let free = smeared(free(angle));
        let (a, b) = (free.tube.inner_radius, free.tube.outer_radius());
        let path = beyond(&free, 1.6);
        assert_eq!(path.beyond.len(), 12, "{angle} deg: {:?}", path.beyond.last());
        for state in &path.beyond {
            let stretch = state.axial_stretch;
            let inner = ((state.expansion * b).powi(2) - (b * b - a * a) / stretch).sqrt();
            let at = [inner, stretch, state.twist_per_length];
            let gradient: [f64; 3] = std::array::from_fn(|i| {
                let step = [3e-5 * b, 3e-5, 3e-5 / b][i];
                let moved = |sign: f64| {
                    let mut at = at;
                    at[i] += sign * step;
                    enthalpy(&free, state.pressure, at)
                };
                // In units of mu B^2.
                (moved(1.0) - moved(-1.0)) / (6e-5 * 0.393e6 * b * b)
            });
            // The fibres' stiffness is some 250 of these units, the wall's compressibility 1e-5.
            assert!(gradient.iter().all(|part| part.abs() < 3e-3), "{angle} deg: {gradient:?} at {state:?}");
        }
    }
}

#[test]
fn the_pressure_falls_right_after_the_limit_as_the_volume_rises() {
    for free in [free(15.0), free(45.0), tension_only(free(70.0))] {
        let path = beyond(&free, 1.5);
        let limit = path.states[path.states.len() - 1];
        let volume = |state: &FreeState| state.section.unwrap().volume;
        assert_eq!(path.beyond.len(), 10);
        assert!(
            path.beyond[0].pressure < limit.pressure && path.beyond[1].pressure < path.beyond[0].pressure
        );
        for (index, state) in path.beyond.iter().enumerate() {
            let expected = volume(&limit) * (1.0 + 0.05 * (index + 1) as f64);
            assert!((volume(state) / expected - 1.0).abs() < 1e-8 && state.residual < 1e-8, "{state:?}");
        }
        // The path below is the same as without.
        let without = solver(&free, COARSE).path(&[], 3).unwrap();
        assert_eq!((without.states, without.end), (path.states, path.end));
    }
}

#[test]
fn a_path_without_limit_has_nothing_beyond_and_wrong_ratios_are_refused() {
    let mut free = free(70.0);
    free.elastomer = Elastomer::NeoHookean { shear_modulus: 0.393e6 };
    let path = beyond(&free, 1.5);
    assert_eq!((path.end, path.beyond.len()), (PathEnd::Range, 0));
    for ratio in [1.0, 0.5, 30.0, f64::NAN] {
        let request = PathRequest { beyond_limit: Some(ratio), ..PathRequest::default() };
        let error = solver(&free, COARSE).free_path(&request).unwrap_err();
        assert!(error.to_string().starts_with("beyond_limit is"), "{error}");
    }
}
