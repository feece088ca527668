use super::{
    chain::Chain,
    equilibrium::{Configuration, Equilibrium, RodError},
    module::RodModule,
    system::Factored,
};
use crate::{NoEquilibrium, tip_plate::Plate};
use actuator::PoseChart;
use nalgebra::{Vector3, Vector6};

/// Relative residual of a converged state; rounding leaves about 1e-12.
const TOLERANCE: f64 = 1e-10;
/// Newton's steps allowed before the pressure step is halved.
const NEWTON_STEPS: usize = 20;
/// Longest pressure step, Pa: short enough to stay on the branch that comes from rest.
const PRESSURE_STEP: f64 = 15e3;
/// Greatest strain of a FREE's own length against the mean one that is put on in a step.
const MISFIT_STEP: f64 = 5e-3;
/// Shortest step as a part of the way before it is given up.
const SHORTEST_STEP: f64 = 1e-4;
/// Greatest change of an element's rotation (rad) and stretch in one Newton step.
const STEP_LIMITS: (f64, f64) = (0.4, 0.3);

/// What acts on a module.
#[derive(Clone)]
pub(super) struct Loads {
    /// Gauge pressures, Pa.
    pub pressures: Vec<f64>,
    /// Part that acts of weights, tip load, and differences of the FREEs' lengths.
    pub part: f64,
    /// Mass on the plate beyond the module's own, kg.
    pub payload: f64,
}

impl Loads {
    /// Pressures (Pa) under all that the module has to carry.
    pub fn at(pressures: &[f64]) -> Self {
        Loads { pressures: pressures.to_vec(), part: 1.0, payload: 0.0 }
    }
}

impl RodModule {
    /// Equilibrium at the pressures (Pa), followed from rest: first weights, tip load and the FREEs' own lengths are put
    /// on without pressure, then all pressures are raised together.
    pub fn solve(&self, pressures: &[f64]) -> Result<Equilibrium, RodError> {
        let rest = self.rest()?;
        self.solve_from(&rest, pressures)
    }

    /// Equilibrium without pressure under the weights, the tip load, and the prestress of FREEs of different lengths.
    pub fn rest(&self) -> Result<Equilibrium, RodError> {
        let to = Loads::at(&vec![0.0; self.laws.len()]);
        self.follow(&self.straight(), &Loads { part: 0.0, ..to.clone() }, &to)
    }

    /// Equilibrium at the pressures (Pa), followed from another one in a straight line of pressures.
    pub fn solve_from(&self, start: &Equilibrium, pressures: &[f64]) -> Result<Equilibrium, RodError> {
        let finite = pressures.iter().filter(|pressure| pressure.is_finite()).count();
        if finite != self.laws.len() || pressures.len() != finite {
            return Err(RodError::Count { what: "finite pressures", given: finite, needed: self.laws.len() });
        }
        self.follow(&start.configuration, &Loads::at(&start.pressures), &Loads::at(pressures))
    }

    /// Tip pose with a further mass (kg) on the plate of an equilibrium.
    ///
    /// # Errors
    /// [`RodError`] where it cannot carry it.
    pub fn loaded(&self, start: &Equilibrium, payload: f64) -> Result<PoseChart, RodError> {
        let from = Loads::at(&start.pressures);
        let to = Loads { payload, ..from.clone() };
        Ok(self.follow(&start.configuration, &from, &to)?.state.chart)
    }

    fn follow(&self, start: &Configuration, from: &Loads, to: &Loads) -> Result<Equilibrium, RodError> {
        let between = |t: f64| Loads {
            pressures: from
                .pressures
                .iter()
                .zip(&to.pressures)
                .map(|(a, b)| if t < 1.0 { a + t * (b - a) } else { *b })
                .collect(),
            part: from.part + t * (to.part - from.part),
            payload: from.payload + t * (to.payload - from.payload),
        };
        let longest =
            from.pressures.iter().zip(&to.pressures).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let misfit = (to.part - from.part).abs() * self.misfit();
        // Equal steps, so that the last is not a splinter.
        let mut step = 1.0 / (longest / PRESSURE_STEP).max(misfit / MISFIT_STEP).max(1.0).ceil();
        let (mut done, mut shape) = (0.0, start.clone());
        loop {
            let goal = if done + step > 1.0 - 1e-9 { 1.0 } else { done + step };
            match self.newton(&shape, &between(goal)) {
                Ok(found) => {
                    shape = found;
                    done = goal;
                    if done == 1.0 {
                        return self.finish(shape, to);
                    }
                }
                Err(residual) if step < SHORTEST_STEP => {
                    let (goal, reached) = (to.pressures.clone(), between(done).pressures);
                    return Err(NoEquilibrium { goal, reached, residual, last: Box::new(shape) }.into());
                }
                Err(_) => step *= 0.5,
            }
        }
    }

    /// Newton's method with a step limit and backtracking; the least residual met where it does not converge.
    pub(super) fn newton(&self, start: &Configuration, loads: &Loads) -> Result<Configuration, f64> {
        let chains = self.chains(loads.part);
        let assemble = |shape: &Configuration| self.assemble(&chains, shape, loads, false);
        let mut shape = start.clone();
        let mut system = assemble(&shape).ok_or(f64::INFINITY)?;
        let mut least = system.residual;
        for _ in 0..NEWTON_STEPS {
            let factored = self.factorise(&chains, &shape, &system).ok_or(least)?;
            let (plate, inner) = factored.newton_step(&self.tip);
            let mut length = step_length(&plate, &inner, &factored, &chains);
            // The residual may grow a little on the way along a bent path, but not run off.
            let (next, found) = loop {
                let trial = moved(&shape, &plate, &inner, length);
                match assemble(&trial) {
                    Some(found) if found.residual < 3.0 * system.residual || found.residual < 1e-6 => {
                        break (trial, found);
                    }
                    _ if length < 1e-3 => return Err(least),
                    _ => length *= 0.5,
                }
            };
            shape = next;
            // Once below the tolerance one more step was as good as free: accept what it gives.
            let before = system.residual;
            system = found;
            least = least.min(system.residual);
            if system.residual < TOLERANCE && (before < 1e-5 || system.residual < 1e-13) {
                return Ok(shape);
            }
        }
        Err(least)
    }
}

/// Part of Newton's step that keeps every element's change within limits.
pub(super) fn step_length(
    plate: &Vector6<f64>,
    inner: &[Vec<Vector6<f64>>],
    factored: &Factored,
    chains: &[Chain],
) -> f64 {
    let mut worst: f64 = 1.0;
    for (chain, motions) in chains.iter().zip(inner) {
        let tip = chain.to_tip() * (factored.plate.first * plate);
        let mut below = Vector6::zeros();
        let length = chain.members[0].law.length;
        for motion in motions.iter().chain(std::iter::once(&tip)) {
            let turned: Vector3<f64> = motion.fixed_rows::<3>(3) - below.fixed_rows::<3>(3);
            let carried = below.fixed_rows::<3>(3).cross(&Vector3::z()) * length;
            let shifted: Vector3<f64> = motion.fixed_rows::<3>(0) - below.fixed_rows::<3>(0) - carried;
            let turn = turned.norm() / STEP_LIMITS.0;
            let shift = shifted.norm() / (length * STEP_LIMITS.1);
            worst = worst.max(turn).max(shift);
            below = *motion;
        }
    }
    1.0 / worst
}

pub(super) fn moved(
    shape: &Configuration,
    plate: &Vector6<f64>,
    inner: &[Vec<Vector6<f64>>],
    length: f64,
) -> Configuration {
    Configuration {
        plate: Plate(shape.plate.0 + plate * length),
        inner: shape
            .inner
            .iter()
            .zip(inner)
            .map(|(nodes, motions)| {
                nodes.iter().zip(motions).map(|(node, xi)| node.moved(&(xi * length))).collect()
            })
            .collect(),
    }
}
