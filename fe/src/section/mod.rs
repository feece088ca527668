//! The cross-section of a FREE on one fibre pitch: exact in length, a hundred unknowns.

mod banded;
mod blocked;
mod element;
mod error;
mod kinematics;
mod mesh;
mod mesh_error;
mod newton;
mod path;
mod path_request;
mod problem;
mod resolution;
mod solved;
mod solver;
mod station;
mod system;
#[cfg(test)]
pub(crate) mod tests;
mod wall;

pub use blocked::BlockedSection;
pub use error::{SectionError, Whereabouts};
pub use mesh::SectionMesh;
pub use path_request::PathRequest;
pub use solved::SolvedSection;
pub use solver::SectionSolver;
pub use wall::WallResponse;
