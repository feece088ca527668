//! A module of FREEs as solids between two rigid plates: each is factorised apart, and they are joined by the six coordinates of the
//! tip plate.

mod critical;
mod equations;
mod equilibrium;
mod error;
mod joined_free;
mod mode;
mod module;
mod newton;
mod path;
mod settings;
#[cfg(test)]
mod tests;
mod vtu;

pub use critical::SolidBuckling;
pub use equilibrium::{HeldPlate, SolidEquilibrium, SolidShape};
pub use error::SolidModuleError;
pub use mode::SolidModuleMode;
pub use module::SolidModule;
pub use settings::SolidModuleSettings;
