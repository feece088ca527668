//! One FREE as a three-dimensional body: 27-node hexahedra with a discontinuous linear pressure, fibres on the outer surface,
//! rigid caps, and the pressure in the enclosed volume.
#![expect(dead_code, reason = "the solver that uses the mesh is being written")]

mod error;
mod fibre;
mod mesh;
mod specimen;

pub use error::SolidError;
pub use mesh::SolidMesh;
pub use specimen::{Coat, Specimen};
