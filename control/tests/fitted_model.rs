//! The same on a fitted model: splines with their kinks in the third derivative and their domain.

mod analytic_module;

use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, Limits, Module, ModuleMap, ModuleState, OgdenForm,
    PlacedFree, Tip, Tube, Winding,
};
use analytic_module::*;
use control::{Bounds, Preference, SolveInput, Solver, Status, Target, solve};
use rom::{ModuleModel, PoseModel};

/// A model fitted to the analytic module on seven nodes an axis; FREE 3 has its limit pressure inside the map.
fn fitted(module: &AnalyticModule) -> ModuleModel {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::Linear };
    let free = Free {
        tube: Tube { length: LENGTH, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(30f64.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    let axis: Vec<f64> = (0..7).map(|node| 70e3 * node as f64 / 6.0).collect();
    let mut map = ModuleMap {
        module: Module {
            frees: [[0.01, 0.01], [-0.01, 0.01], [-0.01, -0.01], [0.01, -0.01]]
                .map(|position| PlacedFree { free, position })
                .to_vec(),
            tip: Tip { plate_mass: 0.03, payload: 0.0, free_dof: [true; 6] },
            base: Base { gravity: [0.0, 0.0, 1.0], free_mass: 0.01 },
            spacers: 0,
        },
        limits: Limits { pressure_max: vec![65e3, 69e3, 69e3, 50e3], pressure_rate: 2e5, idle_pressure: 2e3 },
        parameters: vec![],
        pressures: vec![axis; 4],
        states: vec![],
        checks: vec![],
        limit_pressures: vec![None, None, Some(62e3), None],
        settings: "closed form".into(),
        source: ("analytic".into(), String::new()),
    };
    let state = |node| {
        let chart = chart_at(module, &map.node_pressures(node));
        Some(ModuleState { chart, slopes: vec![], negative_pivots: 0, residual: 0.0, gap: None })
    };
    map.states = (0..map.node_count()).map(state).collect();
    ModuleModel::fit(&map).unwrap()
}

#[test]
fn bounds_keep_clear_of_the_limit_pressure() {
    let model = fitted(&AnalyticModule::alternating());
    let bounds = Bounds::of_model(&model, 3e3).unwrap();
    assert_eq!(bounds.lower, [2e3; 4]);
    assert_eq!(bounds.upper, [65e3, 69e3, 59e3, 50e3]);
    assert_eq!(bounds.limit, [70e3, 70e3, 62e3, 70e3]);
    assert!(model.domain()[2].1 < 62e3);
    let solution = solve(&model, &SolveInput::new(Target::at([0.0, 0.0, 5.0]), bounds.clone()));
    let answer = solution.answer.unwrap();
    let margins = answer.pressures.iter().zip(&bounds.limit).map(|(p, limit)| limit - p);
    assert_eq!(answer.limit_margin, margins.fold(f64::INFINITY, f64::min));
}

#[test]
fn two_hundred_targets_of_a_fitted_model_are_reached() {
    for module in [AnalyticModule::alternating(), AnalyticModule::all_right()] {
        let model = fitted(&module);
        let bounds = Bounds::of_model(&model, 0.0).unwrap();
        let mut solver = Solver::new(&model);
        let mut numbers = Numbers(21);
        for case in 0..200 {
            let pose = chart_at(&model, &numbers.pressures(&bounds)).to_pose();
            for target in [Target::at(pose.position.into()), Target::pose(&pose, LENGTH)] {
                let mut input = SolveInput::new(target, bounds.clone());
                input.preference = if case % 2 == 0 { Preference::LeastPressure } else { Preference::Margin };
                let solution = solver.solve(&input);
                assert_eq!(solution.status, Status::Reached, "case {case}: {}", solution.reason);
                let answer = solution.answer.unwrap();
                assert!(answer.position_error < 2e-9, "case {case}: {:e}", answer.position_error);
                assert!(answer.rotation_error.unwrap_or(0.0) < 1e-8);
                for free in 0..4 {
                    assert!((bounds.lower[free]..=bounds.upper[free]).contains(&answer.pressures[free]));
                }
            }
        }
    }
}

#[test]
fn unreachable_targets_of_a_fitted_model_end_stationary() {
    let model = fitted(&AnalyticModule::all_right());
    let bounds = Bounds::of_model(&model, 0.0).unwrap();
    let mut solver = Solver::new(&model);
    let mut numbers = Numbers(4);
    let mut unreached = 0;
    for case in 0..60 {
        let mut position = [0.0; 3];
        position.iter_mut().for_each(|x| *x = 0.5 * (numbers.next() - 0.5));
        let solution = solver.solve(&SolveInput::new(Target::at(position), bounds.clone()));
        let answer = solution.answer.unwrap();
        assert!(answer.stationarity < 1e-6, "case {case}: {:e} {}", answer.stationarity, solution.reason);
        unreached += usize::from(solution.status == Status::Unreachable);
    }
    assert!(unreached > 40, "{unreached}");
}
