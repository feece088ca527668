//! A module of FREEs as geometrically exact rods between two rigid plates.

#[cfg(test)]
mod benchmarks;
#[cfg(test)]
mod bending_tests;
#[cfg(test)]
mod buckling_tests;
mod capped_section;
mod chain;
mod contact;
mod critical;
mod element;
mod equilibrium;
mod held;
#[cfg(test)]
mod held_tests;
mod idle_pressure;
mod mode;
mod module;
#[cfg(test)]
mod module_tests;
mod path;
mod section_table;
mod settings;
mod settle;
#[cfg(test)]
mod specimens;
mod system;
mod table_grid;
mod wall_table;

pub use capped_section::CappedSection;
pub use critical::Buckling;
pub use equilibrium::{Configuration, Equilibrium, RodError};
pub use held::HeldModule;
pub use idle_pressure::IdlePressure;
pub use mode::BucklingMode;
pub use module::{RodLaw, RodModule};
pub use section_table::SectionTable;
pub use settings::RodSettings;
pub use table_grid::TableGrid;
pub use wall_table::TableError;

#[cfg(test)]
use crate::TipLoad;
