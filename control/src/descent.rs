use crate::{
    problem::{Point, Problem},
    program::Program,
};
use nalgebra::{DMatrix, DVector};
use rom::PoseModel;

/// Gauss-Newton steps of one start at most; polishing takes over where they end.
const MAX_STEPS: usize = 40;
/// Share of the Jacobian's squared norm added to the Gauss-Newton matrix: it keeps steps from wandering along pressures that do
/// not move the tip, and Clarabel's answer unique.
const DAMPING: f64 = 1e-5;

/// The step program of `frees` pressures: the box and the trust region are one box.
pub(crate) fn step_program(frees: usize) -> Program {
    Program::new(frees, 0, 2 * frees)
}

/// Lowers the pose error from `point` by Gauss-Newton steps in a trust region of the largest pressure change, which folds into
/// the bounds: one box, half of Clarabel's time of a Euclidean ball, never empty. Returns the number of programs solved.
///
/// Each step minimises `1/2 |J d + e|^2 + damping` over `max(room below, -radius) <= d <= min(room above, radius)`; it is
/// written in `d/radius`, so that Clarabel always sees numbers of order one.
pub(crate) fn descend<M: PoseModel + ?Sized>(
    problem: &mut Problem<M>,
    program: &mut Program,
    point: &mut Point,
) -> Result<usize, String> {
    let n = problem.count();
    let mut radius = 0.5;
    let rows = DMatrix::from_fn(2 * n, n, |row, column| match row {
        row if row == column => 1.0,
        row if row == n + column => -1.0,
        _ => 0.0,
    });
    let mut bounds = vec![0.0; 2 * n];
    for steps in 0..MAX_STEPS {
        let trace = point.jacobian.norm_squared();
        // Below 1e-8 m the Newton steps of the polish converge quadratically.
        if trace == 0.0 || point.error.norm() < 1e-8 || problem.stationarity(point) < 1e-7 || radius < 1e-6 {
            return Ok(steps);
        }
        let mut hessian = point.jacobian.tr_mul(&point.jacobian) / trace;
        let mut gradient = point.gradient() / trace;
        for free in 0..n {
            hessian[(free, free)] += DAMPING;
            let (below, above) = problem.room(&point.pressures, free);
            if problem.is_fixed(free) {
                // No room: taken out of the program, whose box must have an inside.
                hessian.row_mut(free).fill(0.0);
                hessian.column_mut(free).fill(0.0);
                hessian[(free, free)] = 1.0;
                gradient[free] = 0.0;
                (bounds[free], bounds[n + free]) = (1.0, 1.0);
            } else {
                (bounds[free], bounds[n + free]) = ((above / radius).min(1.0), (-below / radius).min(1.0));
            }
        }
        let (quadratic, linear) = (&hessian * radius, gradient.clone());
        let magnitude = quadratic.amax().max(linear.amax());
        let Some(x) =
            program.solve(&(quadratic / magnitude), (linear / magnitude).as_slice(), &rows, &bounds)
        else {
            radius *= 0.25;
            continue;
        };
        // An interior-point answer may lie outside its box by rounding.
        let step = DVector::from_fn(n, |free, _| radius * x[free].clamp(-bounds[n + free], bounds[free]));
        let linear_error = point.error + &point.jacobian * &step;
        let predicted = point.cost() - 0.5 * linear_error.norm_squared();
        if predicted <= 1e-14 * point.cost() {
            return Ok(steps + 1);
        }
        let trial = problem.evaluate(problem.moved(&point.pressures, &step, 1.0))?;
        let ratio = (point.cost() - trial.cost()) / predicted;
        if ratio < 0.25 {
            radius = 0.25 * step.amax();
        } else if ratio > 0.75 && step.amax() > 0.9 * radius {
            radius = (2.0 * radius).min(1.0);
        }
        if ratio > 1e-4 {
            let slow = trial.cost() > (1.0 - 1e-6) * point.cost();
            *point = trial;
            if slow {
                return Ok(steps + 1);
            }
        }
    }
    Ok(MAX_STEPS)
}
