use super::{
    chain::{Assembly, Chain, Condensed},
    equilibrium::Configuration,
    module::RodModule,
    path::Loads,
    pivots::InvertedBlock,
    plate::{Plate, PlateVariation},
};
use actuator::units::STANDARD_GRAVITY;
use nalgebra::{Matrix6, Vector3, Vector6};

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
        let load_gradient = -self.plate_load() * loads.part;
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
        system.residual = size(self.free_part(self.gradient(chains, shape, &system))).max(inner);
        system.residual.is_finite().then_some(system)
    }

    fn straight_plate(&self) -> Vector6<f64> {
        Plate::at_height(self.module.length()).0
    }

    /// Generalised forces on the plate's coordinates of weight and tip load.
    fn plate_load(&self) -> Vector6<f64> {
        let (tip, base, load) = (&self.module.tip, &self.module.base, &self.settings.tip_load);
        let weight = Vector3::from(base.gravity) * (STANDARD_GRAVITY * (tip.plate_mass + tip.payload));
        let ([fx, fy, fz], [mx, my, mz]) = (load.force, load.moment);
        Vector6::new(weight.x + fx, weight.y + fy, weight.z + fz, mx, my, mz)
    }

    /// Gradient of the energy in the plate's coordinates.
    fn gradient(&self, chains: &[Chain], shape: &Configuration, system: &System) -> Vector6<f64> {
        let pulls = chains.iter().zip(&system.chains).map(|(chain, assembly)| {
            let at_tip = assembly.columns[assembly.columns.len() - 1].column(0);
            chain.to_tip().transpose() * at_tip
        });
        shape.plate.vary().first.transpose() * pulls.sum::<Vector6<f64>>() + system.load_gradient
    }

    pub(super) fn free_part(&self, mut vector: Vector6<f64>) -> Vector6<f64> {
        for (value, free) in vector.iter_mut().zip(self.module.tip.free_dof) {
            if !free {
                *value = 0.0;
            }
        }
        vector
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
        let mut hessian = plate.hessian(&plain, &stiffness);
        for (i, free) in self.module.tip.free_dof.into_iter().enumerate() {
            if !free {
                hessian.row_mut(i).fill(0.0);
                hessian.column_mut(i).fill(0.0);
                hessian[(i, i)] = 1.0;
            }
        }
        let InvertedBlock { inverse, negative } = InvertedBlock::new(&hessian)?;
        let negative = negative + condensed.iter().map(|chain| chain.negative).sum::<u32>();
        let gradient = self.free_part(plate.first.transpose() * pulled + system.load_gradient);
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
