use super::{
    banded::Banded,
    kinematics::{
        Point, Rows, STRETCH, UNKNOWNS, add_determinant_tangent, cofactor, deformation_gradient,
        enclosed_volume, fibre_stretch, pull_back,
    },
    mesh::Grid,
};
use crate::material::{Hyperelastic, Rubber};
use actuator::{FibreLaw, Free};
use nalgebra::{Matrix3, Vector3};

/// Bulk modulus over the rubber's mu. The answer differs from that of an incompressible wall by about pressure/bulk modulus,
/// a few 1e-6 in stretch, while the equations keep ten digits.
const BULK_RATIO: f64 = 1e5;

/// Abscissas and weights of Gauss's rule of three points on (-1, 1).
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Marks a nodal value that is held at zero.
const HELD: usize = usize::MAX;

/// A nine-node quadrilateral with a linear pressure of its own.
#[derive(Clone, Debug)]
struct Element {
    nodes: [usize; 9],
    points: Vec<Point>,
    /// Points on the bore, for elements that touch it.
    bore: Vec<Point>,
    /// Points on the outer surface, for elements that touch it.
    surface: Vec<Point>,
    /// Whether the surface lies under a fibre.
    under_fibre: bool,
    /// Reference volume.
    volume: f64,
    /// M_ab, the integral of the products of the pressure functions.
    mass: Matrix3<f64>,
    /// Bulk modulus times the inverse of M.
    bulk: Matrix3<f64>,
}

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
    elements: Vec<Element>,
    /// Unknown of each nodal value (3 a node: r, phi, w), or [`HELD`].
    unknown: Vec<usize>,
    pub order: usize,
    bandwidth: usize,
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

/// The equations linearised at a state, with lambda, psi and the pressure as a border.
///
/// The potential is P = W + q.g - q.M q/(2 K) - p V with g the integral of (J - 1) times the pressure functions; P is
/// stationary in the nodal values and q. The q are condensed element by element.
#[derive(Clone, Debug)]
pub(crate) struct System {
    pub stiffness: Banded,
    /// dP/d(unknown).
    pub residual: Vec<f64>,
    /// The same after condensing the q, which vanishes with `residual` and `dilation`.
    pub right: Vec<f64>,
    /// Sum of the magnitudes of the elements' shares in `residual`.
    magnitude: Vec<f64>,
    /// Second derivatives by an unknown and by lambda, psi, p.
    pub columns: [Vec<f64>; 3],
    /// Second derivatives by lambda, psi, p.
    pub corner: [[f64; 3]; 3],
    /// dP/dlambda and dP/dpsi.
    pub global_residual: [f64; 2],
    /// The same after condensing the q.
    pub global_right: [f64; 2],
    /// P.
    pub energy: f64,
    /// Enclosed volume per length.
    pub volume: f64,
    /// Largest mean of an element's volume equation: how far the volume is from what the pressure says.
    pub dilation: f64,
    rows: Vec<VolumeRows>,
}

/// An element's volume equations: derivatives by its unknowns, and values.
#[derive(Clone, Debug)]
struct VolumeRows {
    by_unknown: Rows<3>,
    values: Vector3<f64>,
}

/// A radius or the volume ratio is not positive somewhere, or a number is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inverted;

fn lagrange(at: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * at * (at - 1.0), 1.0 - at * at, 0.5 * at * (at + 1.0)], [at - 0.5, -2.0 * at, at + 0.5])
}

/// Shape functions at local coordinates (around, through) in -1..1 of the element between the given lines of nodes.
fn point(angles: &[f64], radii: &[f64], around: f64, through: f64, weight: f64) -> Point {
    let (half_angle, half_width) = (0.5 * (angles[2] - angles[0]), 0.5 * (radii[2] - radii[0]));
    let ((na, da), (nr, dr)) = (lagrange(around), lagrange(through));
    let each = |f: &dyn Fn(usize, usize) -> f64| std::array::from_fn(|node| f(node / 3, node % 3));
    Point {
        radius: radii[1] + half_width * through,
        weight,
        values: each(&|i, j| na[i] * nr[j]),
        by_radius: each(&|i, j| na[i] * dr[j] / half_width),
        by_angle: each(&|i, j| da[i] * nr[j] / half_angle),
        linear: [1.0, around, through],
    }
}

impl Element {
    fn new(grid: &Grid, i: usize, j: usize, unique: impl Fn(usize) -> usize) -> Self {
        let angles = &grid.angles[2 * i..2 * i + 3];
        let radii = &grid.radii[2 * j..2 * j + 3];
        let (half_angle, half_width) = (0.5 * (angles[2] - angles[0]), 0.5 * (radii[2] - radii[0]));
        let mut points = Vec::with_capacity(9);
        for (around, wa) in GAUSS {
            for (through, wt) in GAUSS {
                let mut point = point(angles, radii, around, through, 0.0);
                point.weight = grid.pieces * wa * half_angle * wt * half_width * point.radius;
                points.push(point);
            }
        }
        let edge = |through: f64, touches: bool| -> Vec<Point> {
            let points =
                GAUSS.iter().map(|&(a, w)| point(angles, radii, a, through, grid.pieces * w * half_angle));
            if touches { points.collect() } else { Vec::new() }
        };
        let mass = points.iter().fold(Matrix3::zeros(), |sum, point| {
            let n = Vector3::from(point.linear);
            sum + point.weight * n * n.transpose()
        });
        Element {
            nodes: std::array::from_fn(|n| unique(grid.node(2 * i + n / 3, 2 * j + n % 3))),
            bore: edge(-1.0, j == 0),
            surface: edge(1.0, j + 1 == grid.elements_through()),
            under_fibre: grid.under_fibre[i],
            volume: mass[(0, 0)],
            mass,
            // The mass is positive definite: a Gram matrix of independent functions.
            bulk: BULK_RATIO * mass.try_inverse().unwrap_or_default(),
            points,
        }
    }
}

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

    pub fn system(&self) -> System {
        System {
            stiffness: Banded::new(self.order, self.bandwidth),
            residual: vec![0.0; self.order],
            right: vec![0.0; self.order],
            magnitude: vec![0.0; self.order],
            columns: std::array::from_fn(|_| vec![0.0; self.order]),
            corner: [[0.0; 3]; 3],
            global_residual: [0.0; 2],
            global_right: [0.0; 2],
            energy: 0.0,
            volume: 0.0,
            dilation: 0.0,
            rows: vec![
                VolumeRows { by_unknown: [[0.0; 32]; 3], values: Vector3::zeros() };
                self.elements.len()
            ],
        }
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
        let mut volume = 0.0;
        for element in &self.elements {
            let values = self.gather(element, &state.nodes, &state.globals);
            for point in &element.surface {
                volume += point.weight * enclosed_volume(&point.local(&values), self.turn).0;
            }
        }
        // A cut at constant z meets one reference length in every lambda of height.
        (volume / (std::f64::consts::PI * state.globals[0])).sqrt()
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

impl System {
    fn clear(&mut self) {
        self.stiffness.clear();
        for vector in [&mut self.residual, &mut self.right, &mut self.magnitude] {
            vector.fill(0.0);
        }
        self.columns.iter_mut().for_each(|column| column.fill(0.0));
        self.corner = [[0.0; 3]; 3];
        self.global_residual = [0.0; 2];
        self.global_right = [0.0; 2];
        (self.energy, self.volume, self.dilation) = (0.0, 0.0, 0.0);
    }

    /// Condenses an element's pressure and adds the element to the whole.
    #[allow(clippy::too_many_arguments)]
    fn accumulate(
        &mut self,
        problem: &Problem,
        element: &Element,
        index: usize,
        pressure: f64,
        mut gradient: [f64; UNKNOWNS],
        volume_gradient: [f64; UNKNOWNS],
        mut hessian: Rows<UNKNOWNS>,
    ) {
        // K du + B^T dq = -R and B du - M dq/K_bulk = -h give dq = K_bulk M^-1 (h + B du).
        let rows = &self.rows[index];
        self.dilation = self.dilation.max(rows.values.amax() / element.volume);
        let lifted = element.bulk * rows.values;
        let mut right = gradient;
        for a in 0..3 {
            let mut weighted = [0.0; 32];
            for b in 0..3 {
                for (entry, value) in weighted.iter_mut().zip(&rows.by_unknown[b]) {
                    *entry += element.bulk[(a, b)] * value;
                }
            }
            for i in 0..UNKNOWNS {
                let value = rows.by_unknown[a][i];
                right[i] += lifted[a] * value;
                for (entry, other) in hessian[i].iter_mut().zip(&weighted) {
                    *entry += value * other;
                }
            }
        }
        for i in 0..UNKNOWNS {
            gradient[i] -= pressure * volume_gradient[i];
            right[i] -= pressure * volume_gradient[i];
        }

        let unknown = |i: usize| problem.unknown[3 * element.nodes[i / 3] + i % 3];
        for i in (0..STRETCH).filter(|i| unknown(*i) != HELD) {
            let row = unknown(i);
            self.residual[row] += gradient[i];
            self.right[row] += right[i];
            self.magnitude[row] += gradient[i].abs() + (pressure * volume_gradient[i]).abs();
            self.columns[0][row] += hessian[i][STRETCH];
            self.columns[1][row] += hessian[i][STRETCH + 1];
            self.columns[2][row] -= volume_gradient[i];
            for (j, value) in hessian[i][..STRETCH].iter().enumerate() {
                let column = unknown(j);
                if column <= row {
                    self.stiffness.add(row, column, *value);
                }
            }
        }
        for a in 0..2 {
            let i = STRETCH + a;
            self.global_residual[a] += gradient[i];
            self.global_right[a] += right[i];
            self.corner[a][0] += hessian[i][STRETCH];
            self.corner[a][1] += hessian[i][STRETCH + 1];
            self.corner[a][2] -= volume_gradient[i];
            self.corner[2][a] -= volume_gradient[i];
        }
    }

    /// Norm of the residual over that of the elements' shares in it; forces below
    /// 1e-3 mu B^2 (a pressure of some 1e-4 mu) are measured against that.
    pub fn relative_residual(&self) -> f64 {
        let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
        norm(&self.residual) / (norm(&self.magnitude) + 1e-3)
    }
}
