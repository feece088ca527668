//! Models of FREE actuators for programs in C. The reference is `freeact.h`: units, frames, signs, lifetimes, codes.
//!
//! The calls check what they are given as far as that can be checked, and evaluate an image where it lies, by the crate `evaluator`:
//! without allocation, without locks, without a state of their own.
#![cfg_attr(not(feature = "std"), no_std)]

mod answer;
mod code;
mod exports;
mod facts;
mod guard;
mod model;
mod pointer;

pub use code::Code;
pub use exports::*;
use model::Model;
