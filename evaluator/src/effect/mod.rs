//! Forward effects: what a FREE or a module does beyond its base model, one physical effect a file.
//!
//! A recording is a chain of links: command -> \[supply\] -> pressure in the FREE -> \[sensing\] -> pressure read, and pressure in
//! the FREE -> \[mechanics\] -> pose -> \[reading\] -> pose read. Each effect sits on one link and is given by an equation, its
//! state and its parameters (name with unit, start, bounds). It steps at any step size, and its state stands in the caller's own
//! memory: numbers that are all nought in an actuator that has rested.
//!
//! Equations are written once, for any [`crate::Real`]; in [`crate::Dual`] they give their derivatives with respect to pressure and
//! parameters.

mod base_frame;
mod bending_scale;
mod bending_stiffness;
mod chain;
mod creep;
mod delay;
mod hysteresis;
mod kind;
mod marker_frame;
mod mismatch;
mod mullins;
mod parameter;
mod payload;
mod pressure_bias;
mod saturation;
mod stiffness;
mod supply_lag;
mod valve_backlash;
mod winding_angle;

pub use chain::{Chain, Effect, Effects, Loads, MAX_EFFECTS};
pub use kind::{EffectKind, Link, MAX_VALUES};
pub use parameter::Parameter;
