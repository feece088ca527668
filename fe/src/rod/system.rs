use super::{
    chain::{Assembly, Chain, Condensed},
    equilibrium::Configuration,
    module::RodModule,
    path::Loads,
};
use crate::tip_plate::{GuidedPlate, InvertedBlock, Plate, PlateVariation};
use nalgebra::{Matrix6, Vector6};

/// Energy, gradient and tangent of a module in a configuration.
pub(super) struct System {
    pub energy: f64,
    pub chains: Vec<Assembly>,
    /// Plate's coordinates: gradient of energy of the plate's own loads.
    load_gradient: Vector6<f64>,
    /// Greatest relative residual.
    pub residual: f64,
}

/// A factorised system.
pub(super) struct Factored {
    pub condensed: Vec<Condensed>,
    pub plate: PlateVariation,
    pub inverse: Matrix6<f64>,
    /// Plate's coordinates: gradient of energy of the plate's own loads.
    load_gradient: Vector6<f64>,
    pub negative: u32,
}

impl RodModule {
    /// `None` where a section law has no answer.
    pub(super) fn assemble(
        &self,
        chains: &[Chain],
        shape: &Configuration,
        loads: &Loads,
        sensitivities: bool,
    ) -> Option<System> {
        let frame = shape.plate.frame();
        let mut assemblies = Vec::with_capacity(chains.len());
        for (chain, inner) in chains.iter().zip(&shape.inner) {
            assemblies.push(chain.assemble(inner, &frame, &loads.pressures, sensitivities)?);
        }
        let load_gradient = -self.tip.acting(loads.part, loads.payload);
        let energy = assemblies.iter().map(|chain| chain.energy).sum::<f64>()
            + load_gradient.dot(&(shape.plate.0 - self.straight_plate()));
        let mut system = System { energy, chains: assemblies, load_gradient, residual: 0.0 };
        let (force, arm) = self.reference;
        let size = |g: Vector6<f64>| {
            let relative = |i: usize| if i < 3 { g[i] / force } else { g[i] / (force * arm) };
            (0..6).map(|i| relative(i).abs()).fold(0.0, f64::max)
        };
        let inner = system.chains.iter().flat_map(|chain| &chain.columns[..chain.columns.len() - 1]);
        let inner = inner.map(|columns| size(columns.column(0).into())).fold(0.0, f64::max);
        system.residual = size(self.tip.free_part(self.gradient(chains, shape, &system))).max(inner);
        system.residual.is_finite().then_some(system)
    }

    fn straight_plate(&self) -> Vector6<f64> {
        Plate::at_height(self.module.length()).0
    }

    /// Gradient of the energy in the plate's coordinates.
    fn gradient(&self, chains: &[Chain], shape: &Configuration, system: &System) -> Vector6<f64> {
        let pulls = chains.iter().zip(&system.chains).map(|(chain, assembly)| {
            let at_tip = assembly.columns[assembly.columns.len() - 1].column(0);
            chain.to_tip().transpose() * at_tip
        });
        shape.plate.vary().first.transpose() * pulls.sum::<Vector6<f64>>() + system.load_gradient
    }

    /// Derivative of the energy along a motion of the plate's coordinates and the inner nodes.
    pub(super) fn slope_along(
        &self,
        chains: &[Chain],
        shape: &Configuration,
        system: &System,
        (plate, inner): (&Vector6<f64>, &[Vec<Vector6<f64>>]),
    ) -> f64 {
        let nodes = system.chains.iter().zip(inner);
        let inner = nodes.flat_map(|(chain, motions)| chain.columns.iter().zip(motions));
        let inner: f64 = inner.map(|(columns, xi)| columns.column(0).dot(xi)).sum();
        self.gradient(chains, shape, system).dot(plate) + inner
    }

    pub(super) fn factorise(
        &self,
        chains: &[Chain],
        shape: &Configuration,
        system: &System,
    ) -> Option<Factored> {
        self.factorise_with(chains, shape, system, &Matrix6::zeros())
    }

    /// With `stiffener` added to the tangent of every inner node and of the plate's coordinates.
    pub(super) fn factorise_with(
        &self,
        chains: &[Chain],
        shape: &Configuration,
        system: &System,
        stiffener: &Matrix6<f64>,
    ) -> Option<Factored> {
        let plate = shape.plate.vary();
        let mut condensed = Vec::with_capacity(chains.len());
        for (chain, assembly) in chains.iter().zip(&system.chains) {
            condensed.push(chain.condense(assembly, stiffener)?);
        }
        let stiffness: Matrix6<f64> = condensed.iter().map(|chain| chain.stiffness).sum();
        let plain: Vector6<f64> = condensed.iter().map(|chain| chain.plain_gradient).sum();
        let hessian = plate.hessian(&plain, &stiffness) + stiffener;
        let InvertedBlock { inverse, negative } = self.tip.inverted(&hessian)?;
        let negative = negative + condensed.iter().map(|chain| chain.negative).sum::<u32>();
        Some(Factored { condensed, plate, inverse, load_gradient: system.load_gradient, negative })
    }
}

impl Factored {
    /// Newton's motion of the plate's coordinates and of each FREE's inner nodes.
    pub fn newton_step(&self, tip: &GuidedPlate) -> (Vector6<f64>, Vec<Vec<Vector6<f64>>>) {
        self.answer(0, &self.load_gradient, tip)
    }

    /// Minus the inverse of the tangent times a column and what goes with it in the plate's coordinates.
    pub fn answer(
        &self,
        column: usize,
        on_plate: &Vector6<f64>,
        tip: &GuidedPlate,
    ) -> (Vector6<f64>, Vec<Vec<Vector6<f64>>>) {
        let pulled: Vector6<f64> =
            self.condensed.iter().map(|chain| chain.columns.column(column).into_owned()).sum();
        let plate = -(self.inverse * tip.free_part(self.plate.first.transpose() * pulled + on_plate));
        let motion = self.plate.first * plate;
        (plate, self.condensed.iter().map(|chain| chain.inner_motion(column, &motion)).collect())
    }
}
