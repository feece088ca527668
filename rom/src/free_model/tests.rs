use super::*;
use crate::LIMIT_MARGIN;
use crate::synthetic::{free_map, free_path, free_state, limit_pressure};
use actuator::units::DEG;
use actuator::{FreePath, PathEnd};

const MU: f64 = 0.393e6;

fn angles(count: usize) -> Vec<f64> {
    (0..count).map(|i| (10.0 + 70.0 * i as f64 / (count.max(2) - 1) as f64).to_radians()).collect()
}

fn outputs(evaluation: &FreeEvaluation) -> [f64; 3] {
    [evaluation.axial_stretch, evaluation.expansion, evaluation.twist_per_length]
}

#[test]
fn a_folding_map_is_met_between_its_nodes_up_to_the_limit() {
    let model = FreeModel::fit(&free_map(angles(8), vec![0.5 * MU, MU, 2.0 * MU], 40, None)).unwrap();
    let errors = model.errors();
    assert!(errors.held_out.axial_stretch.count > 14 * 20, "{errors:?}");
    assert_eq!(errors.held_out.axial_stretch.count + errors.outside, 14 * 39);
    // The goals: 0.1 % of stretch and expansion, 0.5 % of twist.
    assert!(errors.held_out.axial_stretch.worst < 1e-3, "{errors:?}");
    assert!(errors.held_out.expansion.worst < 1e-3, "{errors:?}");
    assert!(errors.held_out.twist_per_length.worst < 5e-3, "{errors:?}");
    assert!(errors.held_out_below_nine_tenths.expansion.worst < errors.held_out.expansion.worst);
    assert!(errors.limit_pressure.worst < 1e-3, "{errors:?}");
    // Fitted states are left by the resampling alone.
    assert!(errors.fitted.expansion.worst < 1e-5 && errors.fitted.expansion.count > 24 * 20, "{errors:?}");
    for (angle, modulus) in [(0.4, MU), (1.1, 1.4 * MU)] {
        let limit = model.limit_pressure(angle, modulus).unwrap().unwrap();
        assert!((limit / limit_pressure(angle, modulus) - 1.0).abs() < 1e-3);
        let usable = model.greatest_pressure(angle, modulus).unwrap() / limit;
        assert!((usable - (1.0 - LIMIT_MARGIN)).abs() < 1e-14);
        let exact = free_state(angle, modulus, 0.6);
        let ours = model.evaluate(exact.pressure, angle, modulus).unwrap();
        assert!((ours.axial_stretch - exact.axial_stretch).abs() < 5e-4);
        assert!((ours.expansion - exact.expansion).abs() < 5e-4);
        assert!((ours.twist_per_length - exact.twist_per_length).abs() < 0.2);
        let rest = model.evaluate(0.0, angle, modulus).unwrap();
        assert!(outputs(&rest).iter().zip([1.0, 1.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-13));
    }
}

#[test]
fn the_jacobian_is_the_derivative() {
    let model = FreeModel::fit(&free_map(angles(6), vec![0.5 * MU, MU, 2.0 * MU], 30, None)).unwrap();
    for (fraction, angle, modulus) in [(0.05, 0.2, 0.6 * MU), (0.5, 0.7, MU), (0.93, 1.3, 1.9 * MU)] {
        let point = [fraction * limit_pressure(angle, modulus), angle, modulus];
        let at = |p: [f64; 3]| outputs(&model.evaluate(p[0], p[1], p[2]).unwrap());
        let jacobian = model.evaluate(point[0], angle, modulus).unwrap().jacobian;
        for input in 0..3 {
            let step = 1e-5 * point[input];
            let (mut above, mut below) = (point, point);
            above[input] += step;
            below[input] -= step;
            for output in 0..3 {
                let difference = (at(above)[output] - at(below)[output]) / (2.0 * step);
                // Central differences with a relative step of 1e-5: 1e-10 of the third derivative, 1e-11 of rounding.
                let scale = difference.abs() + [1.0, 1.0, 100.0][output] / point[input];
                assert!(
                    (difference - jacobian[input][output]).abs() < 1e-6 * scale,
                    "input {input}, output {output}: {difference} and {}",
                    jacobian[input][output]
                );
            }
        }
    }
}

#[test]
fn one_angle_and_one_modulus_make_a_model_of_pressure_alone() {
    let angle = 30f64.to_radians();
    let model = FreeModel::fit(&free_map(vec![angle], vec![MU], 30, None)).unwrap();
    let exact = free_state(angle, MU, 0.5);
    // 30 degrees by another route differ in the last digit.
    let ours = model.evaluate(exact.pressure, 30.0 * DEG * (1.0 + 1e-15), MU).unwrap();
    // Only the resampling of 30 states stands between: h^4/384 of a fourth derivative of zero, the state being a cubic of s.
    assert!((ours.expansion - exact.expansion).abs() < 1e-9);
    assert!((ours.twist_per_length - exact.twist_per_length).abs() < 1e-7);
    assert_eq!(ours.jacobian[1..], [[0.0; 3]; 2]);
    assert!(ours.jacobian[0][1] > 0.0);
    assert!(matches!(model.evaluate(1e3, 0.53, MU), Err(OutsideFree::WindingAngle { .. })));
    assert!(matches!(model.evaluate(1e3, angle, 1.01 * MU), Err(OutsideFree::ShearModulus { .. })));
    assert_eq!(model.errors().held_out.expansion.count, model.errors().fitted.expansion.count);
}

#[test]
fn paths_that_met_no_limit_are_covered_to_their_end() {
    let upper = 0.08 * MU;
    let map = free_map(angles(8), vec![MU], 30, Some(upper));
    assert!(map.paths.iter().flatten().all(|path| path.end == PathEnd::Range));
    let model = FreeModel::fit(&map).unwrap();
    assert_eq!(model.limit_pressure(0.5, MU).unwrap(), None);
    assert!((model.greatest_pressure(0.5, MU).unwrap() / upper - 1.0).abs() < 1e-12);
    assert!(model.errors().held_out.axial_stretch.worst < 1e-3, "{:?}", model.errors());
    assert!(model.errors().held_out.expansion.worst < 1e-3);
    assert!(model.errors().outside <= 7, "only an end may lie outside, by rounding");
    // The fully inflated end of a node is in the domain.
    assert!(model.evaluate(upper * (1.0 - 1e-12), map.winding_angles()[3], MU).is_ok());
}

#[test]
fn limits_are_told_only_where_all_paths_around_met_one() {
    // Limit pressures fall with the angle, so a range of 0.2 MU is met below some angle and a limit point above.
    let mut map = free_map(angles(8), vec![MU], 30, Some(0.2 * MU));
    let ends: Vec<bool> = map.paths.iter().flatten().map(|path| path.end == PathEnd::LimitPoint).collect();
    let first = ends.iter().position(|limited| *limited).unwrap();
    assert!(first > 0 && first < 7);
    let model = FreeModel::fit(&map).unwrap();
    let between = 0.5 * (map.winding_angles()[first - 1] + map.winding_angles()[first]);
    assert_eq!(model.limit_pressure(between, MU).unwrap(), None);
    assert!(model.limit_pressure(map.winding_angles()[first], MU).unwrap().is_some());
    assert_eq!(model.limit_pressure(map.winding_angles()[first - 1], MU).unwrap(), None);
    assert!(model.limit_pressure(map.winding_angles()[7], MU).unwrap().is_some());
    // The other way round: the path above has none.
    map.paths[7].as_mut().unwrap().end = PathEnd::Range;
    let model = FreeModel::fit(&map).unwrap();
    let between = 0.5 * (map.winding_angles()[6] + map.winding_angles()[7]);
    assert_eq!(model.limit_pressure(between, MU).unwrap(), None);
    assert!(model.limit_pressure(map.winding_angles()[6], MU).unwrap().is_some());
}

#[test]
fn outside_is_refused_and_noise_is_continued() {
    let model = FreeModel::fit(&free_map(angles(5), vec![MU, 2.0 * MU], 30, None)).unwrap();
    let upper = model.greatest_pressure(0.6, MU).unwrap();
    assert!(model.evaluate(upper, 0.6, MU).is_ok());
    let outside = model.evaluate(upper + 1.0, 0.6, MU).unwrap_err();
    assert_eq!(outside, OutsideFree::Pressure { pressure: upper + 1.0, upper });
    assert!(outside.to_string().contains("outside the model's domain, 0 to"));
    for bad in [f64::NAN, -1e-6, f64::INFINITY] {
        assert!(model.evaluate(bad, 0.6, MU).is_err());
        assert!(model.evaluate(1e3, bad, MU).is_err());
        assert!(model.evaluate(1e3, 0.6, bad).is_err());
    }
    assert!(model.evaluate_near(1e3, 0.6, MU, f64::NAN).is_err());
    let edge = model.evaluate(0.0, 0.6, MU).unwrap();
    let noisy = model.evaluate_near(-200.0, 0.6, MU, 500.0).unwrap();
    assert_eq!(noisy.jacobian, edge.jacobian);
    assert_eq!(noisy.expansion, edge.expansion - 200.0 * edge.jacobian[0][1]);
    assert!(noisy.expansion < 1.0);
    assert!(model.evaluate_near(-501.0, 0.6, MU, 500.0).is_err());
    let beyond = model.evaluate_near(upper + 100.0, 0.6, MU, 500.0).unwrap();
    let top = model.evaluate(upper, 0.6, MU).unwrap();
    assert!((beyond.expansion - top.expansion - 100.0 * top.jacobian[0][1]).abs() < 1e-15);
}

#[test]
fn the_sign_of_the_twist_is_the_maps() {
    let mut map = free_map(angles(4), vec![MU], 20, None);
    let right = FreeModel::fit(&map).unwrap();
    for state in map.paths.iter_mut().flatten().flat_map(|path| &mut path.states) {
        state.twist_per_length *= -1.0;
    }
    let left = FreeModel::fit(&map).unwrap();
    let (a, b) = (right.evaluate(1e4, 0.5, MU).unwrap(), left.evaluate(1e4, 0.5, MU).unwrap());
    assert!(a.twist_per_length < 0.0);
    assert_eq!(a.twist_per_length, -b.twist_per_length);
    assert_eq!(a.axial_stretch, b.axial_stretch);
}

#[test]
fn checks_are_judged_on_and_never_fitted() {
    let mut map = free_map(angles(4), vec![MU], 20, None);
    let model = FreeModel::fit(&map).unwrap();
    for (_, path) in &mut map.checks {
        path.states[5].expansion += 0.1;
    }
    let other = FreeModel::fit(&map).unwrap();
    assert!((other.errors().held_out.expansion.worst - 0.1).abs() < 0.02);
    assert_eq!(other.errors().worst_at.unwrap()[2], MU);
    assert_eq!(other.errors().fitted, model.errors().fitted);
    assert_eq!(other.splines.states(), model.splines.states());
    map.checks.clear();
    assert_eq!(FreeModel::fit(&map).unwrap().errors().held_out.expansion.count, 0);
}

#[test]
fn states_almost_on_each_other_do_not_spoil_the_fit() {
    // Pressures asked for and pressures that the continuation happened on may nearly coincide, at the end too.
    let plain = free_map(vec![0.5], vec![MU], 25, None);
    let mut crowded = plain.clone();
    let path: &mut FreePath = crowded.paths[0].as_mut().unwrap();
    let twin = |index: usize, path: &FreePath| {
        let mut state = path.states[index];
        state.pressure *= 1.0 - 1e-9;
        state.expansion += 1e-7;
        state
    };
    let (middle, end) = (twin(10, path), twin(24, path));
    path.states.insert(24, end);
    path.states.insert(10, middle);
    let (a, b) = (FreeModel::fit(&plain).unwrap(), FreeModel::fit(&crowded).unwrap());
    for fraction in [0.2, 0.45, 0.55, 0.97] {
        let pressure = fraction * limit_pressure(0.5, MU);
        let difference = a.evaluate(pressure, 0.5, MU).unwrap().expansion
            - b.evaluate(pressure, 0.5, MU).unwrap().expansion;
        // The twins are 1e-7 off.
        assert!(difference.abs() < 2e-7, "{difference}");
    }
}

#[test]
fn paths_that_cannot_be_are_named() {
    let good = free_map(angles(3), vec![MU, 2.0 * MU], 12, None);
    let message = |change: fn(&mut Vec<Option<FreePath>>)| {
        let mut map = good.clone();
        change(&mut map.paths);
        FreeModel::fit(&map).unwrap_err().to_string()
    };
    let missing = message(|paths| paths[3] = None);
    assert!(missing.contains("1 of 6 paths"), "{missing}");
    assert!(missing.contains("45.00 deg from the hoop, 0.7860 MPa"), "{missing}");
    assert!(message(|paths| paths[0].as_mut().unwrap().states.clear()).contains("has no states"));
    assert!(
        message(|paths| paths[0].as_mut().unwrap().states.truncate(1)).contains("no state under pressure")
    );
    assert!(message(|paths| paths[0].as_mut().unwrap().states[0].pressure = 1.0).contains("begin at zero"));
    assert!(message(|paths| paths[0].as_mut().unwrap().states[4].pressure = 1.0).contains("fall"));
    assert!(message(|paths| paths[0].as_mut().unwrap().states[4].expansion = f64::NAN).contains("finite"));
    assert!(message(|paths| paths.truncate(5)).contains("6 nodes in all, but the table has 5"));
    assert!(message(|paths| paths[0].as_mut().unwrap().states[4].axial_stretch = 0.0).contains("positive"));
    let mut flat = good.clone();
    flat.axes[0].values[0] = 0.0;
    assert!(FreeModel::fit(&flat).unwrap_err().to_string().contains("winding angle that is not positive"));
    for empty in [free_map(vec![], vec![MU], 12, None), free_map(vec![0.5], vec![], 12, None)] {
        assert!(FreeModel::fit(&empty).unwrap_err().to_string().contains("has no nodes"));
    }
    let mut falling = good.clone();
    falling.axes[0].values.reverse();
    assert!(FreeModel::fit(&falling).unwrap_err().to_string().contains("must rise"));
    // Two states are the least: a straight line in s.
    assert!(FreeModel::fit(&free_map(vec![0.5], vec![MU], 2, None)).is_ok());
    let single = free_path(0.5, MU, 2, None);
    assert_eq!(single.states.len(), 2);
}
