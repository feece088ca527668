//! Tests of the section as a whole.

use super::{
    mesh::Grid,
    problem::{Problem, State},
    *,
};
use crate::{SectionLaw, ThickTube};
use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, PathEnd, Tube, Winding};

/// The tube of the reference numbers: mu = 0.393 MPa, Ogden 1.2, bore 4.76 mm, wall 0.8 mm, six linear fibres of 644 N.
pub(crate) fn free(winding_angle_deg: f64) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.3e-3, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 0.13, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(winding_angle_deg.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

const COARSE: SectionMesh = SectionMesh { radial: 2, under_fibre: 1, between_fibres: 2 };

fn with_width(free: Free, diameter_mm: f64) -> Free {
    let mut free = free;
    free.winding.fibre.diameter = 1e-3 * diameter_mm;
    free
}

/// Fibres so wide that they cover the tube: the smeared limit.
fn smeared(free: Free) -> Free {
    with_width(free, 10.0)
}

fn tension_only(free: Free) -> Free {
    let mut free = free;
    free.winding.fibre.law = FibreLaw::TensionOnly;
    free
}

fn bare(alpha: f64) -> Free {
    let mut free = free(45.0);
    free.winding.fibre.axial_stiffness = 0.0;
    free.elastomer = Elastomer::Ogden { shear_modulus: 0.393e6, alpha, form: OgdenForm::InitialModulus };
    free
}

fn solver(free: &Free, mesh: SectionMesh) -> SectionSolver {
    SectionSolver::new(free, mesh).unwrap()
}

/// (stretch, expansion, twist in deg/mm) at pressures in kPa.
fn states(free: &Free, mesh: SectionMesh, pressures_kpa: &[f64]) -> (Vec<[f64; 3]>, Option<f64>) {
    let pressures: Vec<f64> = pressures_kpa.iter().map(|p| 1e3 * p).collect();
    let path = solver(free, mesh).path(&pressures, 0).unwrap();
    let states = pressures
        .iter()
        .map(|pressure| {
            let state =
                path.states.iter().find(|state| (state.pressure - pressure).abs() < 1e-9 * pressure).unwrap();
            assert!(state.residual < 1e-8);
            [state.axial_stretch, state.expansion, 1e-3 * state.twist_per_length.to_degrees()]
        })
        .collect();
    (states, path.limit_pressure().map(|pressure| 1e-3 * pressure))
}

#[test]
fn bare_tube_meets_the_thick_tube_in_closed_form() {
    // Pressure kPa, b/B, lambda of the incompressible tube with closed ends, to 1e-6.
    type Row = (f64, f64, f64);
    let table: [(f64, [Row; 3]); 3] = [
        (0.8, [(4.0, 1.014556, 1.000076), (12.0, 1.047895, 1.000797), (24.0, 1.114052, 1.004257)]),
        (1.2, [(4.0, 1.014537, 1.000114), (12.0, 1.047686, 1.001195), (24.0, 1.112867, 1.006378)]),
        (2.0, [(4.0, 1.014498, 1.000190), (12.0, 1.047268, 1.001990), (24.0, 1.110515, 1.010575)]),
    ];
    for (alpha, rows) in table {
        let (found, _) = states(&bare(alpha), COARSE, &rows.map(|row| row.0));
        for ((pressure, expansion, stretch), state) in rows.into_iter().zip(found) {
            // Half a unit of the table, 1e-6 of compressibility (K/mu = 1e5), two elements through the wall.
            assert!((state[0] - stretch).abs() < 3e-6, "alpha {alpha}, {pressure} kPa: stretch {}", state[0]);
            assert!(
                (state[1] - expansion).abs() < 3e-6,
                "alpha {alpha}, {pressure} kPa: expansion {}",
                state[1]
            );
            assert!(state[2].abs() < 1e-6, "a bare tube does not twist");
        }
    }
}

#[test]
fn fibres_that_cover_the_tube_meet_the_smeared_closed_form() {
    // Winding angle deg; pressure kPa, lambda, b/B, twist deg/mm; limit pressure kPa.
    type Row = (f64, f64, f64, f64);
    let table: [(f64, [Row; 3], f64); 4] = [
        (
            10.0,
            [
                (10.0, 1.01944, 1.00389, -0.2585),
                (40.0, 1.08981, 1.01757, -1.1613),
                (68.9, 1.18384, 1.03527, -2.3147),
            ],
            134.0,
        ),
        (
            20.0,
            [
                (10.0, 1.01200, 1.01311, -0.4079),
                (40.0, 1.06116, 1.06108, -1.8398),
                (68.9, 1.14573, 1.13295, -3.8176),
            ],
            94.5,
        ),
        (
            60.0,
            [
                (10.0, 0.99499, 1.04009, -0.1428),
                (30.0, 0.98626, 1.15601, -0.5908),
                (40.0, 0.98441, 1.25328, -0.9780),
            ],
            52.5,
        ),
        (
            80.0,
            [
                (10.0, 0.99897, 1.03967, -0.0117),
                (20.0, 0.99787, 1.09110, -0.0388),
                (40.0, 0.99595, 1.28400, -0.2163),
            ],
            48.5,
        ),
    ];
    for (angle, rows, limit_pressure) in table {
        let (found, limit) = states(&smeared(free(angle)), COARSE, &rows.map(|row| row.0));
        for ((pressure, stretch, expansion, twist), state) in rows.into_iter().zip(found) {
            // The table's last digit and the compressibility of the wall.
            assert!((state[0] - stretch).abs() < 1.5e-5, "{angle} deg, {pressure} kPa: stretch {}", state[0]);
            assert!(
                (state[1] - expansion).abs() < 1.5e-5,
                "{angle} deg, {pressure} kPa: expansion {}",
                state[1]
            );
            assert!((state[2] - twist).abs() < 1.5e-4, "{angle} deg, {pressure} kPa: twist {}", state[2]);
        }
        let limit = limit.unwrap();
        assert!((limit - limit_pressure).abs() < 0.06, "{angle} deg: limit {limit}");
    }
}

#[test]
fn six_fibres_agree_with_three_dimensional_solids_away_from_the_caps() {
    // Middle of solids of 24 (20 deg, to 0.1 %) and 12 elements around (60 deg), fibres as trusses without width, whose own width is that of
    // the elements' shape functions: nearer to 0.15 mm than to the 0.3 mm of cotton.
    type Row = (f64, f64, f64, f64);
    let table: [(f64, &[Row], f64); 2] = [
        (
            20.0,
            &[
                (10.0, 1.01149, 1.01432, -0.3871),
                (20.0, 1.02495, 1.02985, -0.8040),
                (30.0, 1.04086, 1.04693, -1.2582),
                (40.0, 1.05991, 1.06606, -1.7607),
                (50.0, 1.08317, 1.08799, -2.3285),
                (60.0, 1.11243, 1.11403, -2.9898),
                (68.9, 1.14617, 1.14263, -3.6991),
            ],
            94.5,
        ),
        (
            60.0,
            &[
                (10.0, 0.99512, 1.04014, -0.1393),
                (20.0, 0.99046, 1.09022, -0.3247),
                (30.0, 0.98660, 1.15635, -0.5808),
                (40.0, 0.98531, 1.25289, -0.9617),
            ],
            52.5,
        ),
    ];
    for (angle, rows, limit_pressure) in table {
        let pressures: Vec<f64> = rows.iter().map(|row| row.0).collect();
        let (found, limit) = states(&with_width(free(angle), 0.15), SectionMesh::default(), &pressures);
        for (&(pressure, stretch, expansion, twist), state) in rows.iter().zip(found) {
            let off = [state[0] / stretch - 1.0, state[1] / expansion - 1.0, state[2] / twist - 1.0];
            assert!(
                off[0].abs() < 1e-3 && off[1].abs() < 2e-3 && off[2].abs() < 1e-2,
                "{angle} deg, {pressure} kPa: {off:?}"
            );
        }
        assert!((limit.unwrap() / limit_pressure - 1.0).abs() < 0.02);
    }
}

#[test]
fn a_mirrored_winding_twists_the_other_way() {
    let right = free(30.0);
    let mut left = right;
    left.winding.handedness = Handedness::Left;
    let (a, b) = (states(&right, COARSE, &[30.0]).0[0], states(&left, COARSE, &[30.0]).0[0]);
    assert!(a[2] < -1.0, "a right-handed FREE of 30 deg turns negative");
    assert_eq!([a[0], a[1], -a[2]], b);
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
    let mut step = problem::Step::new(problem);
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
            let mut step = problem::Step::new(&problem);
            if index < problem.order {
                step.inner[index] = 1.0
            } else {
                step.globals[index - problem.order] = 1.0
            }
            let fixed = |factor: f64, system: &mut problem::System| {
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
            let along = |factor: f64, system: &mut problem::System| {
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
fn half_a_pitch_says_the_same_as_a_whole_one() {
    for angle in [20.0, 60.0] {
        let free = free(angle);
        let half = states(&free, COARSE, &[45.0]).0[0];
        let path =
            SectionSolver::with_grid(&free, Grid::whole_pitch(&free, COARSE)).path(&[45e3], 0).unwrap();
        let whole = path.states[1];
        assert!((half[0] - whole.axial_stretch).abs() < 1e-8);
        assert!((half[1] - whole.expansion).abs() < 1e-8);
        assert!((half[2] - 1e-3 * whole.twist_per_length.to_degrees()).abs() < 1e-7);
    }
}

#[test]
fn a_stretched_bare_tube_is_in_uniaxial_tension() {
    // lambda, 1/sqrt(lambda), 1/sqrt(lambda): N = A dW/dlambda with W = c (l^a + 2 l^(-a/2)), nodal values exact.
    let free = bare(1.2);
    let mut solver = solver(&free, COARSE);
    for stretch in [0.8, 1.0, 1.5] {
        let response = solver.respond(0.0, stretch, 0.0).unwrap();
        let (alpha, c) = (1.2, 2.0 * 0.393e6 / 1.44);
        let stress = |l: f64| c * alpha * (l.powf(alpha - 1.0) - l.powf(-0.5 * alpha - 1.0));
        let expected = free.tube.wall_area() * stress(stretch);
        // The wall's compressibility, stress/K = 1e-5.
        assert!(
            (response.force - expected).abs() < 2e-5 * (expected.abs() + 1.0),
            "{} N, not {expected}",
            response.force
        );
        assert!(response.torque.abs() < 1e-9);
        let slope = free.tube.wall_area() * (stress(stretch + 1e-5) - stress(stretch - 1e-5)) / 2e-5;
        assert!((response.stiffness[0][0] / slope - 1.0).abs() < 3e-5);
        assert!((solver.expansion() - stretch.sqrt().recip()).abs() < 1e-5);
    }
}

#[test]
fn responses_are_the_derivatives_of_their_energy() {
    // Pressure Pa, stretch, twist rad/m; the last with slack threads.
    let cases = [
        (free(25.0), [(30e3, 1.03, -22.0), (15e3, 1.0, -15.0), (0.0, 0.98, 5.0)]),
        (tension_only(free(65.0)), [(30e3, 0.98, -10.0), (40e3, 0.97, -20.0), (0.0, 0.93, -10.0)]),
    ];
    for (free, states) in cases {
        let mut solver = solver(&free, COARSE);
        for (pressure, stretch, twist) in states {
            let here = solver.respond(pressure, stretch, twist).unwrap();
            // Long enough for the residual allowed, short enough for second-order differences.
            let (dl, dt) = (3e-5, 3e-3);
            let mut at = |l: f64, t: f64| solver.respond(pressure, stretch + l, twist + t).unwrap();
            let (lu, ld, tu, td) = (at(dl, 0.0), at(-dl, 0.0), at(0.0, dt), at(0.0, -dt));
            let close = |slope: f64, value: f64, scale: f64, what: &str| {
                assert!(
                    (slope - value).abs() < 3e-5 * scale,
                    "{what}: {slope} and {value} at {pressure} {stretch} {twist}"
                );
            };
            // Scales: mu times the wall's area is 10 N; times its radius squared, 3e-4 N m^2.
            close((lu.energy - ld.energy) / (2.0 * dl), here.force, 10.0, "force");
            close((tu.energy - td.energy) / (2.0 * dt), here.torque, 0.05, "torque");
            let k = here.stiffness;
            close((lu.force - ld.force) / (2.0 * dl), k[0][0], k[0][0].abs().max(10.0), "N by lambda");
            close((lu.torque - ld.torque) / (2.0 * dl), k[1][0], k[1][0].abs().max(0.05), "M by lambda");
            close((tu.force - td.force) / (2.0 * dt), k[0][1], k[0][1].abs().max(0.05), "N by tau");
            close((tu.torque - td.torque) / (2.0 * dt), k[1][1], k[1][1].abs().max(3e-4), "M by tau");
            assert_eq!(k[0][1], k[1][0]);
        }
    }
}

#[test]
fn a_free_state_of_the_path_needs_no_force_and_no_torque() {
    let free = free(40.0);
    let mut solver = solver(&free, COARSE);
    let state = solver.path(&[45e3], 0).unwrap().states[1];
    let response = solver.respond(state.pressure, state.axial_stretch, state.twist_per_length).unwrap();
    assert!(response.force.abs() < 1e-7 && response.torque.abs() < 1e-9, "{response:?}");
    assert!((solver.expansion() - state.expansion).abs() < 1e-8);
    // Stable in load control below the limit.
    let k = response.stiffness;
    assert!(k[0][0] > 0.0 && k[0][0] * k[1][1] - k[0][1] * k[1][0] > 0.0);
}

#[test]
fn smeared_section_answers_any_stretch_and_twist_like_the_closed_form() {
    // Shortened, lengthened, wound and unwound, taut and slack, with and without pressure. Where the threads pull with several
    // times the strength of the wall, the section wrinkles between them, which the closed form does not know.
    let mut compared = 0;
    for free in [smeared(free(20.0)), smeared(tension_only(free(20.0))), smeared(tension_only(free(60.0)))] {
        let closed = ThickTube::new(&free);
        let mut solver = solver(&free, COARSE);
        for pressure in [0.0, 15e3, 40e3] {
            for stretch in [0.85, 0.97, 1.01, 1.04] {
                for twist in [-40.0, -5.0, 0.0, 10.0, 30.0] {
                    let expected = closed.respond(pressure, stretch, twist);
                    if expected.force.is_nan() || expected.force.abs() > 25.0 || expected.torque.abs() > 0.1 {
                        continue;
                    }
                    compared += 1;
                    let at = format!("{pressure} Pa, {stretch}, {twist} rad/m");
                    let found = solver.respond(pressure, stretch, twist).unwrap();
                    // The wall's compressibility is about 1e-5 of everything; mu B^2 = 12 N, mu B^3 = 0.07 N m.
                    let close = |a: f64, b: f64, scale: f64, what: &str| {
                        assert!(
                            (a - b).abs() < 5e-5 * (b.abs() + scale),
                            "{what}: {a}, closed form {b} at {at}"
                        );
                    };
                    close(found.energy, expected.energy, 12.0, "energy");
                    close(found.force, expected.force, 12.0, "force");
                    close(found.torque, expected.torque, 0.07, "torque");
                    for (i, j, scale) in [(0, 0, 12.0), (0, 1, 0.07), (1, 0, 0.07), (1, 1, 4e-4)] {
                        close(found.stiffness[i][j], expected.stiffness[i][j], scale, "stiffness");
                    }
                }
            }
        }
    }
    assert!(compared > 150, "{compared} of 180 states are within the loads");
}

#[test]
fn loaded_states_are_found_again_at_their_stretch_and_twist() {
    // Forces and torques of the size that FREEs put on each other in a module, pushing and pulling, in both senses; threads go
    // slack under some of them.
    let loads =
        [-2.0, 0.0, 4.0].into_iter().flat_map(|force| [-0.01, 0.0, 0.01].map(|torque| (force, torque)));
    for angle in [20.0, 40.0, 70.0] {
        let free = tension_only(free(angle));
        let mut solver = solver(&free, SectionMesh::default());
        for (force, torque) in loads.clone() {
            let path = solver.path_under(SectionLoad { force, torque }, &[10e3, 25e3], 0).unwrap();
            for state in &path.states[..3] {
                let at = format!("{angle} deg, {force} N, {torque} N m, {state:?}");
                let response = solver
                    .respond(state.pressure, state.axial_stretch, state.twist_per_length)
                    .unwrap_or_else(|error| panic!("{error} at {at}"));
                // The residual allowed, 1e-10 to 5e-9 of mu B^2 = 12 N, times the stiffness over that of the wall.
                assert!((response.force - force).abs() < 1e-5, "{response:?} at {at}");
                assert!((response.torque - torque).abs() < 1e-7, "{response:?} at {at}");
            }
        }
    }
}

#[test]
fn a_slack_thread_does_nothing() {
    // Shortened and unwound without pressure, every thread is slack and the tube as good as bare.
    let free = tension_only(free(45.0));
    let mut bare_free = free;
    bare_free.winding.fibre.axial_stiffness = 0.0;
    let (with, without) = (
        solver(&free, COARSE).respond(0.0, 0.9, -20.0).unwrap(),
        solver(&bare_free, COARSE).respond(0.0, 0.9, -20.0).unwrap(),
    );
    assert!((with.force - without.force).abs() < 1e-7 && (with.torque - without.torque).abs() < 1e-9);
    // The truss of the same stiffness pushes.
    let mut truss = free;
    truss.winding.fibre.law = FibreLaw::Linear;
    assert!(solver(&truss, COARSE).respond(0.0, 0.9, -20.0).unwrap().force < with.force - 1.0);
}

#[test]
fn beyond_ballooning_an_error_says_where_the_last_good_state_is() {
    let mut solver = solver(&free(70.0), COARSE);
    let error = solver.respond(200e3, 1.0, 0.0).unwrap_err();
    let SectionError::NotConverged { last_good, target, .. } = &error else { panic!("{error}") };
    assert_eq!(target.pressure, 200e3);
    assert!(last_good.pressure > 30e3 && last_good.pressure < 200e3, "{error}");
    // And the solver goes on.
    assert!(solver.respond(10e3, 1.0, 0.0).is_ok());
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
fn a_smooth_section_converges_with_order_four() {
    // Thick wall, fibres that cover it: displacements of order three, global answers of order four.
    let mut free = smeared(free(30.0));
    free.tube.wall = 4.76e-3;
    let at = |radial| states(&free, SectionMesh { radial, ..COARSE }, &[150.0]).0[0];
    // Its own error, a sixteenth of that of six elements, raises the order by a tenth.
    let exact = at(12);
    let (three, six) = (at(3), at(6));
    for (quantity, exact) in exact.into_iter().enumerate() {
        let error = |found: [f64; 3]| (found[quantity] - exact).abs();
        let order = (error(three) / error(six)).log2();
        assert!(
            order > 3.7,
            "quantity {quantity}: order {order:.2}, errors {:e} {:e}",
            error(three),
            error(six)
        );
    }
}

#[test]
fn discrete_fibres_with_a_width_converge() {
    // The pull of a fibre ends abruptly at its edge: kinks of the strain there limit the order; 1.4 to 2.1 were measured between 10
    // and 45 deg.
    let free = free(45.0);
    let base = SectionMesh { radial: 1, under_fibre: 1, between_fibres: 2 };
    let [two, four, eight] = [2, 4, 8].map(|factor| states(&free, base.refined(factor), &[45.0]).0[0]);
    for quantity in 0..3 {
        let order = ((two[quantity] - four[quantity]) / (four[quantity] - eight[quantity])).abs().log2();
        assert!(order > 1.3, "quantity {quantity}: order {order:.2}");
    }
}

#[test]
fn default_mesh_is_good_to_a_tenth_of_a_percent() {
    for (angle, pressure) in [(10.0, 68.9), (20.0, 68.9), (45.0, 45.0)] {
        let found = states(&free(angle), SectionMesh::default(), &[pressure]).0[0];
        let fine = SectionMesh { radial: 4, under_fibre: 4, between_fibres: 8 };
        let exact = states(&free(angle), fine, &[pressure]).0[0];
        for (quantity, (found, exact)) in found.iter().zip(exact).enumerate() {
            let error = (found / exact - 1.0).abs();
            assert!(error < 1e-3, "{angle} deg, quantity {quantity}: {error:e}");
        }
    }
}

#[test]
fn a_thinner_thread_lets_the_wall_bulge_more_by_as_much_at_each_halving() {
    // Under a line load the surface sinks like the logarithm of its width: no limit without one.
    let mesh = SectionMesh { radial: 4, under_fibre: 2, between_fibres: 8 };
    let expansion =
        [0.6, 0.3, 0.15].map(|width| states(&with_width(free(20.0), width), mesh, &[68.9]).0[0][1]);
    let (first, second) = (expansion[1] - expansion[0], expansion[2] - expansion[1]);
    assert!(first > 1e-3 && (second / first - 1.0).abs() < 0.2, "{expansion:?}");
}
