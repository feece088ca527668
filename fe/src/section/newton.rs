use super::{
    problem::{Problem, State, Step},
    system::System,
};
use nalgebra::{Matrix3, Vector3};

/// Relative residual and volume error at which a state counts as converged. Rounding leaves 1e-12 to 1e-9, most where
/// stiff fibres at small angles carry little.
const TOLERANCE: f64 = 1e-10;
/// What is accepted where a further step does not help any more: rounding is reached.
const TOLERANCE_AT_ROUNDING: f64 = 5e-9;
/// Newton converges in three to six steps from a good start; what needs more is better reached by a shorter way.
const MOST_STEPS: usize = 14;
/// Halvings of one step before it is given up.
const MOST_HALVINGS: usize = 6;

/// What is given of one of the pairs (stretch, force), (twist, torque), (pressure, enclosed volume).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Given {
    /// The first of the pair.
    Value(f64),
    /// The second of the pair.
    Conjugate(f64),
}

/// What is given of the three pairs.
pub(crate) type Control = [Given; 3];

/// A state was found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Converged {
    pub steps: usize,
    pub residual: f64,
}

/// No stable one was found; the residual where the iteration gave up, NaN if an element was turned inside out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Failed {
    pub residual: f64,
}

/// Newton's method on a section, with its workspace.
#[derive(Clone, Debug)]
pub(crate) struct Newton {
    pub system: System,
    /// Stiffness inverse times the border's columns.
    answers: [Vec<f64>; 3],
    step: Step,
    base: State,
    /// Relative residual at which a state counts as converged.
    pub tolerance: f64,
}

impl Newton {
    pub fn new(problem: &Problem) -> Self {
        let system = problem.system();
        Newton {
            answers: system.columns.clone(),
            system,
            step: Step::new(problem),
            base: problem.rest(),
            tolerance: TOLERANCE,
        }
    }

    /// Factors the stiffness and returns the stiffness of (lambda, psi, p) with the inner unknowns at rest: the Schur
    /// complement D - C^T K^-1 C. Also the number of negative pivots: zero means that the wall is stable at given lambda, psi, p.
    pub fn condense(&mut self) -> Result<(Matrix3<f64>, usize), Failed> {
        let Ok(negative) = self.system.stiffness.factorise() else {
            return Err(Failed { residual: f64::NAN });
        };
        for (answer, column) in self.answers.iter_mut().zip(&self.system.columns) {
            answer.copy_from_slice(column);
            self.system.stiffness.solve(answer);
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let schur = Matrix3::from_fn(|i, j| {
            self.system.corner[i][j] - dot(&self.system.columns[i], &self.answers[j])
        });
        Ok((0.5 * (schur + schur.transpose()), negative))
    }

    /// As [`Newton::condense`], where the wall is stable at given lambda, psi and p; Newton's method may jump past a fold to a
    /// state that is not.
    pub fn condense_stable(&mut self) -> Result<Matrix3<f64>, Failed> {
        let residual = self.system.relative_residual();
        match self.condense()? {
            (schur, 0) => Ok(schur),
            _ => Err(Failed { residual }),
        }
    }

    /// As [`Newton::condense`], where wall, stretch and twist are stable at given volume: W is least there exactly where the second
    /// derivatives of W - p (V - V0) by everything and p have one negative eigenvalue. Those of a matrix are those of a block and of its
    /// Schur complement together.
    fn condense_stable_by_volume(&mut self) -> Result<Matrix3<f64>, Failed> {
        let residual = self.system.relative_residual();
        let (schur, negative) = self.condense()?;
        let of_globals = schur.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
        if negative + of_globals == 1 { Ok(schur) } else { Err(Failed { residual }) }
    }

    fn global_residual(&self, state: &State, control: &Control, parts: &[f64; 2]) -> Vector3<f64> {
        // Where a value is given: how far it is off. Else the derivative of the potential minus the load; for the pressure
        // dP/dp = -V.
        let conjugate = [parts[0], parts[1], -self.system.volume];
        Vector3::from_fn(|i, _| match control[i] {
            Given::Value(value) => state.globals[i] - value,
            Given::Conjugate(load) if i == 2 => conjugate[i] + load,
            Given::Conjugate(load) => conjugate[i] - load,
        })
    }

    /// Residual of the linearised state: the largest of force balance, volume equations and what is given.
    fn residual(&self, state: &State, control: &Control) -> f64 {
        let globals = self.global_residual(state, control, &self.system.global_residual);
        self.system.relative_residual().max(self.system.dilation).max(globals.amax())
    }

    fn compute_step(&mut self, problem: &Problem, state: &State, control: &Control) -> Result<(), Failed> {
        let (schur, _) = self.condense()?;
        self.step.inner.copy_from_slice(&self.system.right);
        self.system.stiffness.solve(&mut self.step.inner);
        let mut residual = self.global_residual(state, control, &self.system.global_right);
        let mut matrix = schur;
        for i in 0..3 {
            if let Given::Value(_) = control[i] {
                matrix.set_row(i, &Matrix3::identity().row(i));
            } else {
                let column = &self.system.columns[i];
                residual[i] -= column.iter().zip(&self.step.inner).map(|(x, y)| x * y).sum::<f64>();
            }
        }
        let mut globals = matrix.lu().solve(&-residual).ok_or(Failed { residual: f64::NAN })?;
        for i in 0..3 {
            if let Given::Value(value) = control[i] {
                // Free of the rounding of the elimination.
                globals[i] = value - state.globals[i];
            }
        }
        for (index, value) in self.step.inner.iter_mut().enumerate() {
            *value = -*value - (0..3).map(|a| self.answers[a][index] * globals[a]).sum::<f64>();
        }
        self.step.globals = globals.into();
        problem.complete(&self.system, &mut self.step, true);
        Ok(())
    }

    /// Brings `state` to the equilibrium under `control`; on success the system is linearised there. On failure the state is
    /// what the iteration left and must not be used.
    pub fn solve(
        &mut self,
        problem: &Problem,
        state: &mut State,
        control: &Control,
    ) -> Result<Converged, Failed> {
        if problem.linearise(state, &mut self.system).is_err() {
            return Err(Failed { residual: f64::NAN });
        }
        let mut residual = self.residual(state, control);
        let mut stalled = false;
        for steps in 0..MOST_STEPS {
            if residual < self.tolerance || (stalled && residual < TOLERANCE_AT_ROUNDING) {
                return Ok(Converged { steps, residual });
            }
            self.compute_step(problem, state, control)?;
            self.base.clone_from(state);
            let mut factor = 1.0;
            let mut halvings = 0;
            loop {
                problem.advance(state, &self.step, factor);
                let next = match problem.linearise(state, &mut self.system) {
                    Ok(()) => self.residual(state, control),
                    Err(_) => f64::INFINITY,
                };
                // The first step imposes the new load along the tangent; what it leaves is of second order and is not to be
                // compared with what was there before.
                if next < 2.0 * residual || (steps == 0 && next.is_finite()) {
                    stalled = next > 0.1 * residual;
                    residual = next;
                    break;
                }
                halvings += 1;
                if halvings > MOST_HALVINGS {
                    return Err(Failed { residual: if next.is_finite() { next } else { f64::NAN } });
                }
                factor *= 0.5;
                state.clone_from(&self.base);
            }
        }
        if residual < TOLERANCE_AT_ROUNDING {
            return Ok(Converged { steps: MOST_STEPS, residual });
        }
        Err(Failed { residual })
    }

    /// Change of the state with the enclosed volume at given force and torque, per volume; its third global is dp/dV. Returns the
    /// stiffness of (lambda, psi, p). Fails where the wall is unstable at given lambda, psi and p; with `by_volume`, only where it is
    /// unstable at given volume.
    pub fn volume_tangent(
        &mut self,
        problem: &Problem,
        tangent: &mut Step,
        by_volume: bool,
    ) -> Result<Matrix3<f64>, Failed> {
        let schur = match by_volume {
            false => self.condense_stable()?,
            true => self.condense_stable_by_volume()?,
        };
        let globals = schur.lu().solve(&Vector3::new(0.0, 0.0, -1.0)).ok_or(Failed { residual: f64::NAN })?;
        for (index, value) in tangent.inner.iter_mut().enumerate() {
            *value = -(0..3).map(|a| self.answers[a][index] * globals[a]).sum::<f64>();
        }
        tangent.globals = globals.into();
        problem.complete(&self.system, tangent, false);
        Ok(schur)
    }
}
