use super::{
    element::{BULK_RATIO, Element},
    kinematics::{
        Point, Rows, STRETCH, UNKNOWNS, add_determinant_tangent, cofactor, deformation_gradient,
        enclosed_volume, fibre_stretch, pull_back,
    },
    mesh::Grid,
    system::System,
};
use crate::material::{Hyperelastic, Rubber};
use actuator::{FibreLaw, Free};
use nalgebra::Vector3;

/// Marks a nodal value that is held at zero.
pub(crate) const HELD: usize = usize::MAX;

/// The section of one FREE (right-handed) in units of its outer radius B and its mu: pressures and stresses in mu, forces in
/// mu B^2, torques in mu B^3, energies per length in mu B^2.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    pub grid: Grid,
    material: Rubber,
    /// k B, turn of the fibre per length.
    pub turn: f64,
    /// Energy of the fibres is `fibre_weight` integral of (stretch - 1)^2/2 over the covered angles of one piece.
    fibre_weight: f64,
    fibre_law: FibreLaw,
    pub elements: Vec<Element>,
    /// Unknown of each nodal value (3 a node: r, phi, w), or [`HELD`].
    pub unknown: Vec<usize>,
    pub order: usize,
    pub bandwidth: usize,
}

/// Everything that describes a state of the section.
#[derive(Clone, Debug)]
pub(crate) struct State {
    /// r, phi, w at each node.
    pub nodes: Vec<f64>,
    /// Pressure in the rubber (tension positive) of each element.
    pub multipliers: Vec<[f64; 3]>,
    /// Lambda, psi, gauge pressure.
    pub globals: [f64; 3],
}

impl State {
    /// Adds `factor` times the difference of two states, `to - from`.
    pub fn add_difference(&mut self, from: &State, to: &State, factor: f64) {
        let add = |values: &mut [f64], from: &[f64], to: &[f64]| {
            for ((value, a), b) in values.iter_mut().zip(from).zip(to) {
                *value += factor * (b - a);
            }
        };
        add(&mut self.nodes, &from.nodes, &to.nodes);
        add(
            self.multipliers.as_flattened_mut(),
            from.multipliers.as_flattened(),
            to.multipliers.as_flattened(),
        );
        add(&mut self.globals, &from.globals, &to.globals);
    }
}

/// A radius or the volume ratio is not positive somewhere, or a number is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inverted;

impl Problem {
    pub fn new(free: &Free, grid: Grid) -> Self {
        let outer = free.tube.outer_radius();
        let last_line = grid.angles.len() - 1;
        let lines = grid.radii.len();
        let unique =
            |node: usize| if grid.periodic && node / lines == last_line { node % lines } else { node };
        let mut elements = Vec::new();
        for i in 0..grid.elements_around() {
            for j in 0..grid.elements_through() {
                elements.push(Element::new(&grid, i, j, unique));
            }
        }
        // phi and w change sign in the half turn about a fibre's middle and about the middle between two: they vanish on
        // both lines. A whole pitch holds one node instead, against turning and sliding as a rigid body.
        let held = |node: usize| match grid.periodic {
            true => node == 0,
            false => node / lines == 0 || node / lines == last_line,
        };
        let mut unknown = vec![HELD; 3 * grid.nodes()];
        let mut order = 0;
        for node in (0..grid.nodes()).filter(|node| unique(*node) == *node) {
            for component in 0..3 {
                if component == 0 || !held(node) {
                    unknown[3 * node + component] = order;
                    order += 1;
                }
            }
        }
        let bandwidth = elements
            .iter()
            .map(|element| {
                let all =
                    element.nodes.iter().flat_map(|node| unknown[3 * node..3 * node + 3].iter().copied());
                let known = || all.clone().filter(|index| *index != HELD);
                known().max().unwrap_or(0) - known().min().unwrap_or(0)
            })
            .max()
            .unwrap_or(0);
        let fibre = free.winding.fibre;
        let turn = outer * free.winding.turn_per_length(outer);
        let stiffness = fibre.axial_stiffness / (free.elastomer.shear_modulus() * outer * outer);
        Problem {
            material: Rubber::from(free.elastomer.with_shear_modulus(1.0)),
            turn,
            // EA times the fibre's length per tube length, shared by the angle it covers.
            fibre_weight: stiffness * turn.hypot(1.0) / (2.0 * grid.half_footprint),
            fibre_law: fibre.law,
            elements,
            unknown,
            order,
            bandwidth,
            grid,
        }
    }

    /// The unloaded section.
    pub fn rest(&self) -> State {
        let mut nodes = vec![0.0; 3 * self.grid.nodes()];
        for around in 0..self.grid.angles.len() {
            for (through, radius) in self.grid.radii.iter().enumerate() {
                nodes[3 * self.grid.node(around, through)] = *radius;
            }
        }
        State { nodes, multipliers: vec![[0.0; 3]; self.elements.len()], globals: [1.0, 0.0, 0.0] }
    }

    fn gather(&self, element: &Element, nodes: &[f64], globals: &[f64; 3]) -> [f64; UNKNOWNS] {
        let mut values = [0.0; UNKNOWNS];
        for (n, node) in element.nodes.iter().enumerate() {
            values[3 * n..3 * n + 3].copy_from_slice(&nodes[3 * node..3 * node + 3]);
        }
        values[STRETCH..].copy_from_slice(&globals[..2]);
        values
    }

    /// Linearises the equations at a state.
    pub fn linearise(&self, state: &State, system: &mut System) -> Result<(), Inverted> {
        system.clear();
        let pressure = state.globals[2];
        for (index, element) in self.elements.iter().enumerate() {
            let values = self.gather(element, &state.nodes, &state.globals);
            let q = Vector3::from(state.multipliers[index]);
            let mut gradient = [0.0; UNKNOWNS];
            let mut volume_gradient = [0.0; UNKNOWNS];
            let mut hessian: Rows<UNKNOWNS> = [[0.0; 32]; UNKNOWNS];
            let rows = &mut system.rows[index];
            rows.by_unknown = [[0.0; 32]; 3];
            rows.values = -(element.mass * q) / BULK_RATIO;
            for point in &element.points {
                let y = point.local(&values);
                let f = deformation_gradient(&y, point.radius, self.turn);
                let dilation = f.determinant() - 1.0;
                // A tenth of the volume is far outside what any converged state has, and well inside what can be computed.
                if !(y[0] > 0.0 && dilation > -0.9 && dilation < 10.0) {
                    return Err(Inverted);
                }
                let mut answer = self.material.answer(&f);
                let linear = Vector3::from(point.linear);
                let local_q = linear.dot(&q);
                rows.values += point.weight * dilation * linear;
                let normal = cofactor(&f);
                let mut by_volume = answer;
                by_volume.stress = normal;
                answer.stress += local_q * normal;
                add_determinant_tangent(&f, local_q, &mut answer.tangent);
                let (mut local_gradient, mut local_hessian) = pull_back(&y, point.radius, self.turn, &answer);
                scale(point.weight, &mut local_gradient, &mut local_hessian);
                point.add_gradient(&local_gradient, &mut gradient);
                point.add_hessian(&local_hessian, &mut hessian);
                system.energy += point.weight * answer.energy;

                let (dilation_gradient, _) = pull_back(&y, point.radius, self.turn, &by_volume);
                let mut by_unknown = [0.0; UNKNOWNS];
                point.add_gradient(&dilation_gradient, &mut by_unknown);
                for (row, n) in rows.by_unknown.iter_mut().zip(point.linear) {
                    for (entry, value) in row.iter_mut().zip(by_unknown) {
                        *entry += point.weight * n * value;
                    }
                }
            }
            system.energy += q.dot(&(rows.values + element.mass * q / (2.0 * BULK_RATIO)));
            if element.under_fibre && self.fibre_weight > 0.0 {
                for point in &element.surface {
                    let y = point.local(&values);
                    let (stretch, mut by_local, mut second) = fibre_stretch(&y, self.turn);
                    let strain = stretch - 1.0;
                    if strain < 0.0 && self.fibre_law == FibreLaw::TensionOnly {
                        continue;
                    }
                    // E = strain^2/2: dE = strain ds, d2E = ds ds + strain d2s.
                    for i in 0..9 {
                        for j in 0..9 {
                            second[i][j] = strain * second[i][j] + by_local[i] * by_local[j];
                        }
                    }
                    by_local.iter_mut().for_each(|value| *value *= strain);
                    let weight = self.fibre_weight * point.weight;
                    scale(weight, &mut by_local, &mut second);
                    point.add_gradient(&by_local, &mut gradient);
                    point.add_hessian(&second, &mut hessian);
                    system.energy += 0.5 * weight * strain * strain;
                }
            }
            for point in &element.bore {
                let y = point.local(&values);
                let (volume, mut by_local, mut second) = enclosed_volume(&y, self.turn);
                system.volume += point.weight * volume;
                scale(point.weight, &mut by_local, &mut second);
                point.add_gradient(&by_local, &mut volume_gradient);
                second.iter_mut().flatten().for_each(|value| *value *= -pressure);
                point.add_hessian(&second, &mut hessian);
            }
            system.accumulate(self, element, index, pressure, gradient, volume_gradient, hessian);
        }
        system.energy -= pressure * system.volume;
        if system.energy.is_finite() { Ok(()) } else { Err(Inverted) }
    }

    /// Radius of the circle that has the area of the section inside the outer surface, in units of B.
    pub fn expansion(&self, state: &State) -> f64 {
        let volume = self.volume_inside(state, |element| &element.surface);
        // A cut at constant z meets one reference length in every lambda of height.
        (volume / (std::f64::consts::PI * state.globals[0])).sqrt()
    }

    /// Enclosed volume per reference length, in units of B^2.
    pub fn volume(&self, state: &State) -> f64 {
        self.volume_inside(state, |element| &element.bore)
    }

    fn volume_inside(&self, state: &State, points: impl Fn(&Element) -> &[Point]) -> f64 {
        let mut volume = 0.0;
        for element in &self.elements {
            let values = self.gather(element, &state.nodes, &state.globals);
            for point in points(element) {
                volume += point.weight * enclosed_volume(&point.local(&values), self.turn).0;
            }
        }
        volume
    }

    /// Adds `factor` times a step to a state.
    pub fn advance(&self, state: &mut State, step: &Step, factor: f64) {
        for (value, unknown) in state.nodes.iter_mut().zip(&self.unknown) {
            if *unknown != HELD {
                *value += factor * step.inner[*unknown];
            }
        }
        if self.grid.periodic {
            let (line, all) = (3 * self.grid.radii.len(), state.nodes.len());
            state.nodes.copy_within(..line, all - line);
        }
        for (value, change) in state.multipliers.iter_mut().flatten().zip(step.multipliers.iter().flatten()) {
            *value += factor * change;
        }
        for (value, change) in state.globals.iter_mut().zip(step.globals) {
            *value += factor * change;
        }
    }

    /// The elements' pressures that go with a change of the unknowns; `equations` says whether their volume equations are to
    /// be met as well (a Newton step) or are met already (a tangent).
    pub fn complete(&self, system: &System, step: &mut Step, equations: bool) {
        for (index, element) in self.elements.iter().enumerate() {
            let rows = &system.rows[index];
            let mut values = if equations { rows.values } else { Vector3::zeros() };
            let change = |n: usize, component: usize| match self.unknown[3 * element.nodes[n] + component] {
                HELD => 0.0,
                unknown => step.inner[unknown],
            };
            for a in 0..3 {
                let row = &rows.by_unknown[a];
                for n in 0..9 {
                    for component in 0..3 {
                        values[a] += row[3 * n + component] * change(n, component);
                    }
                }
                values[a] += row[STRETCH] * step.globals[0] + row[STRETCH + 1] * step.globals[1];
            }
            step.multipliers[index] = (element.bulk * values).into();
        }
    }
}

/// A change of a state.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub inner: Vec<f64>,
    pub multipliers: Vec<[f64; 3]>,
    pub globals: [f64; 3],
}

impl Step {
    pub fn new(problem: &Problem) -> Self {
        Step {
            inner: vec![0.0; problem.order],
            multipliers: vec![[0.0; 3]; problem.elements.len()],
            globals: [0.0; 3],
        }
    }
}

fn scale(factor: f64, gradient: &mut [f64; 9], hessian: &mut [[f64; 9]; 9]) {
    gradient.iter_mut().for_each(|value| *value *= factor);
    hessian.iter_mut().flatten().for_each(|value| *value *= factor);
}
