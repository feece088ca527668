use super::equilibrium::SolidShape;
use crate::{NoEquilibrium, SolidError};

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
    /// A search was stopped from outside.
    #[error("stopped before it was finished")]
    Stopped,
    /// Newton's method did not converge however short the step.
    #[error(transparent)]
    NoEquilibrium(#[from] NoEquilibrium<SolidShape>),
}
