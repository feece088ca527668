use super::{
    SolidModuleError,
    equations::{Loads, Sums},
    equilibrium::{HeldPlate, SolidEquilibrium, SolidShape},
    module::SolidModule,
    newton::Found,
};
use crate::{Closest, Lost, NoEquilibrium, tip_plate::Plate};
use actuator::{ModuleState, PoseChart, Wrench};
use nalgebra::{Vector3, Vector6};

/// Longest step of a pressure, Pa: short enough to stay on the branch that comes from rest.
const PRESSURE_STEP: f64 = 15e3;
/// Longest step of a plate that is held: turn, rad, and shift over the module's length.
const HELD_STEP: [f64; 2] = [0.2, 0.05];
/// Shortest step as a part of the way before it is given up.
const SHORTEST_STEP: f64 = 5e-3;

impl SolidModule {
    /// Equilibrium at the pressures (Pa), followed from rest: first the weights and the tip load are put on without
    /// pressure, then all pressures are raised together.
    ///
    /// # Errors
    /// [`SolidModuleError`] for a wrong number of pressures, and where the path ends.
    pub fn solve(&mut self, pressures: &[f64]) -> Result<SolidEquilibrium, SolidModuleError> {
        let rest = self.rest()?;
        self.solve_from(&rest.shape, pressures)
    }

    /// Equilibrium without pressure under the weights and the tip load.
    ///
    /// # Errors
    /// [`SolidModuleError`] where there is none.
    pub fn rest(&mut self) -> Result<SolidEquilibrium, SolidModuleError> {
        let straight = self.straight();
        let to = self.loads_from(&straight);
        let shape = self.follow(&straight, &Loads { part: 0.0, ..to.clone() }, &to)?;
        self.finish(shape, &to)
    }

    /// Equilibrium at the pressures (Pa), followed from another one in a straight line of pressures.
    ///
    /// # Errors
    /// [`SolidModuleError`] for a wrong number of pressures, and where the path ends.
    pub fn solve_from(
        &mut self,
        start: &SolidShape,
        pressures: &[f64],
    ) -> Result<SolidEquilibrium, SolidModuleError> {
        let to = Loads { pressures: self.checked(pressures)?, ..self.loads_from(start) };
        let shape = self.follow(start, &self.loads_from(start), &to)?;
        self.finish(shape, &to)
    }

    /// Tip pose with a further mass (kg) on the plate of an equilibrium.
    ///
    /// # Errors
    /// [`SolidModuleError`] where it cannot carry it.
    pub fn loaded(&mut self, start: &SolidShape, payload: f64) -> Result<PoseChart, SolidModuleError> {
        let from = self.loads_from(start);
        let to = Loads { payload, ..from.clone() };
        Ok(self.follow(start, &from, &to)?.chart())
    }

    /// What the module does to something that holds its plate in a pose while the pressures (Pa) act: followed from a shape that is held
    /// or free, in straight lines of pressures and of the plate's coordinates.
    ///
    /// # Errors
    /// [`SolidModuleError`] for a wrong number of pressures, and where the path ends.
    pub fn hold(
        &mut self,
        start: &SolidShape,
        chart: &PoseChart,
        pressures: &[f64],
    ) -> Result<HeldPlate, SolidModuleError> {
        let from = Loads { free: [false; 6], held: start.plate.0, ..self.loads_from(start) };
        let held = Plate::at_chart(chart).0;
        let to = Loads { pressures: self.checked(pressures)?, held, ..from.clone() };
        let shape = self.follow(start, &from, &to)?;
        let sums = self.linearise(&shape, &to).map_err(|lost| no_equilibrium(&to, &shape, lost))?;
        let negative_pivots = self.tangent.as_ref().map_or(0, |tangent| tangent.negative);
        let rotation = shape.plate.frame().rotation;
        // Forces on the caps are what must act on them to hold them there: what they give is minus that.
        let on_plate = |own: Vector6<f64>| {
            let turned = |first: usize| -(rotation * Vector3::from(own.fixed_rows::<3>(first)));
            Wrench { force: turned(0).into(), moment: turned(3).into() }
        };
        let levers = self.frees.iter().map(|free| free.lever(to.part).transpose());
        let wrenches = levers.clone().zip(&sums.caps).map(|(lever, cap)| on_plate(lever * cap.residual));
        let slopes = levers
            .zip(&self.frees)
            .filter_map(|(lever, free)| Some(on_plate(-(lever * free.response.as_ref()?.by_pressure))));
        Ok(HeldPlate {
            wrenches: wrenches.collect(),
            wrench_slopes: slopes.collect(),
            negative_pivots,
            residual: sums.error,
            energy: sums.energy,
            shape,
        })
    }

    pub(super) fn checked(&self, pressures: &[f64]) -> Result<Vec<f64>, SolidModuleError> {
        let finite = pressures.iter().filter(|pressure| pressure.is_finite()).count();
        if finite != self.frees.len() || pressures.len() != finite {
            return Err(SolidModuleError::Count { given: finite, needed: self.frees.len() });
        }
        Ok(pressures.to_vec())
    }

    /// All weights, and the plate on its guides.
    pub(super) fn loads_from(&self, shape: &SolidShape) -> Loads {
        let free = self.tip.free;
        let pressures = shape.pressures.clone();
        Loads { pressures, part: 1.0, payload: 0.0, free, held: Plate::at_height(self.height).0 }
    }

    /// Assembles and factorises at an equilibrium, unless the tangent is already that one.
    pub(super) fn linearise(&mut self, shape: &SolidShape, loads: &Loads) -> Result<Sums, Lost> {
        let known = self.tangent.as_ref().is_some_and(|tangent| tangent.is_at(shape, loads));
        self.each(|_, free| free.solver.forget_foreseen());
        let sums = self.assemble(shape, loads, !known)?;
        if !known {
            self.factorise(shape, loads, &sums)?;
            if let Some(tangent) = &mut self.tangent {
                tangent.equilibrium = Some((shape.plate, loads.clone()));
            }
        }
        Ok(sums)
    }

    /// Follows equilibria in a straight line of loads.
    fn follow(
        &mut self,
        start: &SolidShape,
        from: &Loads,
        to: &Loads,
    ) -> Result<SolidShape, SolidModuleError> {
        let longest = self.longest_step(from, to);
        let (mut done, mut stride, mut shape) = (0.0, longest, start.clone());
        while done < 1.0 {
            let now = between(from, to, done);
            let lost = |lost: Lost, shape: &SolidShape| no_equilibrium(to, shape, lost);
            self.linearise(&shape, &now).map_err(|residual| lost(residual, &shape))?;
            let (plate, motions) = self.slope(&shape, &now, to).map_err(|residual| lost(residual, &shape))?;
            let left = 1.0 - done;
            loop {
                // Equal steps, so that the last is not a splinter.
                let pieces = (left / stride - 1e-9).ceil().max(1.0);
                let next = if pieces == 1.0 { 1.0 } else { done + left / pieces };
                let loads = between(from, to, next);
                let guess = self.moved(&shape, (&plate, &motions), 1.0 / pieces, &loads);
                let has_tangent = self.tangent.as_ref().is_some_and(|tangent| tangent.is_at(&shape, &now));
                match self.equilibrate(guess, &loads, has_tangent) {
                    Ok(Found { shape: found, tangents }) => {
                        (shape, done) = (found, next);
                        if tangents < 2 {
                            stride = (2.0 * stride).min(longest);
                        }
                        break;
                    }
                    Err(residual) => {
                        stride = 0.5 * left / pieces;
                        if stride < SHORTEST_STEP {
                            return Err(lost(residual, &shape));
                        }
                    }
                }
            }
        }
        Ok(shape)
    }

    /// The longest part of the way in one step.
    fn longest_step(&self, from: &Loads, to: &Loads) -> f64 {
        let rise = from.pressures.iter().zip(&to.pressures).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let moved = to.held - from.held;
        let ratios = [
            rise / PRESSURE_STEP,
            moved.fixed_rows::<3>(3).norm() / HELD_STEP[0],
            moved.fixed_rows::<3>(0).norm() / (HELD_STEP[1] * self.height),
        ];
        1.0 / ratios.into_iter().fold(1.0, f64::max)
    }

    /// Takes the derivatives of a converged shape.
    fn finish(&mut self, shape: SolidShape, loads: &Loads) -> Result<SolidEquilibrium, SolidModuleError> {
        let sums = self.linearise(&shape, loads).map_err(|lost| no_equilibrium(loads, &shape, lost))?;
        let guided = self.guided(loads);
        let tangent = self.tangent.as_ref();
        let tangent = tangent.ok_or_else(|| no_equilibrium(loads, &shape, Lost(f64::INFINITY)))?;
        let slope =
            |force: Vector6<f64>| shape.plate.chart_slope(&(tangent.inverse * guided.free_part(force)));
        let pressed = self.frees.iter().filter_map(|free| {
            let on_plate = free.lever(loads.part).transpose() * free.response.as_ref()?.by_pressure;
            Some(slope(tangent.variation.first.transpose() * on_plate))
        });
        let tubes: Vec<_> =
            self.frees.iter().zip(&shape.frees).map(|(free, state)| free.tube(state)).collect();
        let closest = Closest::of(&tubes);
        let state = ModuleState {
            chart: shape.chart(),
            slopes: vec![slope(guided.load_per_payload)],
            negative_pivots: tangent.negative,
            residual: sums.error,
            gap: closest.map(|closest| closest.gap),
        };
        Ok(SolidEquilibrium {
            closest,
            state,
            energy: sums.energy,
            pressure_jacobian: pressed.collect(),
            shape,
        })
    }
}

/// Loads on the straight way from some to others.
fn between(from: &Loads, to: &Loads, part: f64) -> Loads {
    // The end without rounding.
    if part >= 1.0 {
        return to.clone();
    }
    let mix = |a: f64, b: f64| a + part * (b - a);
    Loads {
        pressures: from.pressures.iter().zip(&to.pressures).map(|(a, b)| mix(*a, *b)).collect(),
        part: mix(from.part, to.part),
        payload: mix(from.payload, to.payload),
        free: to.free,
        held: from.held + (to.held - from.held) * part,
    }
}

pub(super) fn no_equilibrium(goal: &Loads, last: &SolidShape, Lost(residual): Lost) -> SolidModuleError {
    let (goal, reached) = (goal.pressures.clone(), last.pressures.clone());
    NoEquilibrium { goal, reached, residual, last: Box::new(last.clone()) }.into()
}
