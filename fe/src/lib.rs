//! Finite elements of FREE actuators: materials, section, rod module, continuation.

mod run;
mod section_law;

pub use run::{Run, Shard};
pub use section_law::{SectionLaw, SectionResponse};
