//! Closing the loop: what a base model lacks, found from recordings.
//!
//! A recording is a chain of links, command -> \[supply\] -> pressure -> \[sensing\] -> pressure read and pressure -> \[mechanics\] -> pose ->
//! \[reading\] -> pose read. The base model's own numbers are calibrated within declared tolerances; each candidate effect is fitted jointly with them
//! and judged on recordings that took no part in the fit, block by block; the one that earns most is added, until none earns its place. See
//! [`identify_module`] and [`identify_free`]. Nothing here knows how the base model was made.

mod candidate;
mod discrepancy;
mod error;
mod errors_seen;
mod free;
mod free_model;
mod intervals;
mod mechanics;
mod module;
mod objective;
mod report;
mod rows;
mod score;
mod setup;
mod structure;
mod study;
mod track;
mod verdict;
mod watch;

pub use candidate::Tolerances;
pub use error::IdentifyError;
pub use free::identify_free;
pub use mechanics::{FreeMechanics, FreeResponse, Mechanics, ModuleMechanics, OUTPUTS, Response, Seen};
pub use module::{Options, identify_module};
pub use report::{Outcome, Series};
pub use verdict::{Errors, Estimated, Finding, FoundEffect, Residual, Stages, Verdict};
pub use watch::Watch;
