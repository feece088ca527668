//! One FREE as a three-dimensional body: 27-node hexahedra with a discontinuous linear pressure, fibres on the outer surface,
//! rigid caps, and the pressure in the enclosed volume.

mod assembly;
mod body;
mod branch;
mod critical;
mod deformation;
mod element;
mod enclosed_volume;
mod error;
mod face_pressure;
mod fibre;
mod free_path;
mod joined_cap;
mod mesh;
mod newton;
mod outer_surface;
mod path;
mod profile;
mod scatter;
mod shape;
mod specimen;
mod stability;
mod state;
mod strain_picture;
#[cfg(test)]
mod tests;
mod tip_compliance;
mod vtu;
mod wall;

pub use branch::Branches;
pub use critical::{CriticalKind, CriticalPoint, PressureLimit};
pub use deformation::Deformation;
pub use error::SolidError;
pub(crate) use joined_cap::{CapForces, CapResponse, CarriedMotion};
pub use mesh::SolidMesh;
pub(crate) use newton::Lost;
pub use newton::{SolidCost, SolidSolver};
pub use outer_surface::Bulge;
pub use path::Parameter as SolidPath;
pub use profile::Plane;
pub use specimen::{Coat, FibreModel, Specimen};
pub(crate) use stability::HELD;
pub use stability::{SolidMode, Stability};
pub use state::{SolidLoad, SolidState};
pub use strain_picture::StrainFacet;
pub use tip_compliance::TipCompliance;
pub use wall::{StrainAt, Strains};
