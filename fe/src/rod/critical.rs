use super::{
    equilibrium::{Equilibrium, RodError},
    mode::BucklingMode,
    module::RodModule,
};
use crate::first_crossing::{Crossing, Search, Step};

/// Where a module on its way becomes unstable.
#[derive(Clone, Debug)]
pub struct Buckling {
    /// The last equilibrium found stable.
    pub below: Equilibrium,
    /// The first found unstable; no pressure differs from those of `below` by more than the tolerance.
    pub above: Equilibrium,
    /// How it leaves the equilibrium there.
    pub mode: BucklingMode,
}

/// Pressure steps (Pa) in which stability is looked at on the way: two changes within one that cancel go unseen.
const STEP: f64 = 2.5e3;

impl RodModule {
    /// Where the module first becomes unstable as its pressures go in a straight line from those of a stable equilibrium to `goal` (Pa), to
    /// within `tolerance` (Pa) of every pressure; `None` where it stays stable. The inertia of the tangent tells, so that the place where a
    /// symmetric path crosses another is found though the path itself goes on.
    ///
    /// # Errors
    /// [`RodError`] where the path ends before it becomes unstable.
    pub fn first_buckling(
        &self,
        start: &Equilibrium,
        goal: &[f64],
        tolerance: f64,
    ) -> Result<Option<Buckling>, RodError> {
        let search = Search::between(&start.pressures, goal, STEP, tolerance);
        let go = |below: &Equilibrium, share: f64| {
            let way = start.pressures.iter().zip(goal);
            let pressures: Vec<f64> = way.map(|(from, to)| from + share * (to - from)).collect();
            self.solve_from(below, &pressures).map(Step::Reached)
        };
        let crossing = search.first_crossing(start, go, |found| !found.state.is_buckled())?;
        let Some(Crossing { below, above: Some(above), .. }) = crossing else { return Ok(None) };
        let mode = self.softest_mode(&above).ok_or_else(|| above.without_factors())?;
        Ok(Some(Buckling { below, above, mode }))
    }
}
