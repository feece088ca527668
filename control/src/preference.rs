use crate::{
    polish::{RANK, decompose, multipliers, restore, with_eigenvalues_between},
    problem::{Point, Problem},
    program::Program,
};
use nalgebra::{DMatrix, DVector};
use rom::PoseModel;
use serde::{Deserialize, Serialize};

/// Which of the pressures that reach a target to take, where several do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preference {
    /// Least sum of squared pressures.
    #[default]
    LeastPressure,
    /// Least sum of squared changes from the pressures of now.
    LeastChange,
    /// Greatest distance to the bounds: the least, over the FREEs, of the distance to the nearer bound relative to half the
    /// width between them, is as large as can be.
    Margin,
}

/// A preference as a function of the pressures, to be made small.
#[derive(Clone, Debug)]
pub(crate) enum Objective {
    /// `1/2 |p - centre|^2 / scale^2`.
    Distance { centre: Vec<f64> },
    /// `max |p - middle| / half width`, over FREEs that may vary.
    Excursion { middle: Vec<f64>, half_width: Vec<f64> },
}

impl Objective {
    pub fn value(&self, pressures: &[f64], scale: f64) -> f64 {
        match self {
            Objective::Distance { centre } => {
                0.5 * pressures.iter().zip(centre).map(|(p, c)| ((p - c) / scale).powi(2)).sum::<f64>()
            }
            Objective::Excursion { middle, half_width } => {
                let away = |free: usize| (pressures[free] - middle[free]).abs() / half_width[free];
                (0..pressures.len()).filter(|&free| half_width[free] > 0.0).map(away).fold(0.0, f64::max)
            }
        }
    }
}

/// Preference steps of one start at most.
const MAX_STEPS: usize = 60;

/// Programs of the preference's steps, one for each rank of the Jacobian that was met.
#[derive(Default)]
pub(crate) struct Programs(Vec<Program>);

impl Programs {
    fn of(&mut self, variables: usize, equalities: usize, rows: usize) -> &mut Program {
        let shape = (variables, equalities, rows);
        let index = self.0.iter().position(|program| program.shape() == shape).unwrap_or_else(|| {
            self.0.push(Program::new(variables, equalities, rows));
            self.0.len() - 1
        });
        &mut self.0[index]
    }
}

/// Lowers the objective on the set of pressures that meet the target, from a `point` of that set.
///
/// A step lies in the null space of the Jacobian (as equalities of the program), in the box and in a trust region; the
/// curvature of the set enters through the multipliers. Each step is followed by Newton's method on the pose error, and
/// counts only if the target is met again and the objective is lower.
pub(crate) fn prefer<M: PoseModel + ?Sized>(
    problem: &mut Problem<M>,
    programs: &mut Programs,
    objective: &Objective,
    point: &mut Point,
    iterations: &mut usize,
) -> Result<(), String> {
    let n = problem.count();
    let inside: Vec<usize> = (0..n).filter(|&free| !problem.is_fixed(free)).collect();
    let held = vec![false; n];
    let mut radius = 0.5;
    for _ in 0..MAX_STEPS {
        if radius < 1e-8 || inside.is_empty() {
            break;
        }
        let Some(svd) = decompose(point, &inside) else { break };
        let threshold = RANK * svd.singular_values.max();
        let rank = svd.singular_values.iter().filter(|value| **value > threshold).count();
        let Some(v_t) = &svd.v_t else { break };
        if rank >= inside.len() {
            break;
        }
        *iterations += 1;
        let Some((step, predicted)) =
            step(problem, programs, objective, point, &inside, &v_t.rows(0, rank).into(), radius)?
        else {
            radius *= 0.25;
            continue;
        };
        if predicted <= 1e-13 {
            break;
        }
        let mut trial = problem.evaluate(problem.moved(&point.pressures, &step, 1.0))?;
        let met = restore(problem, &mut trial, &held, iterations)?;
        let before = objective.value(&point.pressures, problem.scale);
        let ratio = (before - objective.value(&trial.pressures, problem.scale)) / predicted;
        if !met || ratio < 0.25 {
            radius = 0.25 * step.amax().min(radius);
        } else if step.amax() > 0.9 * radius {
            radius = (2.0 * radius).min(1.0);
        } else {
            // Clarabel's answer is good to a share of the trust region: a smaller region makes the last steps exact.
            radius = radius.min(4.0 * step.amax()).max(1e-7);
        }
        if met && ratio > 1e-4 {
            *point = trial;
        }
    }
    snap(problem, objective, point, iterations)
}

/// The step (in units of scale) and the fall of the objective it promises.
fn step<M: PoseModel + ?Sized>(
    problem: &mut Problem<M>,
    programs: &mut Programs,
    objective: &Objective,
    point: &Point,
    inside: &[usize],
    range: &DMatrix<f64>,
    radius: f64,
) -> Result<Option<(DVector<f64>, f64)>, String> {
    let m = inside.len();
    let rank = range.nrows();
    let epigraph = matches!(objective, Objective::Excursion { .. });
    let (variables, rows) = if epigraph { (m + 1, rank + 4 * m) } else { (m, rank + 2 * m) };
    let mut a = DMatrix::zeros(rows, variables);
    let mut b = vec![0.0; rows];
    a.view_mut((0, 0), (rank, m)).copy_from(range);
    for (index, &free) in inside.iter().enumerate() {
        let (below, above) = problem.room(&point.pressures, free);
        a[(rank + index, index)] = 1.0;
        a[(rank + m + index, index)] = -1.0;
        b[rank + index] = (above / radius).min(1.0);
        b[rank + m + index] = (-below / radius).min(1.0);
    }
    let mut p = DMatrix::zeros(variables, variables);
    let mut q = vec![0.0; variables];
    let value = objective.value(&point.pressures, problem.scale);
    match objective {
        Objective::Distance { centre } => {
            let gradient = DVector::from_fn(problem.count(), |free, _| {
                (point.pressures[free] - centre[free]) / problem.scale
            });
            let unbound: Vec<usize> = inside
                .iter()
                .copied()
                .filter(|&free| {
                    let (below, above) = problem.room(&point.pressures, free);
                    below < -1e-6 && above > 1e-6
                })
                .collect();
            let weights = multipliers(point, &gradient, &unbound);
            let full = problem.curvature(point, &weights)?.select_rows(inside).select_columns(inside);
            let hessian = with_eigenvalues_between(full + DMatrix::identity(m, m), 0.05, 100.0);
            // Objective over radius, in s = d/radius.
            p.copy_from(&(&hessian * radius));
            inside.iter().enumerate().for_each(|(index, &free)| q[index] = gradient[free]);
        }
        Objective::Excursion { middle, half_width } => {
            // Minimise t with |p + scale radius s - middle| <= half_width (value + radius t); a little curvature in s makes
            // the answer unique without moving it noticeably.
            for (index, &free) in inside.iter().enumerate() {
                let away = (point.pressures[free] - middle[free]) / half_width[free];
                let slope = problem.scale / half_width[free];
                for (side, sign) in [(0, 1.0), (1, -1.0)] {
                    let row = rank + (2 + side) * m + index;
                    a[(row, index)] = sign * slope;
                    a[(row, m)] = -1.0;
                    // Far from binding rows are relaxed to keep numbers of order one: within the step they cannot bind.
                    b[row] = ((value - sign * away) / radius).min(10.0 * slope.max(1.0));
                }
                p[(index, index)] = 1e-4;
            }
            p[(m, m)] = 1e-6;
            q[m] = 1.0;
        }
    }
    let magnitude = p.amax().max(q.iter().fold(0.0, |most: f64, value| most.max(value.abs())));
    if magnitude == 0.0 {
        return Ok(None);
    }
    p /= magnitude;
    q.iter_mut().for_each(|value| *value /= magnitude);
    let Some(x) = programs.of(variables, rank, rows).solve(&p, &q, &a, &b) else { return Ok(None) };
    let s = DVector::from_fn(m, |index, _| x[index].clamp(-b[rank + m + index], b[rank + index]));
    let predicted = if epigraph {
        -radius * x[m]
    } else {
        let linear: f64 = s.iter().zip(&q).map(|(s, q)| s * q).sum();
        -radius * magnitude * (linear + 0.5 * s.dot(&(&p * &s)))
    };
    let mut step = DVector::zeros(problem.count());
    inside.iter().zip(s.iter()).for_each(|(&free, s)| step[free] = radius * s);
    Ok(Some((step, predicted)))
}

/// Puts pressures that the interior-point steps left beside a bound exactly on it, where the target stays met and the
/// objective does not suffer.
fn snap<M: PoseModel + ?Sized>(
    problem: &mut Problem<M>,
    objective: &Objective,
    point: &mut Point,
    iterations: &mut usize,
) -> Result<(), String> {
    for free in 0..problem.count() {
        let (below, above) = problem.room(&point.pressures, free);
        let bound = if -below < 1e-4 { problem.lower[free] } else { problem.upper[free] };
        if problem.is_fixed(free) || (-below).min(above) >= 1e-4 || point.pressures[free] == bound {
            continue;
        }
        let mut pressures = point.pressures.clone();
        pressures[free] = bound;
        let held: Vec<bool> = (0..problem.count()).map(|other| other == free).collect();
        let mut trial = problem.evaluate(pressures)?;
        let met = restore(problem, &mut trial, &held, iterations)?;
        let before = objective.value(&point.pressures, problem.scale);
        // 1e-9 of the objective is a thousandth of what the last steps left undecided.
        if met && objective.value(&trial.pressures, problem.scale) <= before * (1.0 + 1e-9) {
            *point = trial;
        }
    }
    Ok(())
}
