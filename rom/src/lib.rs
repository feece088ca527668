//! Reduced-order models of FREE actuators: splines fitted from maps, forward effects, the model file.

pub mod effect;
mod error_bars;
mod error_statistics;
mod free_bars;
mod free_errors;
mod free_fit;
mod free_model;
mod image;
mod interpolation;
mod model;
mod module_errors;
mod module_fit;
mod module_model;
mod module_orbits;
mod pose_model;
mod pressure_nodes;
mod stable_region;
mod stored_model;
mod stored_model_old;
#[cfg(test)]
mod synthetic;

pub use error_bars::axis_misses;
pub use error_statistics::ErrorStatistics;
pub use evaluator::MAX_AXES;
pub use free_errors::{DeformationErrors, FreeBarCoverage, FreeErrors};
pub use free_fit::FreeFitError;
pub use free_model::{FreeEvaluation, FreeModel, OutsideFree};
pub use image::NoImage;
pub use interpolation::{SplineAxis, SplineError, SplineGrid, TensorSpline, interpolate};
pub use model::{InvalidModel, Model, ModelContent, ModelError, Provenance};
pub use module_errors::{BarCoverage, ModuleErrors};
pub use module_fit::ModuleFitError;
pub use module_model::{LIMIT_MARGIN, ModuleModel};
pub use pose_model::{OutOfDomain, PoseEvaluation, PoseModel};
pub use pressure_nodes::recommended_pressure_nodes;
