use super::*;
use crate::synthetic::{LIMIT, PRESSURE_MAX, module_map, module_state};

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
    assert_eq!(other.chart, model.chart, "a check state has changed the fit");
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
    assert_eq!(error, OutOfDomain { free: 0, pressure: 59e3, lower: 0.0, upper: 58.8e3 });
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
fn missing_nodes_are_named() {
    let mut map = module_map(vec![even(4), even(5)], 0);
    map.states[6] = None;
    map.states[13] = None;
    let message = ModuleModel::fit(&map).unwrap_err().to_string();
    assert!(message.contains("2 of 20 states"), "{message}");
    assert!(message.contains("[22.967, 17.225] kPa, [45.933, 51.675] kPa"), "{message}");
    map = module_map(vec![even(4), even(5)], 0);
    map.states[3].as_mut().unwrap().slopes.pop();
    assert!(ModuleModel::fit(&map).unwrap_err().to_string().contains("one slope a parameter"));
    map = module_map(vec![even(4), even(5)], 0);
    map.states[3].as_mut().unwrap().chart.twist = f64::NAN;
    assert!(ModuleModel::fit(&map).unwrap_err().to_string().contains("[0.000, 51.675] kPa is not a finite"));
    map = module_map(vec![even(4), even(5)], 0);
    map.limit_pressures.pop();
    assert!(ModuleModel::fit(&map).unwrap_err().to_string().contains("2 FREEs, but its map has 1 limit"));
    map.states.pop();
    assert!(ModuleModel::fit(&map).is_err());
}

#[test]
fn buckled_nodes_are_told() {
    // The synthetic module is buckled where no FREE has 1 kPa: at the node of rest.
    let model = model(&[5, 4]);
    assert_eq!(model.buckled_nodes(), [[0.0, 0.0]]);
    assert!(model.is_near_buckling(&[3e3, 20e3]));
    assert!(model.is_near_buckling(&[-3e3, -2.0]));
    assert!(!model.is_near_buckling(&[18e3, 20e3]));
    assert!(!model.is_near_buckling(&[3e3, 24e3]));
    assert!(!model.is_near_buckling(&[PRESSURE_MAX, PRESSURE_MAX]));
    // A node in the middle belongs to the cells on all its sides.
    let mut map = module_map(vec![even(5), even(4)], 0);
    map.states[2 * 4 + 1].as_mut().unwrap().negative_pivots = 2;
    let model = ModuleModel::fit(&map).unwrap();
    let node = map.node_pressures(9);
    assert_eq!(model.buckled_nodes(), [vec![0.0, 0.0], node.clone()]);
    for (x, y) in [(-5e3, -5e3), (-5e3, 5e3), (5e3, -5e3), (5e3, 5e3)] {
        assert!(model.is_near_buckling(&[node[0] + x, node[1] + y]));
    }
    assert!(!model.is_near_buckling(&[node[0] + 20e3, node[1]]));
    let single = ModuleModel::fit(&module_map(vec![vec![0.0], even(4)], 0)).unwrap();
    assert!(single.is_near_buckling(&[0.0, 1e3]));
    assert!(!single.is_near_buckling(&[0.0, 30e3]));
}
