use super::{equilibrium::RodError, module::RodModule};

/// What the FREEs that are not to act must be given so that a module does not buckle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IdlePressure {
    /// It is stable without.
    NotNeeded,
    /// Stable with this pressure (Pa) in them, and unstable with the tolerance less.
    Least(f64),
    /// Unstable with every pressure tried.
    NeverEnough,
}

/// Pressures tried on the way up, before the first that suffices is made precise: less than one in a case that is stable in a band of
/// pressures narrower than an eighth may be missed.
const TRIALS: usize = 8;

impl RodModule {
    /// Whether the module is stable with the pressures of `case` (Pa) and `idle` (Pa) in the FREEs that have none there.
    ///
    /// # Errors
    /// [`RodError`] where there is no equilibrium on the way from rest.
    pub fn is_stable_with(&self, case: &[f64], idle: f64) -> Result<bool, RodError> {
        let pressures: Vec<f64> =
            case.iter().map(|pressure| if *pressure == 0.0 { idle } else { *pressure }).collect();
        Ok(!self.solve(&pressures)?.state.is_buckled())
    }

    /// The least pressure (to within `tolerance`, Pa; at most `most`, Pa) in the FREEs to which `case` gives none with which the module is
    /// stable under it. From there to the next pressure tried it stays so; beyond that is not looked at.
    ///
    /// # Errors
    /// [`RodError`] where there is no equilibrium on the way from rest.
    pub fn least_idle_pressure(
        &self,
        case: &[f64],
        most: f64,
        tolerance: f64,
    ) -> Result<IdlePressure, RodError> {
        if self.is_stable_with(case, 0.0)? {
            return Ok(IdlePressure::NotNeeded);
        }
        let mut low = 0.0;
        for trial in 1..=TRIALS {
            let mut high = most * trial as f64 / TRIALS as f64;
            if !self.is_stable_with(case, high)? {
                low = high;
                continue;
            }
            while high - low > tolerance {
                let middle = 0.5 * (low + high);
                if self.is_stable_with(case, middle)? { high = middle } else { low = middle }
            }
            return Ok(IdlePressure::Least(high));
        }
        Ok(IdlePressure::NeverEnough)
    }
}
