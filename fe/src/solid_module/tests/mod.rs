//! Tests of modules of solids: against one solid alone, differences, symmetries, the whole system at once.

mod buckling;
mod derivatives;
mod one_free;
mod symmetry;
mod whole_system;

use super::{SolidModule, SolidModuleError, SolidModuleSettings};
use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, Module, OgdenForm, PlacedFree, Tip, Tube, Winding,
};

/// Bore 4.76 mm, wall 0.8 mm, 30 mm long.
fn free(angle_deg: f64, handedness: Handedness, fibres: u32) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.15e-3, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 30e-3, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle_deg.to_radians(), handedness, fibres, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn module(frees: &[(Free, [f64; 2])], gravity: [f64; 3]) -> Module {
    Module {
        frees: frees.iter().map(|&(free, position)| PlacedFree { free, position }).collect(),
        tip: Tip { plate_mass: 5e-3, payload: 0.0, free_dof: [true; 6] },
        base: Base { gravity, free_mass: 1e-3 },
        spacers: 0,
    }
}

/// Two FREEs of different angle and hand side by side, gravity aslant.
pub(super) fn unlike_pair() -> Module {
    let right = (free(40.0, Handedness::Right, 6), [7.5e-3, 1e-3]);
    let left = (free(60.0, Handedness::Left, 6), [-7.5e-3, 0.0]);
    module(&[right, left], [0.6, 0.0, 0.8])
}

fn settings(elements: [u32; 3]) -> SolidModuleSettings {
    SolidModuleSettings { elements: Some(elements), ..SolidModuleSettings::default() }
}

pub(super) fn solids(module: &Module, elements: [u32; 3]) -> SolidModule {
    SolidModule::new(module, settings(elements)).unwrap()
}

#[test]
fn what_makes_no_module_is_refused_in_words() {
    let mut wrong = unlike_pair();
    wrong.spacers = 9;
    let message = |module: &Module| SolidModule::new(module, settings([1, 12, 8])).err().unwrap().to_string();
    assert!(message(&wrong).contains("set spacers = 0"));
    wrong.spacers = 0;
    wrong.frees[1].free.winding = wrong.frees[1].free.winding.with_angle_from_hoop(0.0);
    assert!(message(&wrong).contains("FREE 2") && message(&wrong).contains("rings"));
    wrong.frees.clear();
    assert!(message(&wrong).contains("no FREE"));
    let mut pair = solids(&unlike_pair(), [1, 12, 8]);
    for pressures in [&[1e4][..], &[1e4, f64::NAN]] {
        let error = pair.solve(pressures).unwrap_err();
        assert!(matches!(error, SolidModuleError::Count { given: 1, needed: 2 }), "{error}");
    }
}
