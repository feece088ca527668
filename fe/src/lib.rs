//! Finite elements of FREE actuators: materials, section, rod module, continuation.

mod bending_law;
mod bending_sweep;
mod bending_table;
mod blocked;
mod cap_effect;
mod cap_sweep;
mod capped_map;
mod closed_form;
mod contact;
mod end_effect;
mod first_crossing;
mod free_map;
mod free_sweep;
mod jet;
pub mod material;
mod module_fill;
mod module_laws;
mod module_line;
mod module_map;
mod module_solver;
mod module_sweep_error;
mod no_equilibrium;
mod numerics;
mod pressure_axes;
mod pressure_unit;
mod rigid_motion;
mod rod;
mod rod_stiffness;
mod run;
mod section;
mod section_law;
mod smeared_threads;
mod solid;
mod solid_map;
mod solid_module;
mod sparse;
mod tip_plate;
pub mod vtk;

pub use bending_law::{BendingLaw, BendingResponse, ConstantBending};
pub use bending_sweep::BendingSweep;
pub use bending_table::{BendingPlane, BendingSample, BendingTable};
pub use blocked::{BlockedForces, BlockedSweep, HeldState};
pub use cap_effect::{CapEffect, CapSample, CapTable};
pub use cap_sweep::CapSweep;
pub use capped_map::{CappedSweep, CapsReport};
pub use closed_form::{ClosedFormError, ThickTube};
pub use contact::Closest;
pub use end_effect::{EndChange, EndEffect};
pub use free_map::FreeSweep;
pub use free_sweep::{FailedPath, FreeSweepError, FreeSweepReport, PathError};
pub use module_line::ModuleLine;
pub use module_map::{FailedState, ModuleSweep, ModuleSweepReport};
pub use module_solver::{ModuleError, ModuleSolver};
pub use module_sweep_error::ModuleSweepError;
pub use no_equilibrium::NoEquilibrium;
pub use numerics::NUMERICS;
pub use pressure_unit::PressureUnit;
pub use rod::{
    Buckling, BucklingMode, CappedSection, Configuration, Equilibrium, HeldModule, IdlePressure, RodError,
    RodLaw, RodModule, RodSettings, SectionTable, TableError, TableGrid,
};
pub use rod_stiffness::{RodCompliance, StraightRod};
pub use run::{Run, Shard};
pub use section::{
    BlockedSection, PathRequest, SectionError, SectionMesh, SectionSolver, SolvedSection, WallResponse,
    Whereabouts,
};
pub use section_law::{SectionLaw, SectionResponse};
pub use solid::{
    Branches, Bulge, Coat, CriticalKind, CriticalPoint, Deformation, FibreModel, Plane, PressureLimit,
    SolidCost, SolidError, SolidLoad, SolidMesh, SolidMode, SolidPath, SolidSolver, SolidState, Specimen,
    Stability, StrainAt, StrainFacet, Strains, TipCompliance,
};
pub(crate) use solid::{CapForces, CapResponse, CarriedMotion, HELD, Lost};
pub use solid_map::SolidSweep;
pub use solid_module::{
    HeldPlate, SolidBuckling, SolidEquilibrium, SolidModule, SolidModuleError, SolidModuleMode,
    SolidModuleSettings, SolidShape,
};
pub use tip_plate::TipLoad;
