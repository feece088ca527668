//! States dense enough for a cubic.

use super::*;
use actuator::FreePath;

/// The path with a tolerance, at few pressures and few extra states.
fn path(free: &Free, tolerance: Option<f64>) -> FreePath {
    let request = PathRequest {
        pressures: &[7e3, 31e3],
        extra_states: 4,
        interpolation_tolerance: tolerance,
        ..PathRequest::default()
    };
    solver(free, COARSE).free_path(&request).unwrap()
}

/// The greatest miss of the cubic in s through four neighbouring states, over the greatest change along the path, at states solved
/// in the middles of the intervals and at a third of them.
fn greatest_miss(free: &Free, path: &FreePath) -> f64 {
    let limit = path.limit_pressure().unwrap();
    let s = |pressure: f64| 1.0 - (1.0 - pressure / limit).max(0.0).sqrt();
    let places: Vec<f64> = path.states.iter().map(|state| s(state.pressure)).collect();
    let between = places.windows(2).flat_map(|pair| [0.3, 0.5].map(|t| pair[0] + t * (pair[1] - pair[0])));
    let pressures: Vec<f64> = between.map(|s| limit * (1.0 - (1.0 - s).powi(2))).collect();
    let solved = solver(free, COARSE).path(&pressures, 0).unwrap();
    let mut worst = 0.0f64;
    for q in 0..3 {
        let all = || path.states.iter().map(|state| state.deformation()[q]);
        let change = all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min);
        for state in &solved.states {
            let at = s(state.pressure);
            let after = places.partition_point(|place| *place <= at);
            let first = after.saturating_sub(2).min(places.len() - 4);
            let stencil = first..first + 4;
            let lagrange: f64 = stencil
                .clone()
                .map(|i| {
                    let others = stencil.clone().filter(|j| *j != i);
                    let weight: f64 = others.map(|j| (at - places[j]) / (places[i] - places[j])).product();
                    weight * path.states[i].deformation()[q]
                })
                .sum();
            worst = worst.max((lagrange - state.deformation()[q]).abs() / change);
        }
    }
    worst
}

#[test]
fn cubics_between_the_states_are_right_to_the_tolerance() {
    for free in [free(20.0), free(60.0), tension_only(free(75.0))] {
        let bare = path(&free, None);
        let before = greatest_miss(&free, &bare);
        for tolerance in [1e-3, 1e-4] {
            let path = path(&free, Some(tolerance));
            let after = greatest_miss(&free, &path);
            assert!(after < 1.2 * tolerance, "{after:e} with {} states", path.states.len());
            // No more than are needed: the cubic's error falls with the fourth power of the spacing.
            assert!(path.states.len() < 40, "{} states", path.states.len());
            if before < tolerance {
                continue;
            }
            assert!(path.states.len() > bare.states.len());
        }
        assert!(before > 1e-4, "{before:e}: the test has nothing to show");
        // Those asked for stay.
        let resolved = path(&free, Some(1e-4));
        for state in &bare.states {
            assert!(resolved.states.contains(state), "{state:?}");
        }
        assert!(resolved.states.windows(2).all(|pair| pair[1].pressure > pair[0].pressure));
    }
}
