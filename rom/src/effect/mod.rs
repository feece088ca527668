//! Forward effects: what a FREE or a module does beyond its base model, one physical effect a file.
//!
//! A recording is a chain of links: command -> \[supply\] -> pressure in the FREE -> \[sensing\] -> pressure read, and pressure in
//! the FREE -> \[mechanics\] -> pose -> \[reading\] -> pose read. Each effect sits on one link and is given by an equation, its
//! state and its parameters (name with unit, start, bounds). A [`Chain`] is a list of effects; it steps at any step size, allocates
//! nothing while stepping and is what a corrected model carries beside its map.

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
mod near;
mod parameter;
mod payload;
mod pressure_bias;
mod saturation;
mod stiffness;
mod supply_lag;
mod valve_backlash;
mod winding_angle;

pub use chain::{Chain, ChainState, Loads};
pub use kind::{Effect, EffectError, EffectKind, Link};
pub use near::{evaluate_near, overshoot};
pub use parameter::Parameter;
