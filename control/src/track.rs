use crate::{Bounds, Preference, Solution, SolveInput, Solver, Status, Target, Tolerance, Trajectory};
use rom::PoseModel;
use std::{
    ops::ControlFlow,
    time::{Duration, Instant},
};

/// One solve of a trajectory: what a recording keeps of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Time on the waypoints' clock, s.
    pub time: f64,
    /// What was asked.
    pub input: SolveInput,
    /// What came out.
    pub solution: Solution,
    /// Pressures to send, Pa: the solution's, or the last ones where it was refused.
    pub command: Vec<f64>,
    /// Time the solve took; the only number that differs from run to run.
    pub solve_time: Duration,
}

/// Why there is nothing to track with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// The first target was refused, so that there are no pressures to send.
    #[error("the first target was refused: {reason}")]
    FirstRefused {
        /// The solver's reason.
        reason: String,
    },
    /// The rate limit is no rate.
    #[error("the pressure rate limit is {rate} Pa/s; give a positive number")]
    Rate {
        /// The limit, Pa/s.
        rate: f64,
    },
}

/// Solves target after target, each from the last answer and within a rate limit of it.
///
/// The first target is sought over the whole workspace when there are no pressures to start from; then each answer is sought
/// within one step of the last, and where none of these reaches the target but others do, the step goes towards those: a
/// straight line of targets may lead from one branch of solutions to another. Where the rate limit or a bound keeps the tip from its target, the tick says so
/// (`p1_rate_up`, `p2_max` in its active bounds) and the next goes on from there.
pub struct Tracker<'m, M: PoseModel + ?Sized> {
    solver: Solver<'m, M>,
    bounds: Bounds,
    preference: Preference,
    tolerance: Tolerance,
    pressure_rate: f64,
    last: Option<Vec<f64>>,
}

impl<'m, M: PoseModel + ?Sized> Tracker<'m, M> {
    /// A tracker with the greatest `pressure_rate` (Pa/s), from the pressures `from` (Pa), or from wherever the first target
    /// wants them.
    pub fn new(
        model: &'m M,
        bounds: Bounds,
        preference: Preference,
        tolerance: Tolerance,
        pressure_rate: f64,
        from: Option<Vec<f64>>,
    ) -> Result<Self, TrackError> {
        if !(pressure_rate > 0.0 && pressure_rate.is_finite()) {
            return Err(TrackError::Rate { rate: pressure_rate });
        }
        Ok(Tracker { solver: Solver::new(model), bounds, preference, tolerance, pressure_rate, last: from })
    }

    /// The next solve's input, `time_step` (s) after the last.
    pub fn input(&self, target: Target, time_step: f64) -> SolveInput {
        let mut input = SolveInput::new(target, self.bounds.clone());
        input.tolerance = self.tolerance;
        input.preference = self.preference;
        input.from = self.last.clone();
        if self.last.is_some() {
            input.step_limit = Some(self.pressure_rate * time_step);
        } else if self.preference == Preference::LeastChange {
            // There is nothing yet to change from.
            input.preference = Preference::LeastPressure;
        }
        input
    }

    /// Solves for the target of `time` (s), `time_step` (s) after the last.
    pub fn tick(&mut self, time: f64, target: Target, time_step: f64) -> Result<Tick, TrackError> {
        let input = self.input(target, time_step);
        let start = Instant::now();
        let solution = self.solver.solve(&input);
        let solve_time = start.elapsed();
        let command = match (&solution.answer, &self.last) {
            (Some(answer), _) => answer.pressures.clone(),
            (None, Some(last)) => last.clone(),
            (None, None) => return Err(TrackError::FirstRefused { reason: solution.reason }),
        };
        debug_assert!(solution.status == Status::Refused || solution.answer.is_some());
        self.last = Some(command.clone());
        Ok(Tick { time, input, solution, command, solve_time })
    }
}

/// Follows a trajectory to its end, or until `each`, which gets every tick in order, breaks off. Returns the number of ticks.
pub fn track<M: PoseModel + ?Sized>(
    tracker: &mut Tracker<M>,
    trajectory: &Trajectory,
    mut each: impl FnMut(Tick) -> ControlFlow<()>,
) -> Result<usize, TrackError> {
    for index in 0..trajectory.len() {
        let time = trajectory.time(index);
        let tick = tracker.tick(time, trajectory.target(time), trajectory.time_step())?;
        if each(tick).is_break() {
            return Ok(index + 1);
        }
    }
    Ok(trajectory.len())
}
