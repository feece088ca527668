//! FREEs, modules and plain laws for the tests of rods.

use super::*;
use crate::{ConstantBending, SectionLaw, SectionResponse, ThickTube};
use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, Module, OgdenForm, PlacedFree, Tip, Tube, Winding,
};
use std::sync::Arc;

/// Phi = EA (lambda - 1)^2/2 + GJ tau^2/2 - p (area (lambda - 1) + arm tau), in the units of the test.
pub(super) struct Linear {
    pub axial: f64,
    pub torsion: f64,
    pub area: f64,
    pub arm: f64,
}

impl SectionLaw for Linear {
    fn respond(&self, p: f64, stretch: f64, twist: f64) -> SectionResponse {
        let strain = stretch - 1.0;
        SectionResponse {
            energy: 0.5 * self.axial * strain * strain + 0.5 * self.torsion * twist * twist
                - p * (self.area * strain + self.arm * twist),
            force: self.axial * strain - p * self.area,
            torque: self.torsion * twist - p * self.arm,
            stiffness: [[self.axial, 0.0], [0.0, self.torsion]],
        }
    }
}

pub(super) const MU: f64 = 0.393e6;

pub(super) fn free(angle_deg: f64, handedness: Handedness) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::TensionOnly };
    Free {
        tube: Tube { length: 0.175, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle_deg.to_radians(), handedness, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: MU, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

pub(super) fn at(free: Free, x: f64, y: f64) -> PlacedFree {
    PlacedFree { free, position: [x, y] }
}

pub(super) fn module(frees: Vec<PlacedFree>) -> Module {
    let tip = Tip { plate_mass: 0.0, payload: 0.0, free_dof: [true; 6] };
    Module { frees, tip, base: Base { gravity: [0.0; 3], free_mass: 0.0 }, spacers: 0 }
}

/// Four 30 degree FREEs on the corners of a square of 15 mm, hands in turn.
pub(super) fn left_right(gravity: [f64; 3]) -> Module {
    use Handedness::{Left, Right};
    let s = 7.5e-3;
    let corners = [(s, s, Right), (-s, s, Left), (-s, -s, Right), (s, -s, Left)];
    let mut module = module(corners.map(|(x, y, hand)| at(free(30.0, hand), x, y)).to_vec());
    module.base = Base { gravity, free_mass: 4.3e-3 };
    module.tip.plate_mass = 5e-3;
    module
}

/// With the bending of the bare tubes.
pub(super) fn with_sections(
    module: &Module,
    sections: Vec<Arc<dyn SectionLaw>>,
    settings: RodSettings,
) -> RodModule {
    let law = |(section, placed): (Arc<dyn SectionLaw>, &PlacedFree)| RodLaw {
        section,
        bending: Arc::new(ConstantBending::of_bare_tube(&placed.free)),
    };
    RodModule::new(module, sections.into_iter().zip(&module.frees).map(law).collect(), settings).unwrap()
}

pub(super) fn analytic(module: &Module, settings: RodSettings) -> RodModule {
    let law = |placed: &PlacedFree| Arc::new(ThickTube::new(&placed.free)) as Arc<dyn SectionLaw>;
    with_sections(module, module.frees.iter().map(law).collect(), settings)
}

pub(super) fn linear(module: &Module, law: Linear, settings: RodSettings) -> RodModule {
    let law: Arc<dyn SectionLaw> = Arc::new(law);
    with_sections(module, vec![law; module.frees.len()], settings)
}

pub(super) fn bending(free: &Free) -> f64 {
    3.0 * MU * free.tube.second_moment()
}

/// A law stiff enough along the axis not to matter beside bending.
pub(super) const STIFF: Linear = Linear { axial: 1e3, torsion: 1e-3, area: 0.0, arm: 0.0 };
