//! Estimation of a rubber's constants from tests of the material: nominal stress over stretch in uniaxial, equibiaxial and
//! planar tension or compression; of mu from hardness; of a thread's EA from its pull.

mod comparison;
mod fibre;
mod fit;
mod hardness;
mod least_squares;
mod model;
mod stability;
mod test_data;
#[cfg(test)]
mod tests;

pub use comparison::held_out_rms;
pub use fibre::{FibreFit, fit_fibre};
pub use fit::{CalibrationError, Fit, Parameter, Weighting, fit};
pub use hardness::young_modulus_of_shore_a;
pub use model::RubberModel;
pub use stability::{Stability, StableRange, stable_range};
pub use test_data::{LoadingMode, TestPoint, nominal_stress};
