use crate::{FailedState, ModuleError, ModuleLine, ModuleSolver, ModuleSweepError, ModuleSweepReport, Run};
use actuator::{ModuleMap, ModuleState};
use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicUsize, Ordering},
};

/// Told of each row, or check, all of whose states were found: their pressures (Pa), and the states.
pub(crate) type FinishedRow<'a> = dyn FnMut(&[Vec<f64>], &[ModuleState]) + Send + 'a;

/// A map that is being filled, and what is told of it.
pub(crate) struct Filling<'a, 'b> {
    pub map: &'a mut ModuleMap,
    pub report: &'a mut ModuleSweepReport,
    /// States of this part that are there, and all of them.
    pub done: usize,
    pub all: usize,
    pub finished: &'a mut FinishedRow<'b>,
}

impl Filling<'_, '_> {
    /// Computes lines on as many threads as there are jobs, each with a solver of its own: the first state of a line is followed from rest,
    /// the others one from the other.
    pub fn fill<S: ModuleSolver>(
        self,
        lines: &[ModuleLine],
        make: &(dyn Fn() -> Result<S, ModuleError> + Sync),
        run: &Run<'_>,
    ) -> Result<(), ModuleSweepError> {
        let rest = make()?.rest()?;
        let next = AtomicUsize::new(0);
        let all = self.all;
        let filling = Mutex::new(self);
        std::thread::scope(|scope| {
            for _ in 0..run.jobs.clamp(1, lines.len().max(1)) {
                scope.spawn(|| {
                    // What made the first one makes the others.
                    let Ok(mut solver) = make() else { return };
                    while !run.is_stopped() {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        let Some(line) = lines.get(index) else { break };
                        let mut last = rest.clone();
                        let follow = |pressures: &Vec<f64>| {
                            last = solver.solve_from(&last, pressures)?;
                            solver.map_state(&last)
                        };
                        let found: Vec<Result<ModuleState, ModuleError>> =
                            line.pressures.iter().map(follow).collect();
                        let mut filling = filling.lock().unwrap_or_else(PoisonError::into_inner);
                        filling.put(line, found);
                        (run.progress)(filling.done, all);
                    }
                });
            }
        });
        Ok(())
    }

    fn put(&mut self, line: &ModuleLine, found: Vec<Result<ModuleState, ModuleError>>) {
        if let Ok(states) = found.iter().map(Result::as_ref).collect::<Result<Vec<_>, _>>() {
            (self.finished)(&line.pressures, &states.into_iter().cloned().collect::<Vec<_>>());
        }
        for (place, state) in found.into_iter().enumerate() {
            match state {
                Ok(state) => {
                    self.report.computed += 1;
                    self.report.buckled += usize::from(state.negative_pivots > 0);
                    line.put(place, state, self.map);
                }
                Err(error) => {
                    let pressures = line.pressures[place].clone();
                    self.report.failed.push(FailedState { pressures, error });
                }
            }
        }
        self.report.rows_left -= 1;
        self.done += line.pressures.len();
    }
}
