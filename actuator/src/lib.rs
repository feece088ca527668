//! Plain data of FREE (Fiber Reinforced Elastomeric Enclosure) actuators, with no solver in it.
//!
//! A latex tube ([`Tube`]) wound with cotton thread ([`Winding`]) makes a [`Free`]; several of them between two
//! rigid plates make a [`Module`]. A [`Description`] is read from TOML at the edge; inside, everything is SI and radians.
//! What the finite elements compute is kept in a [`FreeMap`] or a [`ModuleMap`], the only thing that the finite elements
//! and the reduced-order model share.
//!
//! # Conventions
//! * Frame: z along the tube from the base plate to the tip plate, right-handed.
//! * The **winding angle** is measured from the hoop direction: 0 = rings, pi/2 = along the tube.
//! * Handedness *right*: the fibre is a right-handed helix about +z, `Theta = k Z + eta` with `k = cot(angle)/B > 0`.
//! * Twist is positive counter-clockwise seen from the tip looking back to the base (a right-handed rotation about +z);
//!   a right-handed FREE of 30 degrees turns negative when inflated.
//! * Pressure is gauge, Pa.

pub mod artefact;
mod case;
mod description;
mod elastomer;
mod elastomer_file;
mod free;
mod free_map;
mod free_map_old;
mod free_path;
mod free_state;
mod grid;
mod loaded_free;
mod map_axis;
mod module;
mod module_map;
mod module_map_old;
mod module_symmetry;
mod point_store;
mod polygon;
mod pose;
mod section;
mod tube;
pub mod units;
mod winding;
mod wrench;
mod zonotope;

pub use case::Case;
pub use description::{Description, DescriptionError, Rig};
pub use elastomer::{
    ARRUDA_BOYCE, Elastomer, ElastomerError, OgdenForm, OgdenTerm, OgdenTerms, chain_stiffening,
};
pub use free::Free;
pub use free_map::{Fidelity, FreeMap};
pub use free_map_old::{FreeMapVersion1, FreeMapVersion2};
pub use free_path::{FreePath, PathEnd};
pub use free_state::{FreeState, MeshError, Middle, SectionConstants};
pub use grid::grid_places;
pub use loaded_free::{EndLoad, LoadedFree};
pub use map_axis::{FreeParameter, MapAxis, ParameterError};
pub use module::{Base, Limits, Module, PlacedFree, Tip};
pub use module_map::{MapParameter, ModuleCheck, ModuleMap, ModuleState, PAYLOAD_STEP, payload_curvature};
pub use module_map_old::ModuleMapVersion3;
pub use module_symmetry::ModuleSymmetry;
pub use point_store::{PointKey, PointStore, StoreError};
pub use polygon::ConvexPolygon;
pub use pose::{PoseChart, TipPose, wrap_angle};
pub use tube::Tube;
pub use winding::{Fibre, FibreLaw, Handedness, Winding};
pub use wrench::Wrench;
pub use zonotope::Zonotope;
