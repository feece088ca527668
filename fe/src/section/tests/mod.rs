//! Tests of the section as a whole.

mod accuracy;
mod beyond;
mod blocked;
mod constants;
mod mesh_error;
mod path;
mod resolution;
mod response;

use super::{
    mesh::Grid,
    problem::{Problem, State, Step},
    system::System,
    *,
};
use crate::{SectionLaw, ThickTube};
use actuator::{
    Elastomer, EndLoad, Fibre, FibreLaw, Free, FreeState, Handedness, OgdenForm, OgdenTerm, OgdenTerms,
    PathEnd, Tube, Winding,
};

/// The tube of the reference numbers: mu = 0.393 MPa, Ogden 1.2, bore 4.76 mm, wall 0.8 mm, six linear fibres of 644 N.
pub(crate) fn free(winding_angle_deg: f64) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.3e-3, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 0.13, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(winding_angle_deg.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

const COARSE: SectionMesh = SectionMesh { radial: 2, under_fibre: 1, between_fibres: 2 };

fn with_width(free: Free, diameter_mm: f64) -> Free {
    let mut free = free;
    free.winding.fibre.diameter = 1e-3 * diameter_mm;
    free
}

/// Fibres so wide that they cover the tube: the smeared limit.
fn smeared(free: Free) -> Free {
    with_width(free, 10.0)
}

fn tension_only(free: Free) -> Free {
    let mut free = free;
    free.winding.fibre.law = FibreLaw::TensionOnly;
    free
}

fn bare(alpha: f64) -> Free {
    let mut free = free(45.0);
    free.winding.fibre.axial_stiffness = 0.0;
    free.elastomer = Elastomer::Ogden { shear_modulus: 0.393e6, alpha, form: OgdenForm::InitialModulus };
    free
}

fn solver(free: &Free, mesh: SectionMesh) -> SectionSolver {
    SectionSolver::new(free, mesh).unwrap()
}

/// (stretch, expansion, twist in deg/mm) at pressures in kPa.
fn states(free: &Free, mesh: SectionMesh, pressures_kpa: &[f64]) -> (Vec<[f64; 3]>, Option<f64>) {
    let pressures: Vec<f64> = pressures_kpa.iter().map(|p| 1e3 * p).collect();
    let path = solver(free, mesh).path(&pressures, 0).unwrap();
    let states = pressures
        .iter()
        .map(|pressure| {
            let state =
                path.states.iter().find(|state| (state.pressure - pressure).abs() < 1e-9 * pressure).unwrap();
            assert!(state.residual < 1e-8);
            [state.axial_stretch, state.expansion, 1e-3 * state.twist_per_length.to_degrees()]
        })
        .collect();
    (states, path.limit_pressure().map(|pressure| 1e-3 * pressure))
}
