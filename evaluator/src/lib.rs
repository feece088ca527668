//! What a controller calls: models of FREE actuators, evaluated without allocation, operating system or unsafe code.
//!
//! A model is a map, held as tensor-product splines, plus a list of effects. Values, Jacobians and memory stand in the caller's
//! own variables, in single or double precision. [`Image`] reads a model from bytes in place, as they lie in a controller's
//! flash memory; the crate `rom` fits models and writes such images.
//!
//! SI and radians throughout; pressures are gauge.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod axis;
mod chart;
mod dual;
pub mod effect;
mod free_splines;
mod image;
mod module_splines;
mod multilinear;
mod real;
mod spline_grid;
mod tensor_spline;
mod tip_model;

pub use axis::{Axis, DEGREE};
pub use chart::{Pose, pose, pose_jacobian};
pub use dual::Dual;
pub use free_splines::{FreeEvaluation, FreeSplines, OutsideFree};
pub use image::{Content, FREE, HEADER, Image, ImageError, MAGIC, MODULE, VERSION};
pub use module_splines::{ModuleSplines, OutsideModule};
pub use multilinear::multilinear;
pub use real::Real;
pub use spline_grid::{MAX_AXES, OutsideGrid, PointBasis, SplineGrid};
pub use tensor_spline::TensorSpline;
pub use tip_model::{LoadParameter, MAX_PARAMETERS, TipEvaluation, TipModel};
