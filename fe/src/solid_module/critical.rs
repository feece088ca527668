use super::{SolidModuleError, equilibrium::SolidEquilibrium, mode::SolidModuleMode, module::SolidModule};
use crate::first_crossing::{Crossing, Search, Step};

/// Where a module of solids on its way becomes unstable.
#[derive(Clone, Debug)]
pub struct SolidBuckling {
    /// The last equilibrium found stable.
    pub below: SolidEquilibrium,
    /// The first found unstable, no pressure farther from those of `below` than the tolerance; `None` where the path ends at `below`: its pressures
    /// cannot be raised further, and no other equilibrium lies near.
    pub above: Option<SolidEquilibrium>,
    /// How it leaves: the mode next to singular there.
    pub mode: SolidModuleMode,
}

/// Pressure steps (Pa) in which stability is looked at on the way.
const STEP: f64 = 2.5e3;
/// Modes that are sought, so that of several walls about to give way the softest is found.
const MODES: usize = 2;

impl SolidModule {
    /// Where the module first becomes unstable as its pressures go in a straight line from those of a stable equilibrium to `goal` (Pa), to
    /// within `tolerance` (Pa) of every pressure; `None` where it stays stable. `told` is shown every equilibrium that is found on the way, in the
    /// order of finding, and stops the search with `false`.
    ///
    /// # Errors
    /// [`SolidModuleError::Stopped`] where `told` says so; those of [`SolidModule::solve_from`] but the end of the path.
    pub fn first_buckling(
        &mut self,
        start: &SolidEquilibrium,
        goal: &[f64],
        tolerance: f64,
        told: &mut dyn FnMut(&SolidEquilibrium) -> bool,
    ) -> Result<Option<SolidBuckling>, SolidModuleError> {
        let from = start.shape.pressures().to_vec();
        let goal = self.checked(goal)?;
        let search = Search::between(&from, &goal, STEP, tolerance);
        let go = |below: &SolidEquilibrium, share: f64| {
            let way = from.iter().zip(&goal);
            let pressures: Vec<f64> = way.map(|(from, to)| from + share * (to - from)).collect();
            let step = match self.solve_from(&below.shape, &pressures) {
                Ok(found) => Step::Reached(found),
                Err(SolidModuleError::NoEquilibrium(end)) => {
                    // How far it came, by the pressure that changes most.
                    let made = end.reached.iter().zip(&from).map(|(p, from)| (p - from).abs());
                    let share = made.fold(0.0, f64::max) / search.longest;
                    Step::Ended(self.solve_from(&end.last, &end.reached)?, share)
                }
                Err(other) => return Err(other),
            };
            let (Step::Reached(found) | Step::Ended(found, _)) = &step;
            if told(found) { Ok(step) } else { Err(SolidModuleError::Stopped) }
        };
        let crossing = search.first_crossing(start, go, |found| !found.state.is_buckled())?;
        let Some(Crossing { below, above }) = crossing else { return Ok(None) };
        let modes = self.softest_modes(&above.as_ref().unwrap_or(&below).shape, MODES)?;
        // The one that has just become unstable, else the softest.
        let lowest = |a: &SolidModuleMode, b: &SolidModuleMode| a.value.total_cmp(&b.value);
        let mode = modes.into_iter().min_by(lowest).ok_or(SolidModuleError::Empty)?;
        Ok(Some(SolidBuckling { below, above, mode }))
    }
}
