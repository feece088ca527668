use super::{
    chain::{Chain, Member},
    element::ElementLaw,
    equilibrium::{Configuration, RodError},
    settings::RodSettings,
};
use crate::{
    BendingLaw, SectionLaw,
    rigid_motion::Frame,
    tip_plate::{GuidedPlate, Plate},
};
use actuator::{Module, PlacedFree, units::STANDARD_GRAVITY};
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;

/// What a FREE is as a rod: a law may be shared; left-handed FREEs mirror it.
#[derive(Clone)]
pub struct RodLaw {
    /// Stretch and twist under pressure.
    pub section: Arc<dyn SectionLaw>,
    /// Bending and shear.
    pub bending: Arc<dyn BendingLaw>,
}

/// A module of FREEs as geometrically exact rods with their laws, clamped to two rigid plates.
///
/// With spacers, all FREEs share the spacers' motion, one element of each between two spacers ([`Module::spacers`]).
///
/// Energy: of the elements, minus the work of the weights (plate, payload and FREEs along the module's gravity) and of the tip
/// load. Degrees of freedom of the plate that are not in `tip.free_dof` stay at rest: position in the base frame, `rx` and `ry`
/// the bend and `rz` the twist of the pose chart.
#[derive(Clone)]
pub struct RodModule {
    pub(super) module: Module,
    pub(super) laws: Vec<RodLaw>,
    pub(super) settings: RodSettings,
    pub(super) tip: GuidedPlate,
    /// Shear stiffness of the stiffest FREE, N, and its outer radius, m: what residuals are relative to.
    pub(super) reference: (f64, f64),
}

impl RodModule {
    /// A module with the laws of each FREE.
    ///
    /// # Errors
    /// [`RodError`] where a number of laws or a setting makes no sense.
    pub fn new(module: &Module, laws: Vec<RodLaw>, settings: RodSettings) -> Result<Self, RodError> {
        if laws.len() != module.frees.len() || laws.is_empty() {
            return Err(RodError::Count { what: "laws", given: laws.len(), needed: module.frees.len() });
        }
        if settings.elements == 0 {
            return Err(RodError::Setup { what: "elements", value: 0.0, remedy: "use at least one" });
        }
        let scale = settings.bending_stiffness_scale;
        if !(scale > 0.0 && scale.is_finite()) {
            let what = "factor on the bending stiffness";
            return Err(RodError::Setup { what, value: scale, remedy: "it must be positive" });
        }
        let reference = module.frees.iter().fold((0.0, 0.0), |(force, radius), placed| {
            let tube = placed.free.tube;
            let shear = placed.free.elastomer.initial_shear_modulus() * tube.wall_area();
            if shear > force { (shear, tube.outer_radius()) } else { (force, radius) }
        });
        let tip = GuidedPlate::new(module, &settings.tip_load);
        Ok(RodModule { module: module.clone(), laws, settings, tip, reference })
    }

    /// The laws of each FREE.
    pub fn laws(&self) -> Vec<RodLaw> {
        self.laws.clone()
    }

    /// The FREEs with a part of their weights and of what their lengths differ from the mean one: without, they stand straight under the plate
    /// and pull and push nothing.
    pub(super) fn chains(&self, part: f64) -> Vec<Chain<'_>> {
        let base = &self.module.base;
        let weight = Vector3::from(base.gravity) * (part * STANDARD_GRAVITY * base.free_mass);
        let (elements, mean) = (self.elements() as f64, self.module.length());
        let member = |free: usize, arm: Vector3<f64>| {
            let placed = &self.module.frees[free];
            let law = ElementLaw {
                section: self.laws[free].section.as_ref(),
                hand: placed.free.winding.handedness.sign(),
                bending: self.laws[free].bending.as_ref(),
                bending_scale: self.settings.bending_stiffness_scale,
                held_at: (self.module.spacers > 0).then_some(placed.position),
                length: (mean + part * (placed.free.tube.length - mean)) / elements,
                ends: 0.0,
            };
            Member { free, law, weight, arm, end_zone: 2.0 * placed.free.tube.outer_radius() }
        };
        let axis = |free: usize| {
            let [x, y] = self.module.frees[free].position;
            Vector3::new(x, y, 0.0)
        };
        let frees = 0..self.laws.len();
        if self.module.spacers > 0 {
            let members = frees.map(|free| member(free, axis(free))).collect();
            vec![Chain { members, offset: Vector3::zeros() }]
        } else {
            let alone = |free| Chain { members: vec![member(free, Vector3::zeros())], offset: axis(free) };
            frees.map(alone).collect()
        }
    }

    /// Elements along each FREE: one between two spacers, or as set.
    fn elements(&self) -> usize {
        match self.module.spacers {
            0 => self.settings.elements,
            spacers => spacers as usize + 1,
        }
    }

    /// Greatest difference of a FREE's length from the mean one, relative to it.
    pub(super) fn misfit(&self) -> f64 {
        let mean = self.module.length();
        let of = |free: &PlacedFree| (free.free.tube.length / mean - 1.0).abs();
        self.module.frees.iter().map(of).fold(0.0, f64::max)
    }

    /// The undeformed shape: straight FREEs under a plate at their mean length.
    pub fn straight(&self) -> Configuration {
        let (height, count) = (self.module.length(), self.elements());
        let inner = |chain: &Chain| {
            let node = |k: usize| chain.offset + Vector3::z() * (height * k as f64 / count as f64);
            (1..count).map(|k| Frame { rotation: UnitQuaternion::identity(), position: node(k) }).collect()
        };
        Configuration { plate: Plate::at_height(height), inner: self.chains(0.0).iter().map(inner).collect() }
    }
}
