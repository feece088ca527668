use super::{
    SolidError,
    body::Follows,
    critical::{CriticalPoint, distance},
    newton::{Control, Lost, SolidSolver},
    path::Parameter,
    stability::SolidMode,
    state::{Motion, SolidState, motion_of},
};
use nalgebra::Vector3;

/// Steps of the amplitude, each this much larger than the last, before no branch is said to be there.
const STEPS: usize = 30;
const GROWTH: f64 = 1.4;
/// Newton steps to one amplitude.
const ITERATIONS: usize = 25;
/// Relative residual of a state on the way; the last one is found without the imperfection, as accurately as all others.
const TOLERANCE: f64 = 1e-7;

/// Two equilibria under the same loads, near a bifurcation.
#[derive(Clone, Debug)]
pub struct Branches {
    /// Parameter of the path.
    pub at: f64,
    /// On the path that was followed, and on the branch that crosses it.
    pub states: [SolidState; 2],
    /// Negative eigenvalues of either at the path's loads.
    pub negative: [usize; 2],
    /// [`SolidSolver::potential`] of either, J; for a path of volumes the energy. The stabler branch has less.
    pub potentials: [f64; 2],
    /// Largest distance between the same points of the two, m.
    pub distance: f64,
}

/// Dead forces that push along a mode.
struct Weights {
    points: Vec<[f64; 3]>,
    cap: Vector3<f64>,
}

/// An imperfect equilibrium: dead forces `factor` M v keep it at an amplitude of the mode.
struct Imperfect {
    state: SolidState,
    amplitude: f64,
    factor: f64,
    /// Motion that led to it from the one before.
    motion: Motion,
}

impl SolidSolver {
    /// Leads from the path to the branch that crosses it at a bifurcation. From the path's equilibrium at `at`, reached from `start` at
    /// `from`, dead forces along M v of the first singular mode v push the body to growing amplitudes of the mode, starting with `size`
    /// (m, of the point that moves most; its sign says to which side). On the unstable side of the bifurcation they have to hold it back at first; where they
    /// vanish is the branch, and they are taken away. `None` where they do not vanish within some thousand times `size`:
    /// then the branch lies on the other side of the bifurcation.
    ///
    /// # Errors
    /// [`SolidError::NotConverged`] where the path or the imperfect equilibria cannot be followed.
    pub fn switch_branch(
        &mut self,
        path: &Parameter<'_>,
        critical: &CriticalPoint,
        (from, start): (f64, &SolidState),
        at: f64,
        size: f64,
    ) -> Result<Option<Branches>, SolidError> {
        let start = path.begin(from, start);
        let primary = self.walk(&start, from, &[at], path, &mut |_, _| true)?;
        let control = match path {
            Parameter::Load(_) => Control::Pressure,
            Parameter::Volume(_) => {
                return Err(SolidError::Invalid {
                    field: "the parameter of the path",
                    value: at,
                    requirement: "branches are sought under prescribed loads",
                });
            }
        };
        let led = self.led_astray(critical, &primary, size);
        self.imperfection = None;
        let Some(near) = led? else { return Ok(None) };
        let reached = self.equilibrate(near.clone(), control);
        let secondary = reached.map_err(|lost| self.lost(&near, lost, "the other branch"))?.0;
        let distance = distance(&primary, &secondary);
        if distance < 0.1 * size.abs() {
            return Ok(None);
        }
        let states = [primary, secondary];
        let negative = [self.stability(&states[0], 0)?.negative, self.stability(&states[1], 0)?.negative];
        let potentials = [0, 1].map(|branch| self.potential(&states[branch]));
        Ok(Some(Branches { at, states, negative, potentials, distance }))
    }

    /// The imperfect equilibrium next to where the imperfection vanishes.
    fn led_astray(
        &mut self,
        critical: &CriticalPoint,
        primary: &SolidState,
        size: f64,
    ) -> Result<Option<SolidState>, SolidError> {
        let Some(mode) = critical.modes.first() else {
            return Err(SolidError::Singular("a critical point without a singular mode".to_owned()));
        };
        let weights = self.weights(mode, primary.load.held);
        self.assemble(primary, true).map_err(|lost| self.lost(primary, lost, "the first branch"))?;
        let displacements: Vec<[f64; 3]> =
            mode.displacements.iter().map(|place| place.map(|u| size * u)).collect();
        let mut motion = motion_of(&self.body.grid, primary, &displacements);
        motion.pressures = self.body.pressure_steps(&displacements, false);
        motion.cap = mode.cap.map(|part| size * part);
        for direction in (0..6).filter(|&direction| primary.load.held[direction]) {
            motion.cap[direction / 3][direction % 3] = 0.0;
        }
        let guess = self.moved(primary, &motion);
        let fail = |solver: &Self, lost: Lost| solver.lost(primary, lost, "an amplitude of the mode");
        let mut last = self
            .at_amplitude(primary, &weights, (guess, motion), size, 0.0)
            .map_err(|lost| fail(self, lost))?;
        let pull = last.factor.signum() * size.signum();
        if pull > 0.0 {
            return Ok(None);
        }
        let mut ahead = size * (GROWTH - 1.0);
        let mut most = last.factor.abs();
        let mut steps = 0;
        while steps < STEPS {
            let target = last.amplitude + ahead;
            let mut motion = last.motion.clone();
            let travelled = if steps == 0 { size } else { last.amplitude * (1.0 - 1.0 / GROWTH) };
            motion.scale((target - last.amplitude) / travelled);
            let guess = self.moved(&last.state, &motion);
            match self.at_amplitude(primary, &weights, (guess, motion), target, last.factor) {
                Ok(next) => {
                    most = most.max(next.factor.abs());
                    if next.factor * last.factor <= 0.0 {
                        let found = self.where_it_vanishes(primary, &weights, [last, next], 1e-6 * most);
                        return found.map(Some).map_err(|lost| fail(self, lost));
                    }
                    last = next;
                    ahead = last.amplitude * (GROWTH - 1.0);
                    steps += 1;
                }
                Err(lost) => {
                    ahead *= 0.5;
                    if ahead.abs() < 1e-3 * last.amplitude.abs() {
                        return Err(fail(self, lost));
                    }
                }
            }
        }
        Ok(None)
    }

    /// The imperfect equilibrium between two whose factors have different signs where it is at most `small`: by the secant through the
    /// last two.
    fn where_it_vanishes(
        &mut self,
        primary: &SolidState,
        weights: &Weights,
        [mut before, mut last]: [Imperfect; 2],
        small: f64,
    ) -> Result<SolidState, Lost> {
        for _ in 0..ITERATIONS {
            if last.factor.abs() <= small {
                break;
            }
            let travelled = last.amplitude - before.amplitude;
            let share = last.factor / (before.factor - last.factor);
            let mut motion = last.motion.clone();
            motion.scale(share);
            let guess = self.moved(&last.state, &motion);
            let amplitude = last.amplitude + share * travelled;
            let next = self.at_amplitude(primary, weights, (guess, motion), amplitude, last.factor)?;
            (before, last) = (last, next);
        }
        Ok(last.state)
    }

    /// M v as forces on the points of their own and on the cap's middle, scaled so that their work on v is 1.
    fn weights(&self, mode: &SolidMode, held: [bool; 6]) -> Weights {
        let mut cap = Vector3::zeros();
        let mut points = vec![[0.0; 3]; mode.displacements.len()];
        let mut work = 0.0;
        let volumes = self.body.point_volumes();
        for (point, (u, volume)) in mode.displacements.iter().zip(volumes).enumerate() {
            match self.body.follows[point] {
                Follows::Own(_) => {
                    points[point] = u.map(|u| volume * u);
                    work += volume * Vector3::from(*u).norm_squared();
                }
                Follows::Cap => cap += volume * Vector3::from(*u),
                Follows::Base => {}
            }
        }
        (0..3).filter(|&direction| held[direction]).for_each(|direction| cap[direction] = 0.0);
        work += cap.dot(&mode.cap[0]);
        points.as_flattened_mut().iter_mut().for_each(|weight| *weight /= work);
        Weights { points, cap: cap / work }
    }

    /// The work that the weights do on the way from one state to another: the amplitude of the mode, m.
    fn amplitude(&self, weights: &Weights, from: &SolidState, to: &SolidState) -> f64 {
        let places = from.positions.as_flattened().iter().zip(to.positions.as_flattened());
        let on_points: f64 =
            weights.points.as_flattened().iter().zip(places).map(|(w, (a, b))| w * (b - a)).sum();
        on_points + weights.cap.dot(&(to.cap - from.cap))
    }

    /// Newton's method for the state and the factor of the imperfection at an amplitude.
    fn at_amplitude(
        &mut self,
        primary: &SolidState,
        weights: &Weights,
        (mut state, mut motion): (SolidState, Motion),
        amplitude: f64,
        mut factor: f64,
    ) -> Result<Imperfect, Lost> {
        let held = state.load.held;
        let dimension = self.unknowns();
        let mut error = f64::NAN;
        for _ in 0..ITERATIONS {
            self.imperfection = Some((factor, weights.points.clone(), weights.cap));
            error = self.assemble(&state, true)?;
            let gap = amplitude - self.amplitude(weights, primary, &state);
            if error < TOLERANCE && gap.abs() < TOLERANCE * amplitude.abs() {
                return Ok(Imperfect { state, amplitude, factor, motion });
            }
            self.factorise(held)?;
            let mut right: Vec<f64> = self.forces.condensed.iter().map(|force| -force).collect();
            for direction in (0..6).filter(|&direction| held[direction]) {
                right[self.body.cap_unknown + direction] = 0.0;
            }
            let mut forces = vec![0.0; dimension];
            self.body.add_point_forces(1.0, (&weights.points, weights.cap), &mut forces);
            for direction in (0..6).filter(|&direction| held[direction]) {
                forces[self.body.cap_unknown + direction] = 0.0;
            }
            right.extend(&forces);
            self.substitute(&mut right);
            let (step, slope) = right.split_at_mut(dimension);
            let along = |step: &[f64]| -> f64 { forces.iter().zip(step).map(|(w, x)| w * x).sum() };
            let change = (gap - along(step)) / along(slope);
            step.iter_mut().zip(slope).for_each(|(step, slope)| *step += change * *slope);
            let whole = self.motion(&state, step, true);
            let mut share = 1.0;
            loop {
                let mut part = whole.clone();
                part.scale(share);
                let trial = self.moved(&state, &part);
                self.imperfection = Some((factor + share * change, weights.points.clone(), weights.cap));
                let found = self.assemble(&trial, false);
                if found.is_ok_and(|found| found < 20.0 * error.max(1e-2)) {
                    (state, factor) = (trial, factor + share * change);
                    motion.add(1.0, &part);
                    break;
                }
                share *= 0.5;
                if share < 1e-3 {
                    return Err(found.err().unwrap_or(Lost(error)));
                }
            }
            if !factor.is_finite() || error > 1e6 {
                break;
            }
        }
        Err(Lost(error))
    }
}
