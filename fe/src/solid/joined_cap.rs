//! A solid whose cap something else moves, a plate that several solids share: what the cap feels, and what the inside does.

use super::{
    fibre::ForeseenTensions,
    newton::{Lost, SolidSolver},
    state::{Motion, Planes, SolidLoad, SolidState},
};
use crate::rigid_motion::Frame;
use nalgebra::{Matrix6, Vector3, Vector6};

/// Sums over a solid in a configuration, as its cap feels them. Forces and moments are in the cap's own frame, about its middle.
#[derive(Clone, Debug)]
pub(crate) struct CapForces {
    /// Internal less external forces on the cap: what must act on it to hold it there.
    pub residual: Vector6<f64>,
    /// Relative residual of the inside.
    pub error: f64,
    /// What forces are relative to, N.
    pub scale: f64,
    /// Strain energy less pressure times enclosed volume less the work of the weight, J.
    pub energy: f64,
}

/// The tangent of a solid with its inside eliminated. K is the tangent, c the cap's motions (shift, turn; in its own frame), i the inside's.
pub(crate) struct CapResponse {
    /// S = K_cc - K_ci K_ii^-1 K_ic.
    pub stiffness: Matrix6<f64>,
    /// Forces on the cap per pressure, the inside in equilibrium, m^2.
    pub by_pressure: Vector6<f64>,
    /// Negative eigenvalues of K_ii.
    pub negative: u32,
    /// K times a unit of each motion of the cap, one after the other.
    couplings: Vec<f64>,
    /// K_ii^-1 K_ic, one column after the other.
    follows: Vec<f64>,
    /// K_ii^-1 b_i, b the forces per pressure.
    pressed: Vec<f64>,
}

/// What the inside does of itself in a step of Newton's method, and what the cap feels then.
pub(crate) struct InnerStep {
    /// Residual on the cap once the inside has made its step.
    pub residual: Vector6<f64>,
    /// -K_ii^-1 r_i.
    own: Vec<f64>,
}

/// A motion, and the displacements of all points (m) that it is in first order.
pub(crate) struct CarriedMotion {
    motion: Motion,
    displacements: Vec<[f64; 3]>,
}

fn six(values: &[f64]) -> Vector6<f64> {
    Vector6::from_column_slice(values)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl CapResponse {
    /// K_ci times a step of the inside.
    fn on_cap(&self, step: &[f64]) -> Vector6<f64> {
        let inside = step.len() - 6;
        let mut columns = self.couplings.chunks_exact(step.len());
        Vector6::from_fn(|_, _| columns.next().map_or(0.0, |column| dot(&column[..inside], &step[..inside])))
    }

    /// `step` and what the inside does when the cap makes `motion`.
    pub(crate) fn following(&self, mut step: Vec<f64>, motion: &Vector6<f64>) -> Vec<f64> {
        let dimension = step.len();
        for (column, by) in self.follows.chunks_exact(dimension).zip(motion.iter()) {
            step.iter_mut().zip(column).for_each(|(value, follow)| *value -= by * follow);
        }
        step[dimension - 6..].copy_from_slice(motion.as_slice());
        step
    }
}

impl SolidSolver {
    /// The load under which a plate carries the cap, in the solver's terms: free, so that its unknowns are in its own frame.
    pub(crate) fn joined_load(pressure: f64, gravity: Vector3<f64>) -> SolidLoad {
        SolidLoad { gravity, ..SolidLoad::pressure(pressure) }
    }

    /// Assembles a configuration whose cap is carried.
    pub(crate) fn cap_forces(&mut self, state: &SolidState, with_tangent: bool) -> Result<CapForces, Lost> {
        self.assemble(state, with_tangent)?;
        let cap = self.body.cap_unknown;
        Ok(CapForces {
            residual: six(&self.forces.residual[cap..]),
            error: self.relative(&|index| index < cap),
            scale: self.force_scale(),
            energy: self.forces.energy
                - state.load.pressure * self.forces.volume
                - self.body.weight_work(state),
        })
    }

    /// Eliminates the inside of the configuration assembled last, with its tangent: one factorisation, seven substitutions.
    pub(crate) fn cap_response(&mut self) -> Result<CapResponse, Lost> {
        let (dimension, cap) = (self.unknowns(), self.body.cap_unknown);
        let mut couplings = Vec::with_capacity(6 * dimension);
        for direction in 0..6 {
            let mut unit = [0.0; 6];
            unit[direction] = 1.0;
            couplings.extend(self.tangent_times_cap(&unit));
        }
        self.factorise([true; 6])?;
        let mut follows = couplings.clone();
        follows.extend(&self.forces.by_pressure);
        for column in follows.chunks_exact_mut(dimension) {
            column[cap..].fill(0.0);
        }
        self.substitute(&mut follows);
        let pressed = follows.split_off(6 * dimension);
        let negative = self.inertia.map_or(0, |inertia| inertia.negative) as u32;
        let mut response = CapResponse {
            stiffness: Matrix6::zeros(),
            by_pressure: six(&self.forces.by_pressure[cap..]),
            negative,
            couplings,
            follows,
            pressed,
        };
        response.by_pressure -= response.on_cap(&response.pressed);
        for direction in 0..6 {
            let range = direction * dimension..(direction + 1) * dimension;
            let direct = six(&response.couplings[range.clone()][cap..]);
            let column = direct - response.on_cap(&response.follows[range]);
            response.stiffness.set_column(direction, &column);
        }
        // What rounding leaves.
        response.stiffness = (response.stiffness + response.stiffness.transpose()) * 0.5;
        Ok(response)
    }

    /// Newton's step of the inside of the configuration assembled last, its cap at rest, by a response taken there or nearby.
    pub(crate) fn inner_step(&mut self, response: &CapResponse) -> InnerStep {
        let cap = self.body.cap_unknown;
        let mut own: Vec<f64> = self.forces.condensed.iter().map(|force| -force).collect();
        own[cap..].fill(0.0);
        self.substitute(&mut own);
        let residual = six(&self.forces.condensed[cap..]) + response.on_cap(&own);
        InnerStep { residual, own }
    }

    /// The motion in a step of Newton's method whose cap makes `motion`.
    pub(crate) fn newton_motion(
        &self,
        state: &SolidState,
        response: &CapResponse,
        step: &InnerStep,
        motion: &Vector6<f64>,
    ) -> CarriedMotion {
        self.carried_step(state, &response.following(step.own.clone(), motion), true)
    }

    /// First-order motion from an equilibrium assembled last when the pressure changes by `by_pressure` (Pa) and the cap makes `motion`.
    pub(crate) fn carried_motion(
        &self,
        state: &SolidState,
        response: &CapResponse,
        by_pressure: f64,
        motion: &Vector6<f64>,
    ) -> CarriedMotion {
        let step = response.pressed.iter().map(|pressed| by_pressure * pressed).collect();
        self.carried_step(state, &response.following(step, motion), false)
    }

    fn carried_step(&self, state: &SolidState, step: &[f64], with_mismatch: bool) -> CarriedMotion {
        let displacements = self.displacements(state, step);
        CarriedMotion { motion: self.motion(state, step, with_mismatch), displacements }
    }

    /// Adds springs between the inside's unknowns and where they are to the tangent assembled last, not yet eliminated: `spring` times a weight each.
    pub(crate) fn add_springs(&mut self, spring: f64, weights: &[f64]) {
        let body = &mut self.body;
        for block in 0..body.cap_block {
            let (place, first) = (body.pattern.place(block, block), body.pattern.first(block));
            for k in 0..body.pattern.size(block) {
                body.values[place.index(k, k)] += spring * weights[first + k];
            }
        }
    }

    /// What the inside answers to forces on it (columns of all unknowns, one after the other, changed in place to displacements), its cap at
    /// rest, by a response taken at the configuration assembled last; and what each makes the cap feel.
    pub(crate) fn inside_answer(&mut self, response: &CapResponse, columns: &mut [f64]) -> Vec<Vector6<f64>> {
        let (dimension, cap) = (self.unknowns(), self.body.cap_unknown);
        for column in columns.chunks_exact_mut(dimension) {
            column[cap..].fill(0.0);
        }
        self.substitute(columns);
        columns.chunks_exact(dimension).map(|column| response.on_cap(column)).collect()
    }

    /// Displacements of all points (m) for steps of the unknowns at the configuration assembled last.
    pub(crate) fn displacements(&self, state: &SolidState, step: &[f64]) -> Vec<[f64; 3]> {
        self.body.displacements(state, step).0
    }

    /// Takes the tangents that follow with the tensions of their own positions.
    pub(crate) fn forget_foreseen(&mut self) {
        self.body.foreseen = None;
    }

    /// The tangent assembled last, all of it; for tests.
    #[cfg(test)]
    pub(crate) fn dense_tangent(&self) -> nalgebra::DMatrix<f64> {
        let dimension = self.unknowns();
        let mut dense = nalgebra::DMatrix::zeros(dimension, dimension);
        let mut unit = vec![0.0; dimension];
        let mut column = vec![0.0; dimension];
        for index in 0..dimension {
            unit[index] = 1.0;
            column.fill(0.0);
            self.body.pattern.multiply_into(&self.body.values, &unit, &mut column);
            unit[index] = 0.0;
            dense.set_column(index, &nalgebra::DVector::from_column_slice(&column));
        }
        dense
    }

    /// Middle (m) and mean outer radius (m) of every plane of points across the tube, from base to tip.
    pub(crate) fn centreline(&self, state: &SolidState) -> Vec<(Vector3<f64>, f64)> {
        let Planes { middles, normals } = Planes::new(&self.body.grid, &state.positions);
        let [ni, nj, _] = self.body.grid.lines;
        let planes = state.positions.chunks_exact(ni * nj).zip(middles.iter().zip(&normals));
        let radius = |plane: &[[f64; 3]], middle: &Vector3<f64>, normal: &Vector3<f64>| {
            let outside = plane.iter().skip(ni - 1).step_by(ni);
            outside.map(|at| (Vector3::from(*at) - middle).cross(normal).norm()).sum::<f64>() / nj as f64
        };
        planes.map(|(plane, (middle, normal))| (*middle, radius(plane, middle, normal))).collect()
    }

    /// Outer radius of the tube, m.
    pub(crate) fn outer_radius(&self) -> f64 {
        self.body.specimen.tube.outer_radius()
    }

    /// The configuration after a part of a motion, its cap at `cap`: by what the cap's way there is not straight, all planes are shifted and
    /// turned along with it, each by its share of the length.
    /// Tangents that follow are taken with the tensions foreseen for it.
    pub(crate) fn carried(
        &mut self,
        state: &SolidState,
        motion: &CarriedMotion,
        part: f64,
        cap: &Frame,
    ) -> SolidState {
        let CarriedMotion { motion, displacements } = motion;
        let fibres = &self.body.fibres.elements;
        self.body.foreseen = Some(ForeseenTensions::new(fibres, &state.positions, displacements, part));
        let mut motion = motion.clone();
        motion.scale(part);
        let shift = cap.position - state.cap - motion.cap[0];
        let turn = (cap.rotation * state.cap_rotation.inverse()).scaled_axis() - motion.cap[1];
        let last = (motion.shifts.len() - 1) as f64;
        for (k, (plane, turned)) in motion.shifts.iter_mut().zip(&mut motion.turns).enumerate() {
            let share = k as f64 / last;
            *plane += shift * share;
            *turned += turn * share;
        }
        let mut next = state.moved(&self.body.grid, &motion);
        (next.cap, next.cap_rotation) = (cap.position, cap.rotation);
        self.body.settle(&mut next);
        next
    }
}
