//! Reduced-order models of FREE actuators: splines fitted from maps, forward effects, the model file.

pub mod effect;
mod pose_model;

pub use pose_model::{OutOfDomain, PoseEvaluation, PoseModel};
