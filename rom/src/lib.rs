//! Reduced-order models of FREE actuators: splines fitted from maps, forward effects, the model file.

pub mod effect;
mod error_statistics;
mod free_errors;
mod free_fit;
mod free_model;
mod model;
mod module_model;
mod pose_model;
mod pressure_nodes;
mod spline_axis;
mod stored_model;
#[cfg(test)]
mod synthetic;
mod tensor_spline;

pub use error_statistics::ErrorStatistics;
pub use free_errors::{DeformationErrors, FreeErrors};
pub use free_fit::FreeFitError;
pub use free_model::{FreeEvaluation, FreeModel, OutsideFree};
pub use model::{InvalidModel, Model, ModelContent, ModelError, Provenance};
pub use module_model::{LIMIT_MARGIN, ModuleErrors, ModuleFitError, ModuleModel};
pub use pose_model::{OutOfDomain, PoseEvaluation, PoseModel};
pub use pressure_nodes::recommended_pressure_nodes;
pub use spline_axis::SplineAxis;
pub use tensor_spline::{MAX_AXES, OutsideGrid, PointBasis, SplineError, SplineGrid, TensorSpline};
