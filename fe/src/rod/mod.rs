//! A module of FREEs as geometrically exact rods between two rigid plates.

#[cfg(test)]
mod benchmarks;
#[cfg(test)]
mod bending_tests;
mod chain;
mod contact;
mod element;
mod equilibrium;
mod held;
#[cfg(test)]
mod held_tests;
mod module;
#[cfg(test)]
mod module_tests;
mod path;
mod settings;
#[cfg(test)]
mod specimens;
mod system;
mod table;

pub use equilibrium::{Configuration, Equilibrium, RodError};
pub use held::HeldModule;
pub use module::{RodLaw, RodModule};
pub use settings::RodSettings;
pub use table::{SectionTable, TableError, TableGrid};

#[cfg(test)]
use crate::TipLoad;
