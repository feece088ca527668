use super::{
    chain::Columns,
    equilibrium::{Configuration, Equilibrium},
    module::RodModule,
    path::{Loads, moved},
    system::{Factored, System},
};
use nalgebra::{Matrix6, Vector3, Vector6};

/// A small motion of a module away from an equilibrium: an eigenvector of the tangent K in the metric M in which a node's shift by the
/// outer radius b counts as its turn by a radian, `K x = value M x`.
#[derive(Clone, Debug)]
pub struct BucklingMode {
    /// Eigenvalue, J: negative where the module leaves the equilibrium along the mode, zero where it buckles.
    pub value: f64,
    /// Change of the tip's chart (in the order of [`actuator::PoseChart::to_array`]) per metre of the greatest shift of a centreline.
    pub chart: [f64; 6],
    /// Shift of the tip plate's centre, base frame, by the same measure: small where FREEs buckle between plates that stay.
    pub tip_shift: [f64; 3],
    /// Shift of each FREE's centreline at its nodes from the base to the tip, base frame; the greatest of all has length one.
    pub centrelines: Vec<Vec<[f64; 3]>>,
    motion: Motion,
}

/// Plate's coordinates, and inner nodes of each chain in their own frames.
#[derive(Clone, Debug)]
struct Motion {
    plate: Vector6<f64>,
    inner: Vec<Vec<Vector6<f64>>>,
}

/// Steps of the inverse iteration: the eigenvalues next to the least may lie close, as of a FREE that may buckle to any side.
const ITERATIONS: usize = 60;
/// Change of the eigenvalue, relative to the metric, at which it ends.
const SETTLED: f64 = 1e-10;

impl BucklingMode {
    /// Greatest shift of each FREE's centreline; the greatest of all is one.
    pub fn shifts(&self) -> Vec<f64> {
        let length = |shift: &[f64; 3]| Vector3::from(*shift).norm();
        self.centrelines.iter().map(|nodes| nodes.iter().map(length).fold(0.0, f64::max)).collect()
    }
}

impl Motion {
    fn scaled(&self, factor: f64) -> Self {
        let nodes = |nodes: &Vec<Vector6<f64>>| nodes.iter().map(|xi| xi * factor).collect();
        Motion { plate: self.plate * factor, inner: self.inner.iter().map(nodes).collect() }
    }

    fn weighed(&self, metric: &Vector6<f64>) -> Self {
        let nodes = |nodes: &Vec<Vector6<f64>>| nodes.iter().map(|xi| xi.component_mul(metric)).collect();
        Motion { plate: self.plate.component_mul(metric), inner: self.inner.iter().map(nodes).collect() }
    }

    fn dot(&self, other: &Self) -> f64 {
        let inner = self.inner.iter().flatten().zip(other.inner.iter().flatten());
        self.plate.dot(&other.plate) + inner.map(|(a, b)| a.dot(b)).sum::<f64>()
    }
}

/// A system that is factorised with `spring` M added to its tangent.
pub(super) struct Stiffened {
    pub spring: f64,
    pub factored: Factored,
}

impl RodModule {
    /// Diagonal of the metric M.
    pub(super) fn metric(&self) -> Vector6<f64> {
        let (_, radius) = self.reference;
        let shift = radius.powi(-2);
        Vector6::new(shift, shift, shift, 1.0, 1.0, 1.0)
    }

    /// Spring, J, that is small beside the stiffness of an element.
    pub(super) fn soft_spring(&self) -> f64 {
        let (force, radius) = self.reference;
        1e-6 * force * radius
    }

    /// The weakest of springs 0, s, 4 s, ... (J) from `least` on that leave no negative pivots.
    pub(super) fn stiffened(
        &self,
        shape: &Configuration,
        system: &System,
        loads: &Loads,
        least: f64,
    ) -> Option<Stiffened> {
        let chains = self.chains(loads.part);
        let mut spring = least;
        for _ in 0..40 {
            let stiffener = Matrix6::from_diagonal(&(self.metric() * spring));
            let factored = self.factorise_with(&chains, shape, system, &stiffener);
            match factored {
                Some(factored) if factored.negative == 0 => return Some(Stiffened { spring, factored }),
                _ => spring = (4.0 * spring).max(self.soft_spring()),
            }
        }
        None
    }

    /// The motion that an equilibrium withstands least: of the least eigenvalue of its tangent. `None` where the tangent has no factors.
    pub fn softest_mode(&self, at: &Equilibrium) -> Option<BucklingMode> {
        let shape = &at.configuration;
        let loads = Loads::at(&at.pressures);
        let chains = self.chains(1.0);
        let mut system = self.assemble(&chains, shape, &loads, false)?;
        for chain in &mut system.chains {
            for columns in &mut chain.columns {
                let gradient = columns.column(0).into_owned();
                *columns = Columns::from_columns(&[gradient, Vector6::zeros()]);
            }
        }
        let mut spring = self.stiffened(shape, &system, &loads, 0.0)?.spring;
        let metric = self.metric();
        // Without any symmetry of a module, so that no mode is missed.
        let mut seed = 0.37;
        let mut next = || {
            seed = (seed * 9301.7 + 0.4927) % 1.0;
            Vector6::from_fn(|i, _| (seed * 7.0 * (i + 1) as f64).sin())
        };
        let inner = shape.inner.iter().map(|nodes| nodes.iter().map(|_| next()).collect()).collect();
        let mut motion = Motion { plate: self.tip.free_part(next()), inner };
        let mut value = f64::INFINITY;
        for step in 0..ITERATIONS {
            let weighed = motion.weighed(&metric);
            for (chain, loads) in system.chains.iter_mut().zip(&weighed.inner) {
                for (columns, load) in chain.columns.iter_mut().zip(loads) {
                    columns.set_column(1, load);
                }
            }
            let stiffener = Matrix6::from_diagonal(&(metric * spring));
            let factored = self.factorise_with(&chains, shape, &system, &stiffener)?;
            let (plate, inner) = factored.answer(1, &self.tip.free_part(weighed.plate), &self.tip);
            // x = -(K + s M)^-1 M y, so that y M y/(y M x) is -(value + s).
            let found = Motion { plate, inner };
            let size = weighed.dot(&motion);
            let present = -size / weighed.dot(&found) - spring;
            let length = found.dot(&found.weighed(&metric)).sqrt();
            motion = found.scaled(-1.0 / length);
            let change = (present - value).abs();
            value = present;
            if step > 3 && change < SETTLED * (1.0 + value.abs()) {
                break;
            }
            // A spring next to the eigenvalue, on its safe side, tells it from its neighbours.
            if step % 8 == 7 {
                let closer = -value + 0.2 * (spring + value);
                spring = if value < 0.0 && closer > -value { closer } else { spring };
                spring = self.stiffened(shape, &system, &loads, spring)?.spring;
            }
        }
        Some(self.told(shape, motion, value))
    }

    /// The mode in words of the module.
    fn told(&self, shape: &Configuration, motion: Motion, value: f64) -> BucklingMode {
        let turns = shape.plate.vary().first * motion.plate;
        let frame = shape.plate.frame();
        let mut centrelines: Vec<(usize, Vec<Vector3<f64>>)> = vec![];
        for ((chain, inner), moves) in self.chains(1.0).iter().zip(&shape.inner).zip(&motion.inner) {
            let tip = chain.to_tip() * turns;
            let frames = chain.frames(inner, &frame).skip(1);
            let moves: Vec<_> = frames.zip(moves.iter().chain(std::iter::once(&tip))).collect();
            for member in &chain.members {
                let shifts = moves.iter().map(|(node, xi)| {
                    let own = crate::tip_plate::at_arm(&member.arm) * **xi;
                    node.rotation * Vector3::from(own.fixed_rows::<3>(0))
                });
                let all = std::iter::once(Vector3::zeros()).chain(shifts).collect();
                centrelines.push((member.free, all));
            }
        }
        centrelines.sort_by_key(|(free, _)| *free);
        let shifts = centrelines.iter().flat_map(|(_, nodes)| nodes).map(|shift| shift.norm());
        let factor = 1.0 / shifts.fold(f64::MIN_POSITIVE, f64::max);
        let whole = |(_, nodes): (usize, Vec<Vector3<f64>>)| {
            nodes.into_iter().map(|shift| (shift * factor).into()).collect()
        };
        let motion = motion.scaled(factor);
        BucklingMode {
            value,
            chart: shape.plate.chart_slope(&motion.plate),
            tip_shift: Vector3::from(motion.plate.fixed_rows::<3>(0)).into(),
            centrelines: centrelines.into_iter().map(whole).collect(),
            motion,
        }
    }

    /// The shape moved along a mode by `offset` (m) at the place where it is greatest.
    pub(super) fn displaced(&self, shape: &Configuration, mode: &BucklingMode, offset: f64) -> Configuration {
        moved(shape, &mode.motion.plate, &mode.motion.inner, offset)
    }
}
