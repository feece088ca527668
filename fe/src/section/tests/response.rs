//! Response to given pressure, stretch and twist.

use super::*;

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
            let path = solver.path_under(actuator::EndLoad { force, torque }, &[10e3, 25e3], 0).unwrap();
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
fn a_long_jump_does_not_end_on_an_unstable_branch() {
    // Threads wound tight on a tube without pressure squeeze it; Newton's method from rest finds a second equilibrium here, whose
    // stiffness has a negative pivot. A walk in short steps shows which one is stable.
    let free = tension_only(free(40.0));
    let mesh = SectionMesh { radial: 2, under_fibre: 1, between_fibres: 4 };
    let (stretch, twist) = (0.976_384_556_6, 37.323_111_56);
    let direct = solver(&free, mesh).respond(0.0, stretch, twist).unwrap();
    let mut walker = solver(&free, mesh);
    let mut walked = direct;
    for step in 1..=16 {
        let share = f64::from(step) / 16.0;
        walked = walker.respond(0.0, 1.0 + share * (stretch - 1.0), share * twist).unwrap();
    }
    assert!((direct.force - walked.force).abs() < 1e-6 && (direct.torque - walked.torque).abs() < 1e-8);
    assert!((direct.torque - 0.02).abs() < 1e-7, "{direct:?}");
}

/// At the volume that a pressure gives, energy, force, torque and stiffness are those at the pressure, by Legendre's transformation.
#[test]
fn responses_at_a_volume_are_those_at_its_pressure() {
    for (free, [pressure, stretch, twist]) in
        [(free(25.0), [30e3, 1.03, -22.0]), (tension_only(free(65.0)), [40e3, 0.97, -20.0])]
    {
        let mut solver = solver(&free, COARSE);
        let at = solver.respond(pressure, stretch, twist).unwrap();
        let [above, below] =
            [10.0, -10.0].map(|step| solver.respond(pressure + step, stretch, twist).unwrap().energy);
        let volume = (below - above) / 20.0;
        let found = solver.respond_at_volume(volume, stretch, twist).unwrap();
        let [p, force, torque] = found.gradient;
        let close = |a: f64, b: f64, scale: f64| {
            assert!((a - b).abs() < 1e-5 * scale, "{a} {b} ({scale}) at {found:?}")
        };
        close(p, pressure, 1e4);
        close(found.energy - p * volume, at.energy, 0.1);
        close(force, at.force, 10.0);
        close(torque, at.torque, 0.05);
        let h = found.hessian;
        let condensed = |i: usize, j: usize| h[i][j] - h[i][0] * h[0][j] / h[0][0];
        close(condensed(1, 1), at.stiffness[0][0], 100.0);
        close(condensed(1, 2), at.stiffness[0][1], 1.0);
        close(condensed(2, 2), at.stiffness[1][1], 0.01);
    }
}

/// A bare tube balloons under a pressure, but is at rest at any volume, where its pressure falls again.
#[test]
fn a_volume_has_no_limit() {
    let mut free = free(40.0);
    free.winding.fibre.axial_stiffness = 0.0;
    let mut solver = solver(&free, COARSE);
    let own = std::f64::consts::PI * free.tube.inner_radius.powi(2);
    let mut at = |part: f64| solver.respond_at_volume(part * own, 1.0, 0.0).unwrap();
    let (low, high) = (at(1.5), at(6.0));
    assert!(low.hessian[0][0] > 0.0 && high.hessian[0][0] < 0.0, "{low:?} {high:?}");
    let (lower, upper) = (at(5.99), at(6.01));
    let slope = (upper.gradient[0] - lower.gradient[0]) / (0.02 * own);
    assert!((slope / high.hessian[0][0] - 1.0).abs() < 1e-3, "{slope} {high:?}");
    assert!(
        solver.respond_at_volume(-1.0, 1.0, 0.0).is_err()
            && solver.respond_at_volume(own, 1.0, f64::NAN).is_err()
    );
}
