use super::{SolidModuleError, equilibrium::SolidEquilibrium, mode::SolidModuleMode, module::SolidModule};
use crate::first_crossing::{Crossing, Search, Step};
use nalgebra::Vector6;

/// Where a module of solids on its way becomes unstable.
#[derive(Clone, Debug)]
pub struct SolidBuckling {
    /// The last equilibrium found stable.
    pub below: SolidEquilibrium,
    /// The first found unstable; `None` where the path is lost, stable to the last: it ends, or only states beside it are found.
    pub above: Option<SolidEquilibrium>,
    /// Pressures (Pa) by which the path is unstable or lost, none farther from those of `below` than the tolerance.
    pub by: Vec<f64>,
    /// How it leaves: the mode of the lowest eigenvalue at `above`.
    pub mode: Option<SolidModuleMode>,
}

/// Pressure steps (Pa) in which stability is looked at on the way.
const STEP: f64 = 2.5e3;
/// Modes that are sought: of walls that may give way in one place or another those of the next higher eigenvalues lie close.
const MODES: usize = 3;
/// Share of a step's change of the pose by which it may miss the mean of the slopes at its ends; what walls do that have given way within the step misses
/// it by more.
const MISFIT: f64 = 0.06;

impl SolidModule {
    /// Where the module first becomes unstable as its pressures go in a straight line from those of a stable equilibrium to `goal` (Pa), to
    /// within `tolerance` (Pa) of every pressure; `None` where it stays stable.
    ///
    /// Walls give way in a snap, and short of it Newton's method may find the state behind: that one may be stable, but the pose has jumped, which
    /// the slopes at both ends of a step tell. Such states are not taken. `told` is shown every equilibrium that is found, in the order of
    /// finding, and whether it is taken for one of the path; it stops the search with `false`.
    ///
    /// # Errors
    /// [`SolidModuleError::Stopped`] where `told` says so; those of [`SolidModule::solve_from`] but the end of the path.
    pub fn first_buckling(
        &mut self,
        start: &SolidEquilibrium,
        goal: &[f64],
        tolerance: f64,
        told: &mut dyn FnMut(&SolidEquilibrium, bool) -> bool,
    ) -> Result<Option<SolidBuckling>, SolidModuleError> {
        let from = start.shape.pressures().to_vec();
        let goal = self.checked(goal)?;
        let search = Search::between(&from, &goal, STEP, tolerance);
        let at = |share: f64| -> Vec<f64> {
            from.iter().zip(&goal).map(|(from, to)| from + share * (to - from)).collect()
        };
        let length = self.height;
        let go = |last: &SolidEquilibrium, share: f64| match self.solve_from(&last.shape, &at(share)) {
            Ok(found) => {
                let taken = misfit(last, &found, length) < MISFIT;
                match told(&found, taken) {
                    false => Err(SolidModuleError::Stopped),
                    true => Ok(if taken { Step::Reached(found) } else { Step::Lost }),
                }
            }
            Err(SolidModuleError::NoEquilibrium(_)) => Ok(Step::Lost),
            Err(other) => Err(other),
        };
        let crossing = search.first_crossing(start, go, |found| !found.state.is_buckled())?;
        let Some(Crossing { below, above, by }) = crossing else { return Ok(None) };
        let by = at(by);
        let mode = match &above {
            Some(above) => self.softest_modes(&above.shape, MODES)?.into_iter().next(),
            None => None,
        };
        Ok(Some(SolidBuckling { below, above, by, mode }))
    }
}

/// By how much the change of the pose between two equilibria misses the mean of what the slopes at both make of it (trapezoid, of third order
/// on one path), as a share of the change. Shifts count as turns at the module's length (m).
fn misfit(from: &SolidEquilibrium, to: &SolidEquilibrium, length: f64) -> f64 {
    let rises: Vec<f64> =
        from.shape.pressures().iter().zip(to.shape.pressures()).map(|(from, to)| to - from).collect();
    let sloped = |found: &SolidEquilibrium| -> Vector6<f64> {
        let each = found.pressure_jacobian.iter().zip(&rises);
        each.map(|(slope, rise)| Vector6::from(*slope) * *rise).sum()
    };
    let [before, after] = [from, to].map(|found| Vector6::from(found.state.chart.to_array()));
    let size = |change: Vector6<f64>| {
        (0..6).map(|k| if k < 3 { change[k] } else { change[k] / length }.powi(2)).sum::<f64>().sqrt()
    };
    size(after - before - (sloped(from) + sloped(to)) * 0.5) / size(after - before).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid_module::tests::{solids, unlike_pair};

    #[test]
    fn slopes_tell_a_pose_that_jumps_from_one_that_goes_its_way() {
        let mut pair = solids(&unlike_pair(), [1, 12, 8]);
        let length = pair.height;
        let start = pair.solve(&[1e4, 0.0]).unwrap();
        let [far, near] = [2e3, 1e3].map(|rise| pair.solve_from(&start.shape, &[1e4 + rise, 0.0]).unwrap());
        let [at_far, at_near] = [&far, &near].map(|found| misfit(&start, found, length));
        // The trapezoid errs by the cube of the step, the pose changes with the step itself.
        let ratio = at_far / at_near;
        assert!(at_far < 0.5 * MISFIT && (3.6..4.6).contains(&ratio), "{at_far} {at_near}");
        let mut jumped = far.clone();
        jumped.state.chart.twist *= 1.2;
        assert!(misfit(&start, &jumped, length) > MISFIT);
        let mut jumped = far;
        jumped.state.chart.position[0] += 0.15 * jumped.state.chart.twist * length;
        assert!(misfit(&start, &jumped, length) > MISFIT);
    }
}
