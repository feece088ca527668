//! Tests of the solid: element, patches, derivatives, objectivity, orders of convergence, pressures, paths, stability, output.

mod convergence;
mod derivatives;
mod element;
mod long_path;
mod objectivity;
mod open_ends;
mod patch;
mod pressures;
mod problem;
mod stability;
mod tip_compliance;
mod vtu;

use super::Specimen;
use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};

/// A number in [-1, 1) that depends on nothing but `index`.
fn noise(index: usize) -> f64 {
    let mut state = index as u64 + 17;
    2.0 * crate::free_map::next_fraction(&mut state) - 1.0
}

fn winding(angle_deg: f64, handedness: Handedness, fibres: u32, diameter: f64) -> Winding {
    let fibre = Fibre { axial_stiffness: 644.0, diameter, law: FibreLaw::Linear };
    Winding::from_hoop(angle_deg.to_radians(), handedness, fibres, fibre)
}

/// Bore 4.76 mm, wall 0.8 mm.
fn specimen(length: f64, windings: &[Winding], bulk_ratio: f64) -> Specimen {
    let free = Free {
        tube: Tube { length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: winding(30.0, Handedness::Right, 0, 0.0),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    Specimen { windings: windings.to_vec(), bulk_ratio, ..Specimen::from(&free) }
}
