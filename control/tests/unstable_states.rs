//! A module that has no stable state at some pressures of its box: the others are found, and none of those is ever given.

mod analytic_module;

use analytic_module::*;
use control::{Preference, SolveInput, Solver, Status, Target};
use rom::{OutOfDomain, PoseEvaluation, PoseModel};

/// Stable up to a sum of pressures (Pa).
struct Swaying(AnalyticModule, f64);

impl PoseModel for Swaying {
    fn domain(&self) -> &[(f64, f64)] {
        self.0.domain()
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        let beyond = pressures.iter().sum::<f64>() - self.1;
        if beyond >= 0.0 { Err(OutOfDomain::Unstable { beyond }) } else { self.0.evaluate(pressures, into) }
    }
}

#[test]
fn targets_of_stable_states_are_reached_by_stable_states() {
    let (model, stable) = (AnalyticModule::alternating(), Swaying(AnalyticModule::alternating(), 130e3));
    let bounds = bounds(4, 2e3, 65e3);
    let mut solver = Solver::new(&stable);
    let mut numbers = Numbers(11);
    let (mut reached, mut asked, mut beyond) = (0, 0, 0);
    while asked < 200 {
        let truth = numbers.pressures(&bounds);
        let is_stable = truth.iter().sum::<f64>() < 125e3;
        let pose = chart_at(&model, &truth).to_pose();
        let mut input = SolveInput::new(Target::pose(&pose, LENGTH), bounds.clone());
        input.preference = Preference::LeastPressure;
        let solution = solver.solve(&input);
        if let Some(answer) = &solution.answer {
            assert!(answer.pressures.iter().sum::<f64>() < 130e3, "{solution:?}");
            assert!(solution.status != Status::Refused);
        }
        if is_stable {
            asked += 1;
            reached += usize::from(solution.status == Status::Reached);
        } else {
            beyond += usize::from(solution.status != Status::Reached);
        }
    }
    assert_eq!(reached, asked);
    assert!(beyond > 50, "only {beyond} poses of unstable states were not reached");
}

#[test]
fn where_nothing_is_stable_no_pressures_are_given() {
    let model = Swaying(AnalyticModule::alternating(), 1e3);
    let target = Target::at([0.0, 0.0, 0.18]);
    let solution = control::solve(&model, &SolveInput::new(target, bounds(4, 2e3, 65e3)));
    assert!(solution.status == Status::Refused && solution.answer.is_none());
    assert!(solution.reason.contains("no stable state"), "{}", solution.reason);
}
