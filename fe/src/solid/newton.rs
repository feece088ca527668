use super::{
    SolidError, SolidMesh, Specimen,
    assembly::Forces,
    body::Body,
    state::{Motion, SolidLoad, SolidState, motion_of},
};
use crate::sparse::{Factorisation, Inertia};
use nalgebra::Vector3;
use std::time::{Duration, Instant};

/// Relative residual, and relative mismatch of volume, at which a state counts as in equilibrium.
const TOLERANCE: f64 = 1e-9;
/// A residual below this that two steps with new factorisations do not halve is what rounding leaves, on meshes of 10^5 nodes and more.
const ROUNDING: f64 = 1e-8;
/// Newton steps to one state.
const STEPS: usize = 25;
/// Steps with an old factorisation go on while each leaves at most this share of the error.
const CHORD_SHARE: f64 = 0.3;
/// A step may let the residual grow so much before it is shortened: the fibres answer to its curvature, and the next step corrects that.
const GROWTH: f64 = 20.0;

/// What is prescribed beside the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Control {
    /// The pressure is the load's.
    Pressure,
    /// The pressure is sought at which the enclosed volume (m^3, of the part that is meshed) is this.
    Volume(f64),
}

/// Where the time went, and how often.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolidCost {
    /// Steps of Newton's method, with a new factorisation or an old one.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Time in residuals and tangents.
    pub assembly: Duration,
    /// Time in factorisations.
    pub factorisation: Duration,
    /// Time in substitutions.
    pub substitution: Duration,
}

/// The equilibrium of one FREE as a solid: mesh, symbolic factorisation and space are made once, states are found one after another.
pub struct SolidSolver {
    pub(super) body: Body,
    pub(super) factorisation: Factorisation,
    pub(super) forces: Forces,
    /// Eigenvalue signs of the tangent factorised last.
    pub(super) inertia: Option<Inertia>,
    /// Where the last path was last.
    pub(super) last_good: Option<(f64, SolidState)>,
    /// Dead forces by which a path is led off a branch: a factor, forces on the points and on the cap's middle.
    pub(super) imperfection: Option<(f64, Vec<[f64; 3]>, Vector3<f64>)>,
    cost: SolidCost,
}

/// Why Newton's method gave up: the last relative residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lost(pub f64);

impl SolidSolver {
    /// The whole specimen.
    ///
    /// # Errors
    /// [`SolidError::Invalid`] or [`SolidError::Degenerate`] where specimen or mesh make no sense.
    pub fn new(specimen: &Specimen, mesh: SolidMesh) -> Result<Self, SolidError> {
        Self::of(Body::new(specimen, mesh, 1)?)
    }

    /// One of the equal sectors of a specimen that a turn by a fibre's pitch carries into itself, under loads that do the same (pressure,
    /// force and moment along the axis, gravity along it): the same equilibria as the whole, as long as they keep the symmetry. It
    /// has one unknown in as many as there are fibres, and cannot bend.
    ///
    /// # Errors
    /// [`SolidError::Invalid`] where the specimen has no such symmetry; else as [`SolidSolver::new`].
    pub fn sector(specimen: &Specimen, mesh: SolidMesh) -> Result<Self, SolidError> {
        let sectors = specimen.cyclic_order().filter(|&order| order > 1 && mesh.follows_fibres);
        let sectors = sectors.ok_or(SolidError::Invalid {
            field: "the number of equal sectors",
            value: 1.0,
            requirement: "a sector is for an even tube, bare or with one family of at least two fibres that the mesh follows",
        })?;
        Self::of(Body::new(specimen, mesh, sectors)?)
    }

    fn of(body: Body) -> Result<Self, SolidError> {
        let factorisation = Factorisation::new(&body.pattern, &[&body.order_by_lines()]);
        Ok(SolidSolver {
            body,
            factorisation,
            forces: Forces::default(),
            inertia: None,
            last_good: None,
            imperfection: None,
            cost: SolidCost::default(),
        })
    }

    /// The undeformed state, without load.
    pub fn rest(&self) -> SolidState {
        self.body.rest()
    }

    /// Unknowns of the system that is factorised.
    pub fn unknowns(&self) -> usize {
        self.body.pattern.dimension()
    }

    /// Operations (multiplications and additions) of one factorisation, and numbers that it stores.
    pub fn factorisation_size(&self) -> (f64, usize) {
        (self.factorisation.flops(), self.factorisation.stored())
    }

    /// What has been spent so far.
    pub fn cost(&self) -> SolidCost {
        self.cost
    }

    /// Assembles at a state; the pressure that acts is the state's.
    pub(super) fn assemble(&mut self, state: &SolidState, with_tangent: bool) -> Result<f64, Lost> {
        let start = Instant::now();
        let done = self.body.assemble(state, &state.load, with_tangent, &mut self.forces);
        self.cost.assembly += start.elapsed();
        done.map_err(|_| Lost(f64::NAN))?;
        if let Some((factor, points, cap)) = &self.imperfection {
            for vector in [&mut self.forces.residual, &mut self.forces.condensed] {
                self.body.add_point_forces(-factor, (points, *cap), vector);
            }
        }
        Ok(self.error(&state.load))
    }

    /// Relative residual of the last assembly.
    fn error(&self, load: &SolidLoad) -> f64 {
        let cap = self.body.cap_unknown;
        self.relative(&|index| index < cap || !load.held[index - cap])
    }

    /// Residual of the last assembly in the unknowns that count, over the size of the forces; or the mismatch of volume, if that is larger.
    pub(super) fn relative(&self, counts: &dyn Fn(usize) -> bool) -> f64 {
        let cap = self.body.cap_unknown;
        // Turns weigh as forces at the outer radius.
        let radius = self.body.specimen.tube.outer_radius();
        let squares: f64 = self
            .forces
            .residual
            .iter()
            .enumerate()
            .filter(|(index, _)| counts(*index))
            .map(|(index, value)| if index >= cap + 3 { (value / radius).powi(2) } else { value * value })
            .sum();
        (squares.sqrt() / self.force_scale()).max(self.forces.mismatch)
    }

    /// Size of the forces that cancel in the last assembly, N.
    pub(super) fn force_scale(&self) -> f64 {
        let radius = self.body.specimen.tube.outer_radius();
        // Without load there is nothing to compare with but the rubber's own stiffness.
        let (modulus, ratio) =
            (self.body.specimen.elastomer.initial_shear_modulus(), self.body.specimen.bulk_ratio);
        // Places are rounded to an epsilon of the length, which the bulk modulus makes into forces.
        let rounding = 0.1 * f64::EPSILON * ratio * self.body.specimen.tube.length / radius;
        let least = modulus * radius * radius * (rounding / TOLERANCE).max(1e-6);
        self.forces.scale.max(least)
    }

    /// Force (N) and moment (N m, in space) that must act on the cap beside the load to hold it: zero in the directions that are free.
    ///
    /// # Errors
    /// [`SolidError::NotConverged`] where elements of the state are turned inside out.
    pub fn reaction(&mut self, state: &SolidState) -> Result<[Vector3<f64>; 2], SolidError> {
        self.assemble(state, false).map_err(|lost| self.lost(state, lost, "the reaction"))?;
        let sectors = self.body.grid.sectors as f64;
        let on_cap = &self.forces.residual[self.body.cap_unknown..];
        let at = |first: usize| sectors * Vector3::new(on_cap[first], on_cap[first + 1], on_cap[first + 2]);
        Ok([at(0), at(3)])
    }

    /// The tangent assembled last times a motion of the cap: the forces on all unknowns.
    pub(super) fn tangent_times_cap(&self, motion: &[f64; 6]) -> Vec<f64> {
        let mut vector = vec![0.0; self.unknowns()];
        vector[self.body.cap_unknown..].copy_from_slice(motion);
        let mut forces = vec![0.0; self.unknowns()];
        self.body.pattern.multiply_into(&self.body.values, &vector, &mut forces);
        forces
    }

    /// Factorises the tangent assembled last, with the held motions of the cap taken out.
    pub(super) fn factorise(&mut self, held: [bool; 6]) -> Result<(), Lost> {
        self.body.take_out_held(held);
        let start = Instant::now();
        let inertia = self.factorisation.factorise(&self.body.values);
        self.cost.factorisation += start.elapsed();
        self.cost.factorisations += 1;
        self.inertia = Some(inertia.map_err(|_| Lost(f64::INFINITY))?);
        Ok(())
    }

    pub(super) fn substitute(&mut self, right_hand_sides: &mut [f64]) {
        let start = Instant::now();
        self.factorisation.solve(right_hand_sides);
        self.cost.substitution += start.elapsed();
    }

    /// The motion that belongs to a step of the unknowns from a state that was assembled.
    pub(super) fn motion(&self, state: &SolidState, step: &[f64], with_mismatch: bool) -> Motion {
        let (displacements, cap) = self.body.displacements(state, step);
        let mut motion = motion_of(&self.body.grid, state, &displacements);
        motion.pressures = self.body.pressure_steps(&displacements, with_mismatch);
        motion.rotations = self.body.turns_of(step);
        motion.cap = cap;
        motion
    }

    pub(super) fn moved(&self, state: &SolidState, motion: &Motion) -> SolidState {
        let mut next = state.moved(&self.body.grid, motion);
        self.body.settle(&mut next);
        next
    }

    /// First-order motion of an equilibrium, assembled last, when the pressure changes by `by_pressure`, force and moment on the cap by
    /// `forces`, gravity by `gravity` and the held motions of the cap by those of `held` (with the tangent times them), by the tangent
    /// factorised last; and the step of the unknowns.
    pub(super) fn first_order(
        &mut self,
        state: &SolidState,
        by_pressure: f64,
        forces: [Vector3<f64>; 2],
        gravity: Vector3<f64>,
        held: Option<(&[f64; 6], &[f64])>,
    ) -> (Motion, Vec<f64>) {
        let mut step: Vec<f64> =
            self.forces.by_pressure.iter().map(|gradient| by_pressure * gradient).collect();
        self.body.add_dead_loads(forces, gravity, &mut step);
        if let Some((_, moved)) = held {
            for (value, force) in step.iter_mut().zip(moved) {
                *value -= force;
            }
        }
        for direction in (0..6).filter(|&direction| state.load.held[direction]) {
            step[self.body.cap_unknown + direction] = held.map_or(0.0, |(motion, _)| motion[direction]);
        }
        self.substitute(&mut step);
        (self.motion(state, &step, false), step)
    }

    /// The equilibrium near `guess`, and the motion from the guess to it.
    pub(super) fn equilibrate(
        &mut self,
        guess: SolidState,
        control: Control,
    ) -> Result<(SolidState, Motion), Lost> {
        let mut state = guess;
        let mut total = Motion::none(&state, self.body.grid.lines[2]);
        let held = state.load.held;
        let gap = |forces: &Forces| match control {
            Control::Pressure => 0.0,
            Control::Volume(volume) => volume - forces.volume,
        };
        let mut error = self.assemble(&state, false)?;
        // Kept with the state: after a step that was not taken, the sums assembled last are those of its trial.
        let mut volume_gap = gap(&self.forces);
        let mut renew = true;
        let mut stalled = 0;
        for _ in 0..STEPS {
            if (error < TOLERANCE || stalled > 1) && volume_gap.abs() <= TOLERANCE * self.forces.volume.abs()
            {
                state.residual = error;
                state.energy = self.forces.energy;
                state.volume = self.forces.volume;
                return Ok((state, total));
            }
            if renew {
                self.assemble(&state, true)?;
                self.factorise(held)?;
            }
            let (step, pressure_step) = self.step(&state, control, volume_gap);
            self.cost.iterations += 1;
            // An old factorisation is worth one try.
            let tries = if renew { 6 } else { 1 };
            let mut share = 1.0;
            let mut best: Option<(f64, SolidState, f64)> = None;
            let mut last_share = share;
            for _ in 0..tries {
                last_share = share;
                let mut motion = Motion::none(&state, self.body.grid.lines[2]);
                motion.add(share, &step);
                let mut trial = self.moved(&state, &motion);
                trial.load.pressure += share * pressure_step;
                if let Ok(found) = self.assemble(&trial, false)
                    && best.as_ref().is_none_or(|(least, ..)| found < *least)
                {
                    best = Some((found, trial, share));
                }
                match &best {
                    // Far from equilibrium the residual may grow by the curvature of the step and still be on its way.
                    Some((found, ..)) if *found < GROWTH * error.max(1e-4) => break,
                    _ => share *= 0.5,
                }
            }
            match best {
                Some((found, next, share)) if renew || found < CHORD_SHARE * error => {
                    if share != last_share {
                        // The last trial assembled is not the best one.
                        self.assemble(&next, false)?;
                    }
                    volume_gap = gap(&self.forces);
                    total.add(share, &step);
                    state = next;
                    if renew {
                        stalled = if error < ROUNDING && found > 0.5 * error { stalled + 1 } else { 0 };
                    }
                    renew = false;
                    error = found;
                }
                None if renew => return Err(Lost(f64::NAN)),
                _ => renew = true,
            }
        }
        Err(Lost(error))
    }

    /// Newton's step from the state assembled last, with the factorisation there is; and the pressure's under volume control.
    fn step(&mut self, state: &SolidState, control: Control, volume_gap: f64) -> (Motion, f64) {
        let mut right: Vec<f64> = self.forces.condensed.iter().map(|force| -force).collect();
        let dimension = right.len();
        if let Control::Volume(_) = control {
            right.extend(&self.forces.by_pressure);
        }
        for column in right.chunks_exact_mut(dimension) {
            for direction in (0..6).filter(|&direction| state.load.held[direction]) {
                column[self.body.cap_unknown + direction] = 0.0;
            }
        }
        self.substitute(&mut right);
        let mut pressure_step = 0.0;
        if let Control::Volume(_) = control {
            let along =
                |step: &[f64]| -> f64 { self.forces.by_pressure.iter().zip(step).map(|(a, b)| a * b).sum() };
            let (step, slope) = right.split_at_mut(dimension);
            pressure_step = (volume_gap - along(step)) / along(slope);
            for (step, slope) in step.iter_mut().zip(slope) {
                *step += pressure_step * *slope;
            }
        }
        (self.motion(state, &right[..dimension], true), pressure_step)
    }
}
