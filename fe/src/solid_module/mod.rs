//! A module of FREEs as solids between two rigid plates: each is factorised apart, and they are joined by the six coordinates of the
//! tip plate.

mod equations;
mod equilibrium;
mod error;
mod joined_free;
mod module;
mod newton;
mod path;
mod settings;
#[cfg(test)]
mod tests;

pub use equilibrium::{HeldPlate, SolidEquilibrium, SolidShape};
pub use error::SolidModuleError;
pub use module::SolidModule;
pub use settings::SolidModuleSettings;
