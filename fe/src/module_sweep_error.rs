use crate::{ModuleError, RodError, SectionError, SolidError, SolidModuleError, TableError};

/// Why a sweep of a module cannot be begun.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ModuleSweepError {
    /// The axis of a FREE's pressure is empty, not rising from zero, or missing.
    #[error("pressures (kPa) of FREE {}: {problem}", free + 1)]
    Axis {
        /// Index of the FREE.
        free: usize,
        /// What is wrong and what is wanted.
        problem: String,
    },
    /// The map's nodes are not those of its axes.
    #[error("the map holds {found} states, but its axes have {expected} nodes: make it again")]
    Shape {
        /// Product of the axes' nodes.
        expected: usize,
        /// States.
        found: usize,
    },
    /// The section of a FREE cannot be solved.
    #[error("FREE {}: {source}", free + 1)]
    Section {
        /// Index of the FREE.
        free: usize,
        /// Why.
        source: SectionError,
    },
    /// The section law of a FREE cannot be tabulated.
    #[error("FREE {}: {source}", free + 1)]
    Table {
        /// Index of the FREE.
        free: usize,
        /// Why.
        source: TableError,
    },
    /// The bending law of a FREE cannot be computed.
    #[error("bending of FREE {}: {source}", free + 1)]
    Bending {
        /// Index of the FREE.
        free: usize,
        /// Why.
        source: SolidError,
    },
    /// What the caps do to a FREE cannot be computed.
    #[error("caps of FREE {}: {source}", free + 1)]
    Caps {
        /// Index of the FREE.
        free: usize,
        /// Why.
        source: SolidError,
    },
    /// The rods cannot be set up, or brought where they are held.
    #[error(transparent)]
    Rods(#[from] RodError),
    /// The solids cannot be set up.
    #[error(transparent)]
    Solids(#[from] SolidModuleError),
    /// The module finds no state of rest.
    #[error(transparent)]
    Module(#[from] ModuleError),
}
