//! Paths under pressure, the potential behind them, and what is refused.

use super::*;

#[test]
fn a_mirrored_winding_twists_the_other_way() {
    let right = free(30.0);
    let mut left = right;
    left.winding.handedness = Handedness::Left;
    let (a, b) = (states(&right, COARSE, &[30.0]).0[0], states(&left, COARSE, &[30.0]).0[0]);
    assert!(a[2] < -1.0, "a right-handed FREE of 30 deg turns negative");
    assert_eq!([a[0], a[1], -a[2]], b);
    let loaded = |free: &Free, torque| {
        solver(free, COARSE).path_under(actuator::EndLoad { force: 1.0, torque }, &[30e3], 0).unwrap().states
            [1]
    };
    let (a, b) = (loaded(&right, 0.005), loaded(&left, -0.005));
    assert_eq!(
        [a.axial_stretch, a.expansion, -a.twist_per_length],
        [b.axial_stretch, b.expansion, b.twist_per_length]
    );
}

/// A state without symmetry or equilibrium, some thread in compression.
fn disturbed(problem: &Problem) -> State {
    let mut state = problem.rest();
    let mut seed = 1.0f64;
    let mut noise = |size: f64| {
        seed = (seed * 78.233 + 0.123).sin();
        size * seed
    };
    for chunk in state.nodes.chunks_exact_mut(3) {
        chunk[0] *= 1.1 + noise(0.003);
    }
    state.multipliers.iter_mut().flatten().for_each(|value| *value = noise(0.3));
    state.globals = [0.95, -0.2, 0.13];
    // Through the unknowns, so that held values stay held.
    let mut step = Step::new(problem);
    step.inner.iter_mut().for_each(|value| *value = noise(0.003));
    problem.advance(&mut state, &step, 1.0);
    state
}

#[test]
fn residual_and_stiffness_are_derivatives_of_one_energy() {
    for law in [FibreLaw::Linear, FibreLaw::TensionOnly] {
        let mut free = free(35.0);
        free.winding.fibre.law = law;
        let problem = Problem::new(&free, Grid::half_pitch(&free, COARSE));
        let state = disturbed(&problem);
        let mut here = problem.system();
        problem.linearise(&state, &mut here).unwrap();
        let step_size = 1e-6;
        let (mut up, mut down) = (here.clone(), here.clone());
        for index in (0..problem.order).step_by(7).chain(problem.order..problem.order + 3) {
            // Move one unknown; the elements' pressures stay, then follow their own equations.
            let mut step = Step::new(&problem);
            if index < problem.order {
                step.inner[index] = 1.0
            } else {
                step.globals[index - problem.order] = 1.0
            }
            let fixed = |factor: f64, system: &mut System| {
                let mut moved = state.clone();
                problem.advance(&mut moved, &step, factor);
                problem.linearise(&moved, system).unwrap();
            };
            fixed(step_size, &mut up);
            fixed(-step_size, &mut down);
            let slope = (up.energy - down.energy) / (2.0 * step_size);
            let (expected, column): (f64, &dyn Fn(usize) -> f64) = match index.checked_sub(problem.order) {
                None => (here.residual[index], &|a| here.columns[a][index]),
                Some(2) => (-here.volume, &|a| here.corner[a][2]),
                Some(a) => (here.global_residual[a], &move |b| here.corner[a][b]),
            };
            assert!((slope - expected).abs() < 1e-7, "{law:?}: gradient {index}: {slope} and {expected}");

            // Along the tangent of the volume equations the condensed stiffness is the derivative of the residual.
            problem.complete(&here, &mut step, false);
            let along = |factor: f64, system: &mut System| {
                let mut moved = state.clone();
                problem.advance(&mut moved, &step, factor);
                problem.linearise(&moved, system).unwrap();
            };
            along(1e-8, &mut up);
            along(-1e-8, &mut down);
            for a in 0..2 {
                let slope = (up.global_residual[a] - down.global_residual[a]) / 2e-8;
                let expected = column(a);
                // The tangent is as large as the bulk modulus (1e5) times an element's size.
                assert!(
                    (slope - expected).abs() < 1e-3 + 1e-6 * expected.abs(),
                    "{law:?}: border {a} {index}: {slope} and {expected}"
                );
            }
        }
    }
}

#[test]
fn numbers_that_make_no_section_are_refused() {
    let mut thin = free(20.0);
    thin.winding.fibre.diameter = 0.0;
    let error = SectionSolver::new(&thin, SectionMesh::default()).unwrap_err();
    assert!(error.to_string().starts_with("diameter is 0, but a fibre without width"), "{error}");
    let mut ring = free(20.0);
    ring.winding = ring.winding.with_angle_from_hoop(0.0);
    assert!(SectionSolver::new(&ring, SectionMesh::default()).is_err());
    let mesh = SectionMesh { radial: 0, ..SectionMesh::default() };
    assert!(SectionSolver::new(&free(20.0), mesh).is_err());
    let mut solver = solver(&free(20.0), COARSE);
    assert!(solver.respond(0.0, -1.0, 0.0).is_err() && solver.respond(f64::NAN, 1.0, 0.0).is_err());
    assert!(solver.path(&[f64::NAN], 0).is_err());
}

#[test]
fn neo_hookean_rubber_has_no_limit_point_at_seventy_degrees() {
    let mut free = free(70.0);
    free.elastomer = Elastomer::NeoHookean { shear_modulus: 0.393e6 };
    let path = solver(&free, COARSE).path(&[20e3, 50e3], 9).unwrap();
    assert_eq!(path.end, PathEnd::Range);
    let pressures: Vec<f64> = path.states.iter().map(|state| state.pressure).collect();
    assert_eq!(pressures.len(), 3, "{pressures:?}");
    // More than the threefold bore needs: the path says how far it went.
    let path = solver(&free, COARSE).path(&[20e3, 500e3], 9).unwrap();
    assert_eq!((path.end, path.states.len()), (PathEnd::Range, 3));
    assert!(path.states[2].expansion > 2.5);
}

#[test]
fn limit_point_is_flat_and_its_pressure_the_greatest() {
    let free = free(60.0);
    let mut solver = solver(&free, COARSE);
    let path = solver.path(&[], 19).unwrap();
    let limit = path.states[path.states.len() - 1];
    // The same point by the determinant of the stiffness under the pressure: it falls to zero like the root of the distance.
    let determinant = |solver: &mut SectionSolver, state: &actuator::FreeState| {
        let k =
            solver.respond(state.pressure, state.axial_stretch, state.twist_per_length).unwrap().stiffness;
        (k[0][0] * k[1][1] - k[0][1] * k[1][0]) / (k[0][0] * k[1][1])
    };
    let at_rest = determinant(&mut solver, &path.states[0]);
    assert!(determinant(&mut solver, &limit).abs() < 1e-3 * at_rest);
    // A square root in pressure is a straight line in s: the last differences are alike.
    let expansion: Vec<f64> = path.states.iter().map(|state| state.expansion).collect();
    let steps: Vec<f64> = expansion.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let last = steps.len() - 1;
    assert!((steps[last] / steps[last - 1] - 1.0).abs() < 0.1, "{steps:?}");
}

#[test]
fn narrow_elements_under_many_thin_threads_do_not_hinder_the_start() {
    // Rounding in elements of a hundredth of a millimetre, times the bulk modulus, once counted as a force at rest.
    let mut free = free(10.0);
    free.winding.fibres = 48;
    free.winding.fibre.axial_stiffness *= 6.0 / 48.0;
    free.winding.fibre.diameter *= 6.0 / 48.0;
    let path = solver(&free, SectionMesh::default()).path(&[20e3], 0).unwrap();
    let rest = path.states[0];
    assert_eq!((rest.axial_stretch, rest.twist_per_length), (1.0, 0.0));
    assert!(path.states[1..].iter().all(|state| state.residual < 5e-9), "{:?}", path.states);
}
