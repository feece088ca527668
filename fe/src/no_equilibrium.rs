use crate::tip_plate::in_kpa;

/// A path of equilibria that ends before the pressures asked for: Newton's method did not converge however short the step. `S` is the shape of a
/// module, [`crate::Configuration`] or [`crate::SolidShape`].
#[derive(Clone, Debug, thiserror::Error)]
#[error(
    "no equilibrium found on the way to {} kPa: the path from rest ends at {} kPa (residual {residual:.1e}); a limit pressure or a sharp buckling is near",
    in_kpa(goal),
    in_kpa(reached)
)]
pub struct NoEquilibrium<S> {
    /// Pressures asked for, Pa.
    pub goal: Vec<f64>,
    /// Pressures of the last equilibrium on the way, Pa.
    pub reached: Vec<f64>,
    /// Relative residual of the failed step, the least that was met.
    pub residual: f64,
    /// Shape of the last equilibrium on the way.
    pub last: Box<S>,
}

impl<S> NoEquilibrium<S> {
    /// Of a module that stands at the pressures (Pa) asked for already, and yet has no equilibrium, or no derivatives, to show.
    pub fn there(pressures: &[f64], residual: f64, last: S) -> Self {
        NoEquilibrium {
            goal: pressures.to_vec(),
            reached: pressures.to_vec(),
            residual,
            last: Box::new(last),
        }
    }
}
