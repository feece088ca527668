//! Reduced-order models of FREE actuators: splines fitted from maps, forward effects, the model file.

pub mod effect;
mod error_statistics;
mod module_model;
mod pose_model;
mod spline_axis;
#[cfg(test)]
mod synthetic;
mod tensor_spline;

pub use error_statistics::ErrorStatistics;
pub use module_model::{LIMIT_MARGIN, ModuleErrors, ModuleFitError, ModuleModel};
pub use pose_model::{OutOfDomain, PoseEvaluation, PoseModel};
pub use spline_axis::SplineAxis;
pub use tensor_spline::{MAX_AXES, OutsideGrid, PointBasis, SplineError, SplineGrid, TensorSpline};
