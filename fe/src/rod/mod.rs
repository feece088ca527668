//! A module of FREEs as geometrically exact rods between two rigid plates.

#[cfg(test)]
mod bending_tests;
mod chain;
mod element;
mod equilibrium;
mod module;
mod motion;
mod pivots;
mod plate;
mod table;
#[cfg(test)]
mod tests;

pub use equilibrium::{Configuration, Equilibrium, RodError};
pub use module::{RodLaw, RodModule, RodSettings, TipLoad};
pub(crate) use motion::{Frame, LogVariation};
pub use table::{SectionTable, TableError, TableGrid};
