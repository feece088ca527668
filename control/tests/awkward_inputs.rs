//! Questions that have no answer, or a trivial one: refused with a reason, or answered within the bounds; nothing panics.

mod analytic_module;

use analytic_module::*;
use control::{Bounds, Preference, SolveInput, Solver, Status, Target, Tolerance, solve};
use rom::{OutOfDomain, PoseEvaluation, PoseModel};

fn input() -> SolveInput {
    let model = AnalyticModule::alternating();
    let pose = chart_at(&model, &[30e3, 20e3, 10e3, 40e3]).to_pose();
    SolveInput::new(Target::pose(&pose, LENGTH), bounds(4, 2e3, 65e3))
}

#[test]
fn what_cannot_be_answered_is_refused_with_the_reason() {
    let model = AnalyticModule::alternating();
    type Change = fn(&mut SolveInput);
    let table: [(Change, &str); 19] = [
        (|i| i.target.position[1] = f64::NAN, "target's y is NaN"),
        (|i| i.target.position[2] = f64::INFINITY, "target's z is inf"),
        (|i| i.target.position[2] = 170e3, "metres"),
        (|i| i.target.rotation = Some([0.0; 4]), "quaternion"),
        (|i| i.target.rotation = Some([1.0, f64::NAN, 0.0, 0.0]), "qx is NaN"),
        (|i| i.target.position_weight = -1.0, "position weight is -1"),
        (|i| i.target.rotation_weight = f64::NAN, "rotation weight is NaN"),
        (|i| i.bounds.lower[2] = 66e3, "p3 are crossed: 66 to 65 kPa"),
        (|i| i.bounds.upper[0] = f64::NAN, "bounds of p1"),
        (|i| i.bounds.upper[3] = 71e3, "bounds of p4, 2 to 71 kPa, leave the model's domain, 0 to 70 kPa"),
        (|i| i.bounds.lower[3] = -1.0, "leave the model's domain"),
        (|i| i.bounds.limit.truncate(3), "limit bounds have 3 entries"),
        (|i| i.from = Some(vec![1e3; 3]), "3 start pressures for 4 FREEs"),
        (|i| i.from = Some(vec![1e3, 1e3, f64::NAN, 1e3]), "start pressure of p3 is NaN"),
        (|i| i.step_limit = Some(1e3), "needs the pressures to step from"),
        (|i| (i.from, i.step_limit) = (Some(vec![5e3; 4]), Some(-1.0)), "step limit is -1"),
        (
            |i| (i.from, i.step_limit) = (Some(vec![5e3, 5e3, 5e3, 90e3]), Some(1e3)),
            "p4 stands at 90.000 kPa",
        ),
        (|i| i.preference = Preference::LeastChange, "pressures of now"),
        (|i| i.tolerance = Tolerance { position: 0.0, rotation: 1.0 }, "position tolerance is 0"),
    ];
    for (change, expected) in table {
        let mut asked = input();
        change(&mut asked);
        let solution = solve(&model, &asked);
        assert_eq!(solution.status, Status::Refused, "{expected}: {solution:?}");
        assert!(solution.answer.is_none());
        assert!(solution.reason.contains(expected), "`{}` lacks `{expected}`", solution.reason);
    }
    assert_eq!(solve(&model, &input()).status, Status::Reached);
}

/// Answers with NaN beyond a pressure, or not at all.
struct Torn(AnalyticModule, bool);

impl PoseModel for Torn {
    fn domain(&self) -> &[(f64, f64)] {
        self.0.domain()
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        self.0.evaluate(pressures, into)?;
        if pressures[1] > 30e3 {
            if self.1 {
                return Err(OutOfDomain::Pressure {
                    free: 1,
                    pressure: pressures[1],
                    lower: 0.0,
                    upper: 30e3,
                });
            }
            into.jacobian[1][3] = f64::NAN;
        }
        Ok(())
    }
}

#[test]
fn a_model_that_fails_inside_its_domain_gives_no_pressures() {
    for (fails, expected) in [(false, "not a number"), (true, "outside the model's domain")] {
        let solution = solve(&Torn(AnalyticModule::alternating(), fails), &input());
        assert_eq!(solution.status, Status::Refused);
        assert!(solution.answer.is_none() && solution.reason.contains(expected), "{}", solution.reason);
    }
}

#[test]
fn no_free_is_refused() {
    let model = AnalyticModule::new(&[]);
    let none = Bounds { lower: vec![], upper: vec![], limit: vec![] };
    let solution = solve(&model, &SolveInput::new(Target::at([0.0, 0.0, 0.17]), none));
    assert_eq!(solution.status, Status::Refused);
}

#[test]
fn equal_bounds_are_kept_and_the_others_do_the_work() {
    let model = AnalyticModule::alternating();
    let truth = [30e3, 20e3, 12_345.678, 40e3];
    let mut asked =
        SolveInput::new(Target::at(chart_at(&model, &truth).to_pose().position.into()), bounds(4, 2e3, 65e3));
    (asked.bounds.lower[2], asked.bounds.upper[2]) = (truth[2], truth[2]);
    for preference in [Preference::LeastPressure, Preference::Margin] {
        asked.preference = preference;
        let solution = solve(&model, &asked);
        assert_eq!(solution.status, Status::Reached);
        assert_eq!(solution.answer.unwrap().pressures[2].to_bits(), truth[2].to_bits());
    }
    // Nothing left to choose: the pose is what it is.
    asked.bounds.lower = truth.to_vec();
    asked.bounds.upper = truth.to_vec();
    let solution = solve(&model, &asked);
    assert_eq!(solution.status, Status::Reached);
    assert_eq!(solution.answer.unwrap().pressures, truth);
    asked.target.position[0] += 0.01;
    let solution = solve(&model, &asked);
    assert_eq!(solution.status, Status::Unreachable);
    assert!((solution.answer.unwrap().position_error - 0.01).abs() < 1e-12);
}

#[test]
fn a_weight_of_zero_leaves_its_part_free() {
    let model = AnalyticModule::alternating();
    let mut asked = input();
    let wanted = asked.target.clone();
    asked.target.rotation_weight = 0.0;
    asked.target.rotation = Some([0.0, 1.0, 0.0, 0.0]);
    let answer = solve(&model, &asked).answer.unwrap();
    assert!(answer.position_error < 1e-9 && answer.rotation_error.unwrap() > 0.1);
    asked.target = Target { position: [1.0; 3], position_weight: 0.0, ..wanted };
    let solution = solve(&model, &asked);
    assert_eq!(solution.status, Status::Reached);
    let answer = solution.answer.unwrap();
    assert!(answer.rotation_error.unwrap() < 1e-8 && answer.position_error > 0.5);
    // Nothing asked for: only the preference is left.
    asked.target.rotation_weight = 0.0;
    let solution = solve(&model, &asked);
    assert_eq!((solution.status, solution.answer.unwrap().pressures), (Status::Reached, vec![2e3; 4]));
    asked.preference = Preference::Margin;
    for pressure in solve(&model, &asked).answer.unwrap().pressures {
        // 1e-4 of the box: what an interior-point answer of a problem with a corner is good for.
        assert!((pressure - 33.5e3).abs() < 6.3, "{pressure}");
    }
}

#[test]
fn a_start_outside_the_bounds_is_moved_onto_them() {
    let model = AnalyticModule::alternating();
    for preference in [Preference::LeastPressure, Preference::LeastChange, Preference::Margin] {
        let mut asked = input();
        asked.target.rotation = None;
        asked.preference = preference;
        asked.from = Some(vec![-5e3, 200e3, 0.0, 69e3]);
        let solution = solve(&model, &asked);
        assert_eq!(solution.status, Status::Reached);
        let answer = solution.answer.unwrap();
        assert!(answer.pressures.iter().all(|p| (2e3..=65e3).contains(p)));
    }
}

#[test]
fn the_same_input_gives_the_same_bits_whatever_came_before() {
    let model = AnalyticModule::alternating();
    let mut used = Solver::new(&model);
    let mut numbers = Numbers(5);
    let all = bounds(4, 0.0, 70e3);
    for case in 0..30 {
        let mut position: [f64; 3] = chart_at(&model, &numbers.pressures(&all)).to_pose().position.into();
        // Every third target is out of reach.
        position[2] += if case % 3 == 0 { 0.1 } else { 0.0 };
        let mut asked = SolveInput::new(Target::at(position), bounds(4, 1e3 * (case % 2) as f64, 65e3));
        asked.preference = [Preference::LeastPressure, Preference::Margin, Preference::LeastChange][case % 3];
        asked.from = Some(numbers.pressures(&all));
        let fresh = solve(&model, &asked);
        assert_eq!(fresh, used.solve(&asked));
        let bits = |solution: &control::Solution| -> Vec<u64> {
            solution.answer.as_ref().unwrap().pressures.iter().map(|p| p.to_bits()).collect()
        };
        assert_eq!(bits(&fresh), bits(&used.solve(&asked)));
    }
}
