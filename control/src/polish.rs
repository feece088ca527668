//! Newton steps that end on the bounds exactly: what an interior-point method leaves is finished here.

use crate::problem::{Point, Problem};
use nalgebra::{DMatrix, DVector, SVD, SymmetricEigen, Vector6};
use rom::PoseModel;

/// Weighted error (m) at which a target is met as well as numbers allow: 1e-9 of a module of 0.1 m.
pub(crate) const MET: f64 = 1e-10;
/// Singular values of the Jacobian below this share of the largest count as zero: along such a pressure change of the whole box
/// the tip moves less than 1e-8 m.
pub(crate) const RANK: f64 = 1e-7;

/// Singular value decomposition of the columns `frees` of the Jacobian.
pub(crate) fn decompose(point: &Point, frees: &[usize]) -> Option<SVD<f64, nalgebra::Dyn, nalgebra::Dyn>> {
    SVD::try_new(point.jacobian.select_columns(frees), true, true, f64::EPSILON, 200)
}

/// The smallest step of the pressures not in `held` that takes the linearised error to zero as far as the box allows: a
/// pressure whose step leaves the box stops at its bound and the others make up for it.
fn least_norm_step<M: PoseModel + ?Sized>(
    problem: &Problem<M>,
    point: &Point,
    held: &[bool],
) -> Option<DVector<f64>> {
    let n = problem.count();
    let mut step = DVector::zeros(n);
    let mut frees: Vec<usize> = (0..n).filter(|&free| !held[free] && !problem.is_fixed(free)).collect();
    while !frees.is_empty() {
        let error = point.error + &point.jacobian * &step;
        let svd = decompose(point, &frees)?;
        let threshold = RANK * svd.singular_values.max();
        let part = svd.solve(&DVector::from_column_slice((-error).as_slice()), threshold).ok()?;
        let mut stopped = Vec::new();
        for (&free, part) in frees.iter().zip(part.iter()) {
            let (below, above) = problem.room(&point.pressures, free);
            if *part < below || *part > above {
                stopped.push((free, part.clamp(below, above)));
            }
        }
        if stopped.is_empty() {
            frees.iter().zip(part.iter()).for_each(|(&free, part)| step[free] = *part);
            return Some(step);
        }
        for (free, bound) in stopped {
            step[free] = bound;
            frees.retain(|&other| other != free);
        }
    }
    Some(step)
}

/// Newton's method on the error itself, by least-norm steps. True when the error is met; `point` then is the last one.
pub(crate) fn restore<M: PoseModel + ?Sized>(
    problem: &mut Problem<M>,
    point: &mut Point,
    held: &[bool],
    iterations: &mut usize,
) -> Result<bool, String> {
    for _ in 0..12 {
        if point.error.norm() <= MET {
            return Ok(true);
        }
        let Some(step) = least_norm_step(problem, point, held) else { return Ok(false) };
        *iterations += 1;
        let trial = problem.evaluate(problem.moved(&point.pressures, &step, 1.0))?;
        // Quadratic convergence at least halves the error; otherwise this is no place for Newton's method.
        if trial.error.norm() > 0.5 * point.error.norm() {
            let met = trial.error.norm().min(point.error.norm()) <= 10.0 * MET;
            return Ok(met);
        }
        *point = trial;
    }
    Ok(point.error.norm() <= 10.0 * MET)
}

/// Newton's method on the cost with the bounds projected (Bertsekas): pressures at a bound that the gradient pushes outwards
/// are held there, the others take a Newton step with the true second derivatives, their eigenvalues made positive.
pub(crate) fn minimise<M: PoseModel + ?Sized>(
    problem: &mut Problem<M>,
    point: &mut Point,
    iterations: &mut usize,
) -> Result<(), String> {
    let n = problem.count();
    hold_exactly(problem, point)?;
    for _ in 0..60 {
        // 1e-10 of the error: the nearest pose is then known to far below a nanometre.
        if problem.stationarity(point) <= 1e-10 || point.error.norm() <= MET {
            return Ok(());
        }
        *iterations += 1;
        let gradient = point.gradient();
        let closeness = problem.stationarity(point).min(1e-4);
        let outward = |free: usize| {
            let (below, above) = problem.room(&point.pressures, free);
            (-below <= closeness && gradient[free] > 0.0) || (above <= closeness && gradient[free] < 0.0)
        };
        let inside: Vec<usize> = (0..n).filter(|&free| !outward(free) && !problem.is_fixed(free)).collect();
        let hessian = point.jacobian.tr_mul(&point.jacobian) + problem.curvature(point, &point.error)?;
        // Held pressures go the rest of the way to their bound.
        let mut step = DVector::from_fn(n, |free, _| {
            let (below, above) = problem.room(&point.pressures, free);
            if gradient[free] > 0.0 { below } else { above }
        });
        (0..n).filter(|&free| problem.is_fixed(free)).for_each(|free| step[free] = 0.0);
        if !inside.is_empty() {
            let part = newton_step(&hessian, &gradient, &inside, point.jacobian.norm_squared());
            inside.iter().zip(part.iter()).for_each(|(&free, part)| step[free] = *part);
        }
        if !line_search(problem, point, &step, &gradient)? {
            return Ok(());
        }
    }
    Ok(())
}

/// Puts pressures that the gradient pushes against a bound less than a millionth of the box away on the bound: an interior-point
/// method stops just short of it.
fn hold_exactly<M: PoseModel + ?Sized>(problem: &mut Problem<M>, point: &mut Point) -> Result<(), String> {
    let gradient = point.gradient();
    let step = DVector::from_fn(problem.count(), |free, _| {
        let (below, above) = problem.room(&point.pressures, free);
        let to_bound = if gradient[free] > 0.0 { below } else { above };
        if gradient[free] != 0.0 && to_bound.abs() < 1e-6 { to_bound } else { 0.0 }
    });
    if step.iter().any(|step| *step != 0.0) {
        let trial = problem.evaluate(problem.moved(&point.pressures, &step, 1.0))?;
        // Downhill to first order; the tolerance is for rounding.
        if trial.cost() <= point.cost() * (1.0 + 1e-13) {
            *point = trial;
        }
    }
    Ok(())
}

/// `-|H|^-1 g` over the pressures `inside`, with eigenvalues of at least 1e-9 `trace`.
fn newton_step(
    hessian: &DMatrix<f64>,
    gradient: &DVector<f64>,
    inside: &[usize],
    trace: f64,
) -> DVector<f64> {
    let eigen = SymmetricEigen::new(hessian.select_rows(inside).select_columns(inside));
    let mut along = eigen.eigenvectors.tr_mul(&gradient.select_rows(inside));
    for (component, value) in along.iter_mut().zip(eigen.eigenvalues.iter()) {
        *component /= -value.abs().max(1e-9 * trace);
    }
    let step = &eigen.eigenvectors * along;
    // A longer step than the box is no local step.
    let longest = step.amax();
    if longest > 1.0 { step / longest } else { step }
}

/// Halves the projected step until the cost falls; where rounding hides the cost, the stationarity must halve instead.
fn line_search<M: PoseModel + ?Sized>(
    problem: &mut Problem<M>,
    point: &mut Point,
    step: &DVector<f64>,
    gradient: &DVector<f64>,
) -> Result<bool, String> {
    let stationarity = problem.stationarity(point);
    let mut fraction = 1.0;
    for _ in 0..30 {
        let trial = problem.evaluate(problem.moved(&point.pressures, step, fraction))?;
        let descent: f64 = (0..problem.count())
            .map(|free| gradient[free] * (trial.pressures[free] - point.pressures[free]) / problem.scale)
            .sum();
        let falls = descent < 0.0 && trial.cost() <= point.cost() + 1e-4 * descent;
        let hidden = trial.cost() <= point.cost() * (1.0 + 1e-13);
        if falls && trial.cost() < point.cost()
            || hidden && problem.stationarity(&trial) <= 0.5 * stationarity
        {
            *point = trial;
            return Ok(true);
        }
        fraction *= 0.5;
    }
    Ok(false)
}

/// Multipliers of the error in the stationarity of a function with this gradient: least-squares `l` of `J' l = -gradient` over
/// the pressures `inside`.
pub(crate) fn multipliers(point: &Point, gradient: &DVector<f64>, inside: &[usize]) -> Vector6<f64> {
    let Some(svd) = (!inside.is_empty()).then(|| decompose(point, inside)).flatten() else {
        return Vector6::zeros();
    };
    let (Some(u), Some(v_t)) = (&svd.u, &svd.v_t) else { return Vector6::zeros() };
    let mut multipliers = Vector6::zeros();
    let along = v_t * gradient.select_rows(inside);
    // A nearly singular direction would give huge multipliers and with them useless curvature.
    let threshold = 1e-4 * svd.singular_values.max();
    for (index, &value) in svd.singular_values.iter().enumerate().filter(|(_, value)| **value > threshold) {
        multipliers -= u.column(index) * (along[index] / value);
    }
    multipliers
}

/// The matrix with its eigenvalues brought into `least..=greatest`.
pub(crate) fn with_eigenvalues_between(matrix: DMatrix<f64>, least: f64, greatest: f64) -> DMatrix<f64> {
    let mut eigen = SymmetricEigen::new(matrix);
    eigen.eigenvalues.apply(|value| *value = value.clamp(least, greatest));
    eigen.recompose()
}
