//! Stability: against dense eigenvalues, Euler's column, limit pressures, and branches that cross.

use crate::solid::*;
use crate::sparse::BlockPattern;
use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use nalgebra::{DMatrix, SymmetricEigen, Vector3};
use std::f64::consts::PI;

const MODULUS: f64 = 0.393e6;

fn specimen(tube: Tube, fibres: u32, fibre_model: FibreModel) -> Specimen {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.3e-3, law: FibreLaw::Linear };
    let free = Free {
        tube,
        winding: Winding::from_hoop(60f64.to_radians(), Handedness::Right, fibres, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: MODULUS, alpha: 2.0, form: OgdenForm::InitialModulus },
    };
    Specimen { fibre_model, ..Specimen::from(&free) }
}

/// A slender column: inner radius 2 mm, wall 1 mm.
fn column(length: f64, around: usize, along: usize) -> SolidSolver {
    let specimen = specimen(Tube { length, inner_radius: 2e-3, wall: 1e-3 }, 0, FibreModel::Truss);
    SolidSolver::new(&specimen, SolidMesh::new(around, along)).unwrap()
}

/// The cap may shift sideways, not turn: pushed by a force.
fn pushed(force: f64) -> SolidLoad {
    SolidLoad {
        force: Vector3::new(0.0, 0.0, -force),
        held: [false, false, false, true, true, true],
        ..SolidLoad::default()
    }
}

/// The same, pushed down by a distance.
fn shortened(by: f64) -> SolidLoad {
    SolidLoad {
        displacement: Vector3::new(0.0, 0.0, -by),
        held: [false, false, true, true, true, true],
        ..SolidLoad::default()
    }
}

fn dense(pattern: &BlockPattern, values: &[f64]) -> DMatrix<f64> {
    let n = pattern.dimension();
    let mut matrix = DMatrix::zeros(n, n);
    let mut unit = vec![0.0; n];
    for j in 0..n {
        unit[j] = 1.0;
        pattern.multiply_into(values, &unit, matrix.column_mut(j).as_mut_slice());
        unit[j] = 0.0;
    }
    matrix
}

#[test]
fn signs_and_modes_are_those_of_the_dense_tangent() {
    let mut solver = column(0.1, 4, 3);
    let state = solver
        .follow(&solver.rest(), 0.0, &[0.25, 0.5, 0.75, 1.0], &|t| shortened(2e-3 * t), &mut |_, _| true)
        .unwrap();
    let found = solver.stability(&state, 4).unwrap();
    // Held motions are out: rows and columns of the unit matrix.
    let tangent = dense(&solver.body.pattern, &solver.body.values);
    let metric = solver.metric(&state);
    let scaled =
        DMatrix::from_fn(metric.len(), metric.len(), |i, j| tangent[(i, j)] / (metric[i] * metric[j]).sqrt());
    let mut values: Vec<f64> = SymmetricEigen::new(scaled).eigenvalues.iter().copied().collect();
    assert_eq!(found.negative, values.iter().filter(|value| **value < 0.0).count());
    assert!(found.negative >= 2, "the column has buckled to either side: {}", found.negative);
    values.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    for (mode, value) in found.modes.iter().zip(&values) {
        // The dense solver's error is that of its largest eigenvalue.
        assert!((mode.value - value).abs() < 1e-6 * value.abs() + 1e-9, "{} {value}", mode.value);
    }
    // dV/dp = b.K^-1 b.
    let mut b = solver.forces.by_pressure.clone();
    for direction in 2..6 {
        b[solver.body.cap_unknown + direction] = 0.0;
    }
    let b = nalgebra::DVector::from_vec(b);
    let compliance = b.dot(&tangent.clone().lu().solve(&b).unwrap());
    assert!((found.compliance / compliance - 1.0).abs() < 1e-7);
    // The constraint's border, by eigenvalues.
    let n = b.len();
    let scale = tangent.amax() / b.amax();
    let bordered = DMatrix::from_fn(n + 1, n + 1, |i, j| match (i == n, j == n) {
        (false, false) => tangent[(i, j)],
        (true, true) => 0.0,
        (true, false) => scale * b[j],
        (false, true) => scale * b[i],
    });
    let negative = SymmetricEigen::new(bordered).eigenvalues.iter().filter(|value| **value < 0.0).count();
    assert_eq!(found.negative_at_volume, negative - 1);
}

/// Critical force of a column, its ends kept from turning, over that of a beam with shear (Engesser).
fn critical_over_beam(length: f64, around: usize, along: usize) -> f64 {
    let mut solver = column(length, around, along);
    let tube = solver.body.specimen.tube;
    let (inner, outer) = (tube.inner_radius, tube.outer_radius());
    let area = PI * (outer.powi(2) - inner.powi(2));
    let bending = 3.0 * MODULUS * PI / 4.0 * (outer.powi(4) - inner.powi(4));
    let euler = bending * (PI / length).powi(2);
    // Cowper (1966), hollow circle, Poisson's ratio 1/2.
    let m2 = (inner / outer).powi(2);
    let factor = 9.0 * (1.0 + m2).powi(2) / (10.0 * (1.0 + m2).powi(2) + 26.0 * m2);
    let beam = euler / (1.0 + euler / (factor * MODULUS * area));
    let rest = solver.rest();
    let load_at = |t: f64| pushed(t * beam);
    let path = SolidPath::Load(&load_at);
    let critical = solver.critical_point(&path, (0.0, &rest), 1.2, 1e-4).unwrap().unwrap();
    assert_eq!((critical.kind, critical.negative), (CriticalKind::Bifurcation, [0, 2]));
    assert_eq!(critical.modes.len(), 2);
    assert!(critical.share < 1e-4, "{}", critical.share);
    // Half a cosine sideways: the cap moves most.
    let cap = critical.modes[0].cap[0];
    assert!(cap.xy().norm() > 0.99 && cap.z.abs() < 1e-6, "{cap}");
    critical.at
}

#[test]
fn a_column_buckles_at_eulers_load_with_shear() {
    // The clamps keep the ends from widening where the column bends most, over lengths of about a radius: an excess that falls as
    // radius over length. What is left when it is taken out is of second order.
    let [short, long] = [(0.1, 8), (0.2, 12)].map(|(length, along)| critical_over_beam(length, 8, along));
    let slender = 2.0 * long - short;
    assert!((slender - 1.0).abs() < 5e-3, "{short} {long} {slender}");
    assert!(short < 1.05);
}

#[test]
fn the_crossing_branch_of_a_column_has_less_energy() {
    let mut solver = column(0.1, 4, 4);
    let rest = solver.rest();
    let load_at = |t: f64| shortened(1e-3 * t);
    let path = SolidPath::Load(&load_at);
    let critical = solver.survey(&path, (0.0, &rest), &[0.5, 1.0], 0, 1e-3, true, &mut |_, _, _| true);
    let critical = critical.unwrap();
    assert_eq!(critical.len(), 1);
    let critical = &critical[0];
    assert_eq!(critical.kind, CriticalKind::Bifurcation);
    let at = 1.5 * critical.at;
    let branches = solver.switch_branch(&path, critical, (0.0, &rest), at, 1e-4).unwrap().unwrap();
    assert_eq!(branches.negative, [2, 0]);
    assert!(branches.potentials[1] < branches.potentials[0]);
    // Inextensible column: the shortening beyond the critical one is (pi a)^2/(16 L) for a shift a of the cap. The strain that is left
    // and the amplitude's fourth power are below 1 %.
    let shift = 4.0 / PI * (0.5e-3 * critical.at * 0.1).sqrt();
    let moved = branches.states[1].cap().0.xy().norm();
    assert!((moved / shift - 1.0).abs() < 0.01, "{moved} {shift}");
    assert!(branches.states.iter().all(|state| state.residual() < 1e-9));
    assert!(solver.imperfection.is_none());
    // Before the bifurcation there is no other branch.
    let none = solver.switch_branch(&path, critical, (0.0, &rest), 0.8 * critical.at, 1e-4).unwrap();
    assert!(none.is_none());
}

#[test]
fn a_snap_to_the_other_side_is_noticed() {
    let mut solver = column(0.1, 4, 4);
    let rest = solver.rest();
    let load_at = |t: f64| shortened(1e-3 * t);
    let path = SolidPath::Load(&load_at);
    let critical = solver.critical_point(&path, (0.0, &rest), 1.0, 1e-2).unwrap().unwrap();
    let branches = solver.switch_branch(&path, &critical, (0.0, &rest), 1.0, 1e-4).unwrap().unwrap();
    let buckled = &branches.states[1];
    let side = buckled.cap().0.xy().normalize();
    // Pushed against the side it has buckled to; turning about its axis is the one way out that a straight push does not take.
    let back =
        |t: f64| SolidLoad { force: Vector3::new(side.x, side.y, 0.0) * (-0.1 * t), ..shortened(1e-3) };
    let path = SolidPath::Load(&back);
    let mut stops = vec![];
    let end = solver.survey(&path, (0.0, buckled), &[0.01, 1.0], 0, 1e-3, true, &mut |t, _, stability| {
        assert_eq!(stability.negative, 1);
        stops.push(t);
        true
    });
    assert!(matches!(end, Err(SolidError::Jumped { before: 1, .. })), "{end:?}");
    assert_eq!(stops, [0.01]);
}

#[test]
fn a_balloon_passes_its_greatest_pressure() {
    let tube = Tube { length: 15e-3, inner_radius: 4.76e-3, wall: 0.8e-3 };
    let mut specimen = specimen(tube, 0, FibreModel::Truss);
    specimen.elastomer =
        Elastomer::Ogden { shear_modulus: MODULUS, alpha: 1.2, form: OgdenForm::InitialModulus };
    let mut solver = SolidSolver::new(&specimen, SolidMesh::new(4, 3)).unwrap();
    let start = solver.follow(&solver.rest(), 0.0, &[20e3], &SolidLoad::pressure, &mut |_, _| true).unwrap();
    let volumes: Vec<f64> = (1..40).map(|i| start.volume * (1.0 + 0.4 * f64::from(i))).collect();
    let limit = solver.pressure_limit(&start, &volumes, 1e-4).unwrap().unwrap();
    // Beyond it: more volume, less pressure, unstable at constant pressure but not at constant volume.
    assert!(limit.beyond.volume > limit.volume && limit.beyond.load.pressure < limit.pressure);
    let beyond = solver.stability(&limit.beyond, 0).unwrap();
    assert_eq!((beyond.negative, beyond.negative_at_volume), (1, 0));
    assert!(beyond.compliance < 0.0);
    // No neighbour has more pressure than the tolerance allows.
    for shift in [-0.02, -0.005, 0.005, 0.02] {
        let near = solver.inflate(&limit.state, &[limit.volume * (1.0 + shift)], &mut |_, _| true).unwrap();
        assert!(near.load.pressure < limit.pressure * (1.0 + 1e-4));
    }
    // The search for critical points finds the same place and tells what it is.
    let path = SolidPath::Volume(start.load);
    let critical = solver
        .critical_point(&path, (start.volume, &start), limit.beyond.volume, 1e-3 * start.volume)
        .unwrap()
        .unwrap();
    assert_eq!((critical.kind, critical.negative), (CriticalKind::Limit, [0, 1]));
    assert!((critical.at / limit.volume - 1.0).abs() < 0.02, "{} {}", critical.at, limit.volume);
    assert!((critical.state.load.pressure / limit.pressure - 1.0).abs() < 1e-4);
    // Under load control the path ends below it, and the last equilibrium is kept.
    let end = solver.follow(&start, 20e3, &[1.02 * limit.pressure], &SolidLoad::pressure, &mut |_, _| true);
    assert!(matches!(end, Err(SolidError::NotConverged { .. })), "{end:?}");
    let (at, kept) = solver.last_good().unwrap();
    assert!(at > 0.95 * limit.pressure && at <= limit.pressure * (1.0 + 1e-6), "{at}");
    assert!(kept.residual() < 1e-9 && kept.load.pressure == at);
}

#[test]
fn a_stopped_path_keeps_where_it_was() {
    let mut solver = column(0.1, 4, 2);
    let rest = solver.rest();
    let end = solver.follow(&rest, 0.0, &[1e-4, 2e-4, 3e-4], &shortened, &mut |at, _| at < 1.5e-4);
    assert_eq!(end, Err(SolidError::Stopped));
    let (at, state) = solver.last_good().unwrap();
    assert_eq!((at, state.load.displacement.z), (2e-4, -2e-4));
}

/// Fibres as beams: the frames of their nodes are among the unknowns.
#[test]
fn the_tangent_with_beams_is_the_slope_of_the_residual() {
    let tube = Tube { length: 12e-3, inner_radius: 4.76e-3, wall: 0.8e-3 };
    let specimen = specimen(tube, 2, FibreModel::Beam);
    let mut solver = SolidSolver::new(&specimen, SolidMesh::new(4, 2)).unwrap();
    let load_at = |t: f64| SolidLoad {
        pressure: 20e3 * t,
        force: Vector3::new(0.05, -0.03, 0.1) * t,
        moment: Vector3::new(2e-4, 1e-4, -3e-4) * t,
        ..SolidLoad::default()
    };
    // In equilibrium turns in one frame or another have the same second derivatives.
    let state = solver.follow(&solver.rest(), 0.0, &[0.5, 1.0], &load_at, &mut |_, _| true).unwrap();
    assert!(!state.rotations.is_empty());
    solver.assemble(&state, true).unwrap();
    let n = solver.unknowns();
    let radius = tube.outer_radius();
    for seed in 0..3 {
        let mut step: Vec<f64> =
            (0..n).map(|i| 1e-3 * (((i * 7919 + seed * 104729) % 1009) as f64 / 504.5 - 1.0)).collect();
        // Turns of the nodes and of the cap in radians.
        let turning = n - 6 - 3 * (state.rotations.len() - 4);
        step[turning..n - 6].iter_mut().for_each(|x| *x *= 1e2);
        step[n - 3..].iter_mut().for_each(|x| *x /= radius);
        solver.assemble(&state, true).unwrap();
        let mut expected = vec![0.0; n];
        solver.body.pattern.multiply_into(&solver.body.values, &step, &mut expected);
        let motion = solver.motion(&state, &step, false);
        let mut at = |h: f64| {
            let mut motion = motion.clone();
            motion.scale(h);
            let moved = solver.moved(&state, &motion);
            solver.assemble(&moved, false).unwrap();
            solver.forces.residual.clone()
        };
        let h = 1e-4;
        let (plus, minus) = (at(h), at(-h));
        for part in [0..turning, turning..n - 6, n - 6..n - 3, n - 3..n] {
            let scale = expected[part.clone()].iter().fold(0.0f64, |most, x| most.max(x.abs()));
            for i in part {
                let slope = (plus[i] - minus[i]) / (2.0 * h);
                assert!(
                    (slope - expected[i]).abs() < 1e-5 * scale,
                    "{i}: {slope} {} of {scale}",
                    expected[i]
                );
            }
        }
    }
}
