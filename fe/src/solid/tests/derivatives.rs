//! Residual, tangent and gradient of the volume of the assembled body against differences of energy and residual.

use super::{noise, specimen, winding};
use crate::solid::{
    Coat, SolidLoad, SolidMesh, Specimen,
    assembly::Forces,
    body::Body,
    shape::Shape,
    state::{SolidState, motion_of},
};
use actuator::{Elastomer, Handedness};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};

/// A body in a state far from rest and from equilibrium.
pub struct Case {
    pub body: Body,
    pub state: SolidState,
    pub load: SolidLoad,
    /// Mass of rubber at each point, kg.
    masses: Vec<f64>,
}

impl Case {
    /// Bent and twisted along the length by `turn` (rad) at the cap, roughened, with pressures in the elements.
    pub fn new(specimen: &Specimen, mesh: SolidMesh, sectors: usize, turn: Vector3<f64>) -> Self {
        let body = Body::new(specimen, mesh, sectors).unwrap();
        let mut state = body.rest();
        let length = specimen.tube.length;
        let roughness = 4e-5;
        let mut middle = Vector3::zeros();
        let mut before = 0.0;
        let each = body.grid.lines[0] * body.grid.lines[1];
        for (p, at) in body.grid.points.iter().enumerate() {
            let z = at[2];
            let rotation = UnitQuaternion::from_scaled_axis(turn * (z / length));
            if p % each == 0 {
                middle += rotation * Vector3::new(0.0, 0.0, 1.05 * (z - before));
                before = z;
            }
            let shake = Vector3::from_fn(|i, _| roughness * noise(3 * p + i));
            state.positions[p] =
                (middle + rotation * Vector3::new(1.04 * at[0], 1.04 * at[1], 0.0) + shake).into();
        }
        state.cap = middle;
        state.cap_rotation = UnitQuaternion::from_scaled_axis(turn);
        body.settle(&mut state);
        for (e, q) in state.pressures.iter_mut().enumerate() {
            *q = std::array::from_fn(|i| 2e4 * noise(90_000 + 4 * e + i));
        }
        let load = SolidLoad {
            pressure: 6e4,
            force: Vector3::new(0.3, -0.2, 0.5),
            gravity: Vector3::new(3.0, -5.0, 8.0),
            ..SolidLoad::default()
        };
        let mut masses = vec![0.0; body.grid.points.len()];
        for place in body.grid.element_places() {
            let points = body.grid.element_points(place);
            let shape = Shape::new(&points.map(|p| body.grid.points[p as usize]), 0).unwrap();
            for (share, p) in shape.shares.iter().zip(points) {
                masses[p as usize] += specimen.density * share;
            }
        }
        Case { body, state, load, masses }
    }

    /// Four fibres along the mesh and three across, eccentric bore, growing wall; the cap turned by more than 180 degrees.
    pub fn whole() -> Self {
        let windings = [winding(50.0, Handedness::Right, 4, 0.4e-3), winding(60.0, Handedness::Left, 3, 0.0)];
        let specimen = Specimen {
            bore_offset: [[1e-4, -1.5e-4], [2e-4, 1e-4]],
            wall_taper: 1.1,
            cap_mass: 0.02,
            ..specimen(0.03, &windings, 50.0)
        };
        Self::new(&specimen, SolidMesh::new(8, 4), 1, Vector3::new(0.5, -0.7, 3.4))
    }

    /// One of three sectors, with a coat.
    fn sector() -> Self {
        let coat = Coat { thickness: 0.4e-3, elastomer: Elastomer::NeoHookean { shear_modulus: 0.2e6 } };
        let windings = [winding(50.0, Handedness::Right, 3, 0.4e-3)];
        let specimen = Specimen { coat: Some(coat), ..specimen(0.015, &windings, 50.0) };
        let mut case = Self::new(&specimen, SolidMesh::new(12, 3), 3, Vector3::new(0.0, 0.0, 1.2));
        case.load.force = Vector3::new(0.0, 0.0, 0.5);
        case.load.gravity = Vector3::new(0.0, 0.0, 8.0);
        case
    }

    /// The state after a step of the unknowns from the one assembled last; elements' pressures follow if asked to.
    fn moved(&self, step: &[f64], with_pressures: bool) -> SolidState {
        let (displacements, cap) = self.body.displacements(&self.state, step);
        let mut motion = motion_of(&self.body.grid, &self.state, &displacements);
        motion.cap = cap;
        if with_pressures {
            motion.pressures = self.body.pressure_steps(&displacements, false);
        }
        let mut next = self.state.moved(&self.body.grid, &motion);
        self.body.settle(&mut next);
        next
    }

    /// Energy less the work of the loads.
    fn potential(&self, state: &SolidState, forces: &Forces) -> f64 {
        let share = 1.0 / self.body.grid.sectors as f64;
        let weight = self.load.force + self.body.specimen.cap_mass * self.load.gravity;
        let gravity: f64 = state
            .positions
            .iter()
            .zip(&self.masses)
            .map(|(x, mass)| mass * self.load.gravity.dot(&Vector3::from(*x)))
            .sum();
        forces.energy - self.load.pressure * forces.volume - share * weight.dot(&state.cap) - gravity
    }

    /// What acts on the points with unknowns of their own and on the cap, in space, of forces on the unknowns at the state that
    /// was assembled last.
    pub fn in_space(&self, state: &SolidState, forces: &[f64]) -> Vec<Vector3<f64>> {
        let grid = &self.body.grid;
        let (points, cap) = self.body.displacements(state, forces);
        let own = |p: &usize| {
            let plane = grid.plane(*p);
            plane > 0 && plane + 1 < grid.lines[2] && grid.master(*p).is_none()
        };
        (0..points.len()).filter(own).map(|p| Vector3::from(points[p])).chain(cap).collect()
    }
}

/// Step of an unknown: m or rad.
fn unit(case: &Case, unknown: usize, step: f64) -> Vec<f64> {
    let mut vector = vec![0.0; case.body.pattern.dimension()];
    vector[unknown] = if unknown >= case.body.cap_unknown + 3 { step / 5e-3 } else { step };
    vector
}

fn check(mut case: Case) {
    let (state, load) = (case.state.clone(), case.load);
    let dimension = case.body.pattern.dimension();
    let mut forces = Forces::default();
    case.body.assemble(&state, &load, true, &mut forces).unwrap();
    let base = forces.clone();
    // Errors: truncation (h/size)^2 of 1e-10, rounding 1e-16 size/h of 1e-11, times what energy and forces lose by cancelling.
    let h = 3e-8;
    let moments = case.in_space(&state, &base.residual).pop().unwrap();
    let mut expected = vec![];
    let mut neighbours = vec![];
    for unknown in 0..dimension {
        let step = unit(&case, unknown, 1.0);
        let mut product = vec![0.0; dimension];
        case.body.pattern.multiply_into(&case.body.values, &step, &mut product);
        let mut product = case.in_space(&state, &product);
        // The tangent is the second derivative by turns exp(w), symmetric; the moments' own change under a turn has beside it half
        // their cross product, which vanishes in equilibrium.
        let (_, [_, turn]) = case.body.displacements(&state, &step);
        *product.last_mut().unwrap() -= 0.5 * moments.cross(&turn);
        expected.push(product);
        let moves = [h, -h].map(|h| {
            let step = unit(&case, unknown, h);
            [case.moved(&step, false), case.moved(&step, true)]
        });
        neighbours.push(moves);
    }
    // By force or moment over radius, and by stiffness.
    let scale = base.residual.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let volume_scale = base.by_pressure.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let mut worst = [0.0f64; 3];
    for unknown in 0..dimension {
        let size = unit(&case, unknown, 1.0)[unknown];
        let mut at = |side: usize| {
            let [still, followed] = &neighbours[unknown][side];
            case.body.assemble(still, &load, false, &mut forces).unwrap();
            let sums = (case.potential(still, &forces), forces.volume);
            case.body.assemble(followed, &load, false, &mut forces).unwrap();
            (sums, case.in_space(followed, &forces.residual))
        };
        let (plus, minus) = (at(0), at(1));
        let slope = |plus: f64, minus: f64| (plus - minus) / (2.0 * h);
        let force = slope(plus.0.0, minus.0.0) - size * base.residual[unknown];
        let area = slope(plus.0.1, minus.0.1) - size * base.by_pressure[unknown];
        worst[0] = worst[0].max(force.abs() / scale);
        worst[1] = worst[1].max(area.abs() / volume_scale);
        let stiffest = expected[unknown].iter().fold(0.0f64, |most, force| most.max(force.amax()));
        for ((plus, minus), expected) in plus.1.iter().zip(&minus.1).zip(&expected[unknown]) {
            let error = ((plus - minus) / (2.0 * h) - expected).amax() / stiffest;
            worst[2] = worst[2].max(error);
        }
    }
    println!(
        "{dimension} unknowns: residual {:.1e}, volume {:.1e}, tangent {:.1e}",
        worst[0], worst[1], worst[2]
    );
    assert!(worst[0] < 2e-7 && worst[1] < 1e-8 && worst[2] < 2e-7, "{worst:?}");
}

#[test]
fn residual_and_tangent_of_the_body_are_derivatives() {
    check(Case::whole());
}

#[test]
fn residual_and_tangent_of_a_sector_are_derivatives() {
    check(Case::sector());
}

#[test]
fn equal_sectors_make_the_whole() {
    let windings = [winding(50.0, Handedness::Right, 3, 0.4e-3)];
    let specimen = specimen(0.015, &windings, 50.0);
    let load = SolidLoad { pressure: 3e4, force: Vector3::new(0.0, 0.0, 0.4), ..SolidLoad::default() };
    let [whole, sector] = [1, 3].map(|sectors| {
        let mut body = Body::new(&specimen, SolidMesh::new(12, 3), sectors).unwrap();
        let mut state = body.rest();
        for (p, at) in body.grid.points.iter().enumerate() {
            let (turn, scale) = (Rotation3::from_axis_angle(&Vector3::z_axis(), 40.0 * at[2]), 1.05);
            state.positions[p] = (turn * Vector3::new(scale * at[0], scale * at[1], 1.1 * at[2])).into();
        }
        state.cap.z *= 1.1;
        state.cap_rotation = UnitQuaternion::from_scaled_axis(Vector3::z() * 40.0 * 0.015);
        body.settle(&mut state);
        let mut forces = Forces::default();
        body.assemble(&state, &load, true, &mut forces).unwrap();
        let cap = body.displacements(&state, &forces.residual).1;
        [forces.energy, forces.volume, cap[0].z, cap[1].z]
    });
    for (whole, sector) in whole.into_iter().zip(sector) {
        assert!((whole - 3.0 * sector).abs() < 1e-11 * whole.abs(), "{whole} {sector}");
    }
}
