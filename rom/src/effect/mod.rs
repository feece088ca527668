//! Effects of an actuator: what a FREE or a module does beyond its base model, as a list that a model and its file carry.
//!
//! Their equations, one a file, are in [`evaluator::effect`]; here are the lists that own their numbers.

mod chain;
mod listed;
mod near;

pub use chain::{Chain, ChainState, Loads, hanging_mass};
pub use evaluator::effect::{EffectKind, Link, Parameter};
pub use listed::{Effect, EffectError};
pub use near::{evaluate_near, overshoot};
