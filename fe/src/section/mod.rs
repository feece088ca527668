//! The cross-section of a FREE on one fibre pitch: exact in length, a hundred unknowns.

mod banded;
mod element;
mod error;
mod kinematics;
mod mesh;
mod newton;
mod path;
mod problem;
mod solver;
mod system;
#[cfg(test)]
pub(crate) mod tests;

pub use error::{SectionError, Whereabouts};
pub use mesh::SectionMesh;
pub use solver::SectionSolver;
