use super::{equilibrium::SolidShape, module::SolidModule};
use crate::{
    CapForces, CarriedMotion, Lost,
    tip_plate::{GuidedPlate, InvertedBlock, Plate, PlateVariation, swing},
};
use nalgebra::{Matrix6, Vector3, Vector6};

/// What acts on a module, and what its plate is held at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Loads {
    /// Gauge pressures, Pa.
    pub pressures: Vec<f64>,
    /// Part of weights and tip load that acts, and of the way on which FREEs of unequal lengths are put between the plates.
    pub part: f64,
    /// Mass on the plate beyond the module's own, kg.
    pub payload: f64,
    /// Coordinates of the plate that may move.
    pub free: [bool; 6],
    /// Values of those that may not.
    pub held: Vector6<f64>,
}

/// Sums over a module in a configuration.
pub(super) struct Sums {
    pub caps: Vec<CapForces>,
    pub variation: PlateVariation,
    /// Greatest relative residual.
    pub error: f64,
    pub energy: f64,
}

/// The tangent of a module, the insides of its FREEs eliminated.
pub(super) struct Tangent {
    /// Where it was taken, if in equilibrium: of a plate that is held, what goes on inside is not told by its coordinates.
    pub equilibrium: Option<(Plate, Loads)>,
    pub variation: PlateVariation,
    /// Second derivative of the energy in the plate's coordinates, none of them held.
    pub hessian: Matrix6<f64>,
    /// Its inverse, those that are held taken out.
    pub inverse: Matrix6<f64>,
    /// Negative eigenvalues of the whole.
    pub negative: u32,
}

impl Tangent {
    pub fn is_at(&self, shape: &SolidShape, loads: &Loads) -> bool {
        self.equilibrium.as_ref().is_some_and(|(plate, own)| *plate == shape.plate && own == loads)
    }
}

impl SolidModule {
    /// The plate with the guides of these loads.
    pub(super) fn guided(&self, loads: &Loads) -> GuidedPlate {
        GuidedPlate { free: loads.free, ..self.tip }
    }

    /// Generalised forces on the plate's coordinates.
    pub(super) fn plate_load(&self, loads: &Loads) -> Vector6<f64> {
        self.tip.acting(loads.part, loads.payload)
    }

    pub(super) fn assemble(
        &mut self,
        shape: &SolidShape,
        loads: &Loads,
        with_tangent: bool,
    ) -> Result<Sums, Lost> {
        let caps = self.each(|index, free| free.solver.cap_forces(&shape.frees[index], with_tangent));
        let caps: Vec<CapForces> = caps.into_iter().collect::<Result<_, _>>()?;
        let variation = shape.plate.vary();
        let load = self.plate_load(loads);
        let gradient =
            variation.first.transpose() * self.pull(loads, caps.iter().map(|cap| cap.residual)) - load;
        let scale = caps.iter().map(|cap| cap.scale).fold(0.0, f64::max);
        let radius = self.radius();
        let off = self.guided(loads).free_part(gradient);
        let squares: f64 = (0..6).map(|i| if i < 3 { off[i] } else { off[i] / radius }.powi(2)).sum();
        let inside = caps.iter().map(|cap| cap.error).fold(0.0, f64::max);
        let error = inside.max(squares.sqrt() / scale);
        let energy = caps.iter().map(|cap| cap.energy).sum::<f64>()
            - load.dot(&(shape.plate.0 - Plate::at_height(self.height).0));
        if error.is_finite() { Ok(Sums { caps, variation, error, energy }) } else { Err(Lost(error)) }
    }

    /// Sum over the caps of six forces each, on the plate in its own frame.
    fn pull(&self, loads: &Loads, on_caps: impl Iterator<Item = Vector6<f64>>) -> Vector6<f64> {
        self.frees.iter().zip(on_caps).map(|(free, force)| free.lever(loads.part).transpose() * force).sum()
    }

    /// Factorises at the configuration assembled last, with its tangent.
    pub(super) fn factorise(&mut self, shape: &SolidShape, loads: &Loads, sums: &Sums) -> Result<(), Lost> {
        self.factorise_with(shape, loads, sums, &Matrix6::zeros())
    }

    /// The same with `stiffener` added to the second derivative in the plate's coordinates.
    pub(super) fn factorise_with(
        &mut self,
        shape: &SolidShape,
        loads: &Loads,
        sums: &Sums,
        stiffener: &Matrix6<f64>,
    ) -> Result<(), Lost> {
        self.tangent = None;
        self.each(|_, free| free.solver.cap_response().map(|response| free.response = Some(response)))
            .into_iter()
            .collect::<Result<(), Lost>>()?;
        let pull = self.pull(loads, sums.caps.iter().map(|cap| cap.residual));
        let (mut stiffness, mut negative) = (Matrix6::zeros(), 0);
        for (free, cap) in self.frees.iter().zip(&sums.caps) {
            let Some(response) = &free.response else { continue };
            let force: Vector3<f64> = cap.residual.fixed_rows::<3>(0).into();
            let lever = free.lever(loads.part);
            stiffness += lever.transpose() * (response.stiffness + swing(&force)) * lever;
            negative += response.negative;
        }
        let variation = shape.plate.vary();
        let hessian = variation.hessian(&pull, &stiffness) + stiffener;
        let InvertedBlock { inverse, negative: more } =
            self.guided(loads).inverted(&hessian).ok_or(Lost(f64::INFINITY))?;
        let negative = negative + more;
        self.tangent = Some(Tangent { equilibrium: None, variation, hessian, inverse, negative });
        Ok(())
    }

    /// Newton's step from the configuration assembled last, by the tangent there is: of the plate's coordinates, and each FREE's motion.
    pub(super) fn step(
        &mut self,
        shape: &SolidShape,
        loads: &Loads,
        sums: &Sums,
    ) -> Result<(Vector6<f64>, Vec<CarriedMotion>), Lost> {
        let lost = || Lost(sums.error);
        let inverse = self.tangent.as_ref().ok_or_else(lost)?.inverse;
        let inner = self.each(|_, free| Some(free.solver.inner_step(free.response.as_ref()?)));
        let inner = inner.into_iter().collect::<Option<Vec<_>>>().ok_or_else(lost)?;
        let pull = self.pull(loads, inner.iter().map(|step| step.residual));
        let gradient = sums.variation.first.transpose() * pull - self.plate_load(loads);
        let plate = -(inverse * self.guided(loads).free_part(gradient));
        let motion = sums.variation.first * plate;
        let motions = self.each(|index, free| {
            let cap = free.lever(loads.part) * motion;
            Some(free.solver.newton_motion(&shape.frees[index], free.response.as_ref()?, &inner[index], &cap))
        });
        Ok((plate, motions.into_iter().collect::<Option<_>>().ok_or_else(lost)?))
    }

    /// The configuration after a part of a step, under loads.
    pub(super) fn moved(
        &mut self,
        shape: &SolidShape,
        (plate, motions): (&Vector6<f64>, &[CarriedMotion]),
        part: f64,
        loads: &Loads,
    ) -> SolidShape {
        let mut plate = Plate(shape.plate.0 + plate * part);
        for (index, free) in loads.free.into_iter().enumerate() {
            if !free {
                plate.0[index] = loads.held[index];
            }
        }
        let frame = plate.frame();
        let frees = self.each(|index, free| {
            let cap = free.cap(&frame, loads.part);
            let mut next = free.solver.carried(&shape.frees[index], &motions[index], part, &cap);
            next.load = free.load(loads.pressures[index], loads.part);
            next
        });
        SolidShape { plate, frees, pressures: loads.pressures.clone() }
    }

    /// First-order motion from an equilibrium, linearised last, to loads nearby.
    pub(super) fn slope(
        &mut self,
        shape: &SolidShape,
        from: &Loads,
        to: &Loads,
    ) -> Result<(Vector6<f64>, Vec<CarriedMotion>), Lost> {
        let tangent = self.tangent.as_ref().ok_or(Lost(f64::NAN))?;
        let rises: Vec<f64> = to.pressures.iter().zip(&from.pressures).map(|(to, from)| to - from).collect();
        let pressed = self.frees.iter().zip(&rises).map(|(free, rise)| {
            free.response.as_ref().map_or(Vector6::zeros(), |response| response.by_pressure * *rise)
        });
        let first = tangent.variation.first;
        let guided = self.guided(to);
        // Coordinates that are held move as they are told.
        let told = to.held - from.held;
        let told = told - guided.free_part(told);
        let force = first.transpose() * self.pull(from, pressed) + self.plate_load(to)
            - self.plate_load(from)
            - tangent.hessian * told;
        let plate = tangent.inverse * guided.free_part(force) + told;
        let motion = first * plate;
        let parts = to.part - from.part;
        let motions = self.each(|index, free| {
            let mut cap = free.lever(from.part) * motion;
            let mut shift = cap.fixed_rows_mut::<3>(0);
            shift += free.closing() * parts;
            let response = free.response.as_ref()?;
            Some(free.solver.carried_motion(&shape.frees[index], response, rises[index], &cap))
        });
        Ok((plate, motions.into_iter().collect::<Option<_>>().ok_or(Lost(f64::NAN))?))
    }

    /// Outer radius of the widest FREE, m: turns weigh as forces there.
    fn radius(&self) -> f64 {
        self.frees.iter().map(|free| free.solver.outer_radius()).fold(0.0, f64::max)
    }
}
