use super::{
    chain::{Assembly, Chain, Condensed},
    equilibrium::Configuration,
    module::RodModule,
    path::Loads,
};
use crate::tip_plate::{InvertedBlock, Plate, PlateVariation};
use nalgebra::{Matrix6, Vector6};

/// Energy, gradient and tangent of a module in a configuration.
pub(super) struct System {
    pub energy: f64,
    chains: Vec<Assembly>,
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
    /// Condensed gradient in the plate's coordinates.
    gradient: Vector6<f64>,
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
        let load_gradient = -self.tip.load * loads.part;
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

    pub(super) fn factorise(
        &self,
        chains: &[Chain],
        shape: &Configuration,
        system: &System,
    ) -> Option<Factored> {
        let plate = shape.plate.vary();
        let mut condensed = Vec::with_capacity(chains.len());
        for (chain, assembly) in chains.iter().zip(&system.chains) {
            condensed.push(chain.condense(assembly)?);
        }
        let stiffness: Matrix6<f64> = condensed.iter().map(|chain| chain.stiffness).sum();
        let plain: Vector6<f64> = condensed.iter().map(|chain| chain.plain_gradient).sum();
        let pulled: Vector6<f64> = condensed.iter().map(|chain| chain.columns.column(0).into_owned()).sum();
        let hessian = plate.hessian(&plain, &stiffness);
        let InvertedBlock { inverse, negative } = self.tip.inverted(&hessian)?;
        let negative = negative + condensed.iter().map(|chain| chain.negative).sum::<u32>();
        let gradient = self.tip.free_part(plate.first.transpose() * pulled + system.load_gradient);
        Some(Factored { condensed, plate, inverse, gradient, negative })
    }
}

impl Factored {
    /// Newton's motion of the plate's coordinates and of each FREE's inner nodes.
    pub fn newton_step(&self) -> (Vector6<f64>, Vec<Vec<Vector6<f64>>>) {
        let plate = -(self.inverse * self.gradient);
        let motion = self.plate.first * plate;
        (plate, self.condensed.iter().map(|chain| chain.inner_motion(&motion)).collect())
    }
}
