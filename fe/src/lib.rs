//! Finite elements of FREE actuators: materials, section, rod module, continuation.

mod closed_form;
mod jet;
pub mod material;
mod run;
mod section;
mod section_law;

pub use closed_form::{ClosedFormError, ThickTube};
pub use run::{Run, Shard};
pub use section::{SectionError, SectionMesh, SectionSolver, Whereabouts};
pub use section_law::{SectionLaw, SectionResponse};
