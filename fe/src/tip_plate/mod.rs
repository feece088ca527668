//! The rigid plate that FREEs carry, whatever they are modelled as: its coordinates, what acts on it, what is fixed to it.

mod arm;
mod coordinates;
mod guided;
mod pivots;

pub(crate) use arm::{at_arm, shifted, swing};
pub(crate) use coordinates::{Plate, PlateVariation};
pub(crate) use guided::GuidedPlate;
pub use guided::TipLoad;
pub(crate) use pivots::InvertedBlock;

/// Pressures (Pa) in words, kPa.
pub(crate) fn in_kpa(pressures: &[f64]) -> String {
    let words: Vec<String> = pressures.iter().map(|p| format!("{:.3}", p / 1e3)).collect();
    format!("({})", words.join(", "))
}
