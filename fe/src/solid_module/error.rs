use super::equilibrium::SolidShape;
use crate::{SolidError, tip_plate::in_kpa};

/// Why a module of solids has no equilibrium to show.
#[derive(Clone, Debug, thiserror::Error)]
pub enum SolidModuleError {
    /// The module has spacers.
    #[error(
        "the module has {0} spacers, but solids cannot be tied together on their way: set spacers = 0, or take the rods"
    )]
    Spacers(u32),
    /// A module needs a FREE.
    #[error("the module has no FREE")]
    Empty,
    /// A FREE makes no solid.
    #[error("FREE {}: {source}", free + 1)]
    Free {
        /// Index of the FREE.
        free: usize,
        /// Why.
        source: SolidError,
    },
    /// Another number of pressures than of FREEs, or a pressure that is not finite.
    #[error("{given} finite pressures for {needed} FREEs; give one for each FREE")]
    Count {
        /// How many were given.
        given: usize,
        /// How many FREEs there are.
        needed: usize,
    },
    /// Newton's method did not converge however short the step.
    #[error(
        "no equilibrium found on the way to {} kPa: the path from rest ends at {} kPa (residual {residual:.1e}); a limit pressure or a sharp buckling is near",
        in_kpa(goal),
        in_kpa(reached)
    )]
    NoEquilibrium {
        /// Pressures asked for, Pa.
        goal: Vec<f64>,
        /// Pressures of the last equilibrium on the way, Pa.
        reached: Vec<f64>,
        /// Relative residual of the failed step.
        residual: f64,
        /// The last equilibrium on the way.
        last: Box<SolidShape>,
    },
}
