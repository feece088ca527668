use super::{
    equilibrium::{Equilibrium, RodError},
    mode::BucklingMode,
    module::RodModule,
};

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
        let at = |share: f64| -> Vec<f64> {
            start.pressures.iter().zip(goal).map(|(from, to)| from + share * (to - from)).collect()
        };
        let longest =
            start.pressures.iter().zip(goal).map(|(from, to)| (to - from).abs()).fold(0.0, f64::max);
        let steps = (longest / STEP).ceil().max(1.0) as usize;
        let (mut below, mut low) = (start.clone(), 0.0);
        let mut crossed = None;
        for step in 1..=steps {
            let share = step as f64 / steps as f64;
            let found = self.solve_from(&below, &at(share))?;
            if found.state.is_buckled() {
                crossed = Some((found, share));
                break;
            }
            (below, low) = (found, share);
        }
        let Some((mut above, mut high)) = crossed else { return Ok(None) };
        while (high - low) * longest > tolerance {
            let middle = 0.5 * (low + high);
            let found = self.solve_from(&below, &at(middle))?;
            if found.state.is_buckled() {
                (above, high) = (found, middle);
            } else {
                (below, low) = (found, middle);
            }
        }
        let mode = self.softest_mode(&above).ok_or_else(|| above.without_factors())?;
        Ok(Some(Buckling { below, above, mode }))
    }
}
