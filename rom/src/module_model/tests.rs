use super::*;
use crate::synthetic::{LIMIT, PRESSURE_MAX, module_map, module_state};
use crate::{ErrorStatistics, ModuleErrors, ModuleFitError};

fn even(count: usize) -> Vec<f64> {
    (0..count).map(|i| PRESSURE_MAX * i as f64 / (count - 1) as f64).collect()
}

fn model(counts: &[usize]) -> ModuleModel {
    ModuleModel::fit(&module_map(counts.iter().map(|count| even(*count)).collect(), 300)).unwrap()
}

#[test]
fn the_pose_and_its_derivatives_are_those_of_the_map() {
    let model = model(&[9, 9, 9]);
    let mut into = model.workspace();
    let mut moved = model.workspace();
    for pressures in [[0.0; 3], [12e3, 47e3, 5e3], [33e3, 1e3, 66e3], [30e3, 30e3, 30e3]] {
        model.evaluate(&pressures, &mut into).unwrap();
        let exact = module_state(&pressures);
        for (a, b) in into.chart.to_array().iter().zip(exact.chart.to_array()) {
            // Nine even nodes an axis: 1.3e-3 near the fold, on numbers of size one.
            assert!((a - b).abs() < 3e-3, "{pressures:?}: {:?} for {:?}", into.chart, exact.chart);
        }
        for (slopes, exact) in into.slopes.iter().zip(&exact.slopes) {
            for (a, b) in slopes.iter().zip(exact) {
                assert!((a - b).abs() < 3e-3);
            }
        }
        for free in 0..3 {
            let mut there = pressures;
            let step = 0.5;
            there[free] += step;
            model.evaluate(&there, &mut moved).unwrap();
            for output in 0..6 {
                let difference = (moved.chart.to_array()[output] - into.chart.to_array()[output]) / step;
                // Slopes are of size 1e-5 per Pa; half a pascal of truncation is below 1e-9 of a second derivative's 1e-9.
                assert!((difference - into.jacobian[free][output]).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn as_many_parameter_slopes_are_filled_as_there_is_room_for() {
    let model = model(&[6, 6]);
    let mut full = model.workspace();
    let parameters = full.slopes.len();
    assert!(parameters > 1, "the synthetic map has parameters");
    model.evaluate(&[20e3, 30e3], &mut full).unwrap();
    for room in 0..=parameters + 1 {
        let mut into = PoseEvaluation::new(2, room);
        into.slopes.fill([7.0; 6]);
        model.evaluate(&[20e3, 30e3], &mut into).unwrap();
        assert_eq!((into.chart, &into.jacobian), (full.chart, &full.jacobian), "room for {room}");
        let filled = room.min(parameters);
        assert_eq!(into.slopes[..filled], full.slopes[..filled], "room for {room}");
        assert!(into.slopes[filled..].iter().all(|slope| *slope == [7.0; 6]), "room for {room}");
    }
}

#[test]
fn errors_are_those_of_the_check_states_and_of_nothing_else() {
    let mut map = module_map(vec![even(6), even(6)], 40);
    let model = ModuleModel::fit(&map).unwrap();
    let mut into = model.workspace();
    let distances: Vec<f64> = map
        .checks
        .iter()
        .map(|check| {
            model.evaluate(&check.pressures, &mut into).unwrap();
            (into.chart.to_pose().position - check.state.chart.to_pose().position).norm()
        })
        .collect();
    assert_eq!(model.errors().position, ErrorStatistics::of(&distances));
    assert_eq!(model.errors().position.count, 40);
    assert!(model.errors().position.worst > 0.0);
    // A check that is off by 1 cm and one outside: the first is the worst, the second is counted apart.
    map.checks[7].state.chart.position[2] += 0.01;
    map.checks[9].pressures[0] = 75e3;
    let other = ModuleModel::fit(&map).unwrap();
    assert!((other.errors().position.worst - 0.01).abs() < 1e-3);
    assert_eq!(other.errors().worst_at, map.checks[7].pressures);
    assert_eq!((other.errors().position.count, other.errors().outside), (39, 1));
    assert_eq!(other.splines().chart(), model.splines().chart(), "a check state has changed the fit");
    map.checks.clear();
    assert_eq!(ModuleModel::fit(&map).unwrap().errors(), &ModuleErrors::default());
}

#[test]
fn the_domain_stops_below_the_limit_pressure() {
    let mut map = module_map(vec![even(6), even(5)], 0);
    map.limit_pressures = vec![Some(60e3), None];
    let model = ModuleModel::fit(&map).unwrap();
    assert_eq!(model.domain(), [(0.0, 60e3 * (1.0 - LIMIT_MARGIN)), (0.0, PRESSURE_MAX)]);
    let mut into = model.workspace();
    assert!(model.evaluate(&[58.7e3, 0.0], &mut into).is_ok());
    let error = model.evaluate(&[59e3, 0.0], &mut into).unwrap_err();
    assert_eq!(error, OutOfDomain::Pressure { free: 0, pressure: 59e3, lower: 0.0, upper: 58.8e3 });
    assert!(model.evaluate(&[0.0, f64::NAN], &mut into).is_err());
    assert!(model.evaluate(&[-1e-9, 0.0], &mut into).is_err());
    map.limit_pressures = vec![Some(LIMIT), Some(f64::NAN)];
    assert!(matches!(ModuleModel::fit(&map), Err(ModuleFitError::NoDomain { free: 1, .. })));
}

#[test]
fn noise_about_zero_is_continued_linearly_and_no_further_than_asked() {
    let model = model(&[6, 6]);
    let (mut into, mut edge) = (model.workspace(), model.workspace());
    model.evaluate(&[0.0, 20e3], &mut edge).unwrap();
    model.evaluate_near(&[-200.0, 20e3], 500.0, &mut into).unwrap();
    for output in 0..6 {
        let expected = edge.chart.to_array()[output] - 200.0 * edge.jacobian[0][output];
        assert_eq!(into.chart.to_array()[output], expected);
    }
    assert_eq!((&into.jacobian, &into.slopes), (&edge.jacobian, &edge.slopes));
    // Two coordinates outside at once, on either side.
    model.evaluate(&[0.0, PRESSURE_MAX], &mut edge).unwrap();
    model.evaluate_near(&[-100.0, PRESSURE_MAX + 300.0], 500.0, &mut into).unwrap();
    let expected = edge.chart.twist - 100.0 * edge.jacobian[0][0] + 300.0 * edge.jacobian[1][0];
    assert!((into.chart.twist - expected).abs() < 1e-15);
    // Inside it is the plain evaluation.
    model.evaluate(&[1e3, 20e3], &mut edge).unwrap();
    model.evaluate_near(&[1e3, 20e3], 500.0, &mut into).unwrap();
    assert_eq!(into, edge);
    assert!(model.evaluate_near(&[-501.0, 20e3], 500.0, &mut into).is_err());
    assert!(model.evaluate_near(&[0.0, PRESSURE_MAX + 501.0], 500.0, &mut into).is_err());
    assert!(model.evaluate_near(&[f64::NAN, 20e3], 500.0, &mut into).is_err());
    assert!(model.evaluate_near(&[0.0, 0.0], f64::NAN, &mut into).is_err());
}

#[test]
fn bad_states_are_named() {
    let fails = |change: fn(&mut actuator::ModuleMap)| {
        let mut map = module_map(vec![even(4), even(5)], 0);
        change(&mut map);
        ModuleModel::fit(&map).unwrap_err().to_string()
    };
    let few = fails(|map| {
        map.states[3].as_mut().unwrap().slopes.pop();
    });
    assert!(few.contains("one slope a parameter"), "{few}");
    let none = fails(|map| map.states[3].as_mut().unwrap().chart.twist = f64::NAN);
    assert!(none.contains("[0.000, 51.675] kPa is not a finite"), "{none}");
    let limits = fails(|map| {
        map.limit_pressures.pop();
    });
    assert!(limits.contains("2 FREEs, but its map has 1 limit"), "{limits}");
    let states = fails(|map| {
        map.states.pop();
    });
    assert!(states.contains("20 nodes in all, but the table has 19"), "{states}");
    let all = fails(|map| map.states.iter_mut().for_each(|state| *state = None));
    assert!(all.contains("20 of 20 states of the map are missing or unstable"), "{all}");
    assert!(all.contains("first at pressures [0.000, 0.000] kPa, [0.000, 17.225] kPa"), "{all}");
}

/// A map of two FREEs whose states end, or turn unstable, beyond a sum of pressures.
fn ending(count: usize, unstable: bool) -> actuator::ModuleMap {
    let mut map = module_map(vec![even(count), even(count)], 600);
    for node in 0..map.node_count() {
        if map.node_pressures(node).iter().sum::<f64>() > 1.2 * PRESSURE_MAX {
            if unstable {
                let state = map.states[node].as_mut().unwrap();
                // What lies beyond need not even be near: another branch.
                state.negative_pivots = 1;
                state.chart.position[0] += 0.1;
            } else {
                map.states[node] = None;
            }
        }
    }
    map
}

#[test]
fn the_domain_ends_before_unstable_and_missing_states() {
    let (missing, unstable) = (ending(9, false), ending(9, true));
    let model = ModuleModel::fit(&missing).unwrap();
    assert_eq!(model.splines(), ModuleModel::fit(&unstable).unwrap().splines());
    assert!(model.unstable_nodes() == 28 && model.errors().outside > 100);
    let mut into = model.workspace();
    let step = PRESSURE_MAX / 8.0;
    // The cells without begin above 8 steps in sum.
    for (at, clearance) in [([3.0, 2.0], 1.5), ([0.5, 0.5], 0.5), ([7.5, 0.25], 0.125)] {
        let pressures = at.map(|steps| steps * step);
        assert!(model.evaluate(&pressures, &mut into).is_ok(), "{at:?}");
        let found = model.clearance(&pressures) / step;
        assert!(found > 0.0 && found <= 2.0 * clearance, "{at:?}: {found}");
    }
    let beyond = model.evaluate(&[7.5 * step, 6.5 * step], &mut into).unwrap_err();
    let OutOfDomain::Unstable { beyond: distance } = beyond else { panic!("{beyond:?}") };
    assert!(distance > step && model.clearance(&[7.5 * step, 6.5 * step]) == -distance);
    assert!(beyond.to_string().contains("kPa beyond the stable states"), "{beyond}");
    assert!(model.evaluate(&[-1.0, 0.0], &mut into).is_err());
}

#[test]
fn splines_that_run_on_over_a_boundary_err_little_more_than_within() {
    let (whole, cut) = (module_map(vec![even(9); 2], 600), ending(9, false));
    let [whole, cut] = [&whole, &cut].map(|map| ModuleModel::fit(map).unwrap());
    assert!(cut.errors().position.count > 250);
    assert!(
        cut.errors().position.p95 < 2.0 * whole.errors().position.p95,
        "{} {}",
        cut.errors().position.p95,
        whole.errors().position.p95
    );
    assert!(cut.errors().position.worst < 3.0 * whole.errors().position.worst);
}
