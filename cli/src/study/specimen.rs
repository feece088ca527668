//! The paper's tube and fibres.

use actuator::{
    Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding,
    units::{DEG, MM, MPA},
};
use fe::Specimen;

/// Shear modulus of the paper's latex, Pa.
pub const SHEAR_MODULUS: f64 = 0.393 * MPA;
/// Tensile stiffness EA of its fibres, N.
pub const FIBRE_STIFFNESS: f64 = 644.0;
/// Ogden's exponent that it chose.
pub const ALPHA: f64 = 1.2;

/// Its tube.
pub const TUBE: Tube = Tube { length: 130.0 * MM, inner_radius: 4.76 * MM, wall: 0.8 * MM };

/// A first-order Ogden rubber of the paper's modulus.
pub fn ogden(alpha: f64, form: OgdenForm) -> Elastomer {
    Elastomer::Ogden { shear_modulus: SHEAR_MODULUS, alpha, form }
}

/// What the paper's latex is here: alpha 1.2, mu the initial shear modulus.
pub fn latex() -> Elastomer {
    ogden(ALPHA, OgdenForm::InitialModulus)
}

/// The paper's FREE at a winding angle from the hoop, with six truss fibres of a diameter (m; zero: lines).
pub fn free(angle_deg: f64, diameter: f64) -> Free {
    let fibre = Fibre { axial_stiffness: FIBRE_STIFFNESS, diameter, law: FibreLaw::Linear };
    Free {
        tube: TUBE,
        winding: Winding::from_hoop(angle_deg * DEG, Handedness::Right, 6, fibre),
        elastomer: latex(),
    }
}

/// The paper's tube without fibres.
pub fn bare(elastomer: Elastomer) -> Specimen {
    Specimen { elastomer, windings: vec![], ..Specimen::from(&free(20.0, 0.0)) }
}
