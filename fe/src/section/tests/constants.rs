//! Energy and stiffness at the states of a path.

use super::*;
use actuator::{FreePath, SectionConstants};

const LOAD: EndLoad = EndLoad { force: 1.5, torque: 0.006 };

fn mirrored(free: &Free) -> Free {
    let mut free = *free;
    free.winding.handedness = Handedness::Left;
    free
}

fn constants(path: &FreePath) -> Vec<(FreeState, SectionConstants)> {
    path.states.iter().map(|state| (*state, state.section.unwrap())).collect()
}

#[test]
fn constants_are_the_derivatives_of_the_enthalpy() {
    for (free, load) in [
        (free(25.0), LOAD),
        (mirrored(&free(25.0)), LOAD),
        (tension_only(free(60.0)), EndLoad::default()),
        (mirrored(&tension_only(free(60.0))), EndLoad { force: -0.5, torque: -0.004 }),
    ] {
        let hand = free.winding.handedness.sign();
        let mut solver = solver(&free, COARSE);
        let path = solver.path_under(load, &[12e3, 35e3], 0).unwrap();
        // Not the limit state: above it there is no pressure to take a difference with.
        for (state, found) in &constants(&path)[1..3] {
            let (p, l, t) = (state.pressure, state.axial_stretch, state.twist_per_length);
            let mut at = |dp: f64, dl: f64, dt: f64| solver.respond(p + dp, l + dl, hand * (t + dt)).unwrap();
            let here = at(0.0, 0.0, 0.0);
            let close = |value: f64, expected: f64, scale: f64, what: &str| {
                assert!(
                    (value - expected).abs() < 3e-5 * (expected.abs() + scale),
                    "{what}: {value} and {expected} at {p} Pa, hand {hand}, {load:?}"
                );
            };
            // mu B^2 = 12 N, B^2 = 3e-5 m^2, B^3 = 1.7e-7 m^3.
            assert!(
                (here.force - load.force).abs() < 1e-5 && (hand * here.torque - load.torque).abs() < 1e-7
            );
            close(found.energy - p * found.volume, here.energy, 1e-3, "W - p V");
            let (dp, dl, dt) = (30.0, 3e-5, 3e-3);
            let (pu, pd) = (at(dp, 0.0, 0.0), at(-dp, 0.0, 0.0));
            close(found.volume, (pd.energy - pu.energy) / (2.0 * dp), 0.0, "V = -dPhi/dp");
            let [force_slope, torque_slope] = found.pressure_slopes;
            close(force_slope, (pu.force - pd.force) / (2.0 * dp), 3e-5, "dN/dp");
            close(torque_slope, hand * (pu.torque - pd.torque) / (2.0 * dp), 1.7e-7, "dM/dp");
            let (lu, ld, tu, td) = (at(0.0, dl, 0.0), at(0.0, -dl, 0.0), at(0.0, 0.0, dt), at(0.0, 0.0, -dt));
            let k = found.stiffness;
            close(k[0][0], (lu.force - ld.force) / (2.0 * dl), 10.0, "dN/dlambda");
            close(k[0][1], (tu.force - td.force) / (2.0 * dt), 0.05, "dN/dtau");
            close(k[1][0], hand * (lu.torque - ld.torque) / (2.0 * dl), 0.05, "dM/dlambda");
            close(k[1][1], hand * (tu.torque - td.torque) / (2.0 * dt), 3e-4, "dM/dtau");
            // Maxwell: what the pressure does to the forces, stretch and twist do to the volume.
            let mut volume = |dl: f64, dt: f64| (at(-dp, dl, dt).energy - at(dp, dl, dt).energy) / (2.0 * dp);
            let (dl, dt) = (1e-3, 0.1);
            let by_stretch = (volume(dl, 0.0) - volume(-dl, 0.0)) / (2.0 * dl);
            let by_twist = (volume(0.0, dt) - volume(0.0, -dt)) / (2.0 * dt);
            assert!((force_slope + by_stretch).abs() < 1e-3 * by_stretch.abs().max(3e-5), "{by_stretch}");
            assert!((torque_slope + by_twist).abs() < 1e-3 * by_twist.abs().max(1.7e-7), "{by_twist}");
        }
    }
}

#[test]
fn constants_carry_a_path_on_to_more_load() {
    // At constant pressure a small load more changes stretch and twist by the inverse of the stiffness.
    let free = mirrored(&free(35.0));
    let more = EndLoad { force: LOAD.force + 1e-3, torque: LOAD.torque + 5e-6 };
    let at = |load| constants(&solver(&free, COARSE).path_under(load, &[25e3], 0).unwrap())[1];
    let ((from, k), (to, _)) = (at(LOAD), at(more));
    let change = [to.axial_stretch - from.axial_stretch, to.twist_per_length - from.twist_per_length];
    for (row, expected) in k.stiffness.iter().zip([1e-3, 5e-6]) {
        let load = row[0] * change[0] + row[1] * change[1];
        assert!((load / expected - 1.0).abs() < 1e-2, "{load} for {expected}");
    }
}

#[test]
fn constants_of_the_mirror_image_are_mirrored() {
    let path = |free: &Free, torque| {
        let load = EndLoad { torque, ..LOAD };
        constants(&solver(free, COARSE).path_under(load, &[20e3], 2).unwrap())
    };
    let (right, left) = (path(&free(30.0), 0.006), path(&mirrored(&free(30.0)), -0.006));
    assert_eq!(right.len(), left.len());
    for ((_, a), (_, b)) in right.iter().zip(&left) {
        assert_eq!((a.energy, a.volume), (b.energy, b.volume));
        assert_eq!((a.stiffness[0][0], a.stiffness[1][1]), (b.stiffness[0][0], b.stiffness[1][1]));
        assert_eq!((a.stiffness[0][1], a.stiffness[1][0]), (-b.stiffness[0][1], -b.stiffness[1][0]));
        assert_eq!(a.pressure_slopes, [b.pressure_slopes[0], -b.pressure_slopes[1]]);
    }
    let coupling = right[1].1.stiffness[0][1].abs();
    assert!(coupling > 1e-3, "a mirror image without coupling shows nothing: {coupling}");
}

#[test]
fn constants_of_a_smeared_wall_are_those_of_the_closed_form() {
    for angle in [20.0, 60.0] {
        let free = smeared(free(angle));
        let (a, b) = (free.tube.inner_radius, free.tube.outer_radius());
        let closed = ThickTube::new(&free);
        let path = solver(&free, COARSE).path(&[10e3, 30e3], 0).unwrap();
        for (state, found) in &constants(&path)[..3] {
            let (p, l, t) = (state.pressure, state.axial_stretch, state.twist_per_length);
            let expected = closed.respond(p, l, t);
            let close = |value: f64, expected: f64, scale: f64, what: &str| {
                assert!(
                    (value - expected).abs() < 5e-5 * (expected.abs() + scale),
                    "{what}: {value} and {expected} at {angle} deg, {p} Pa"
                );
            };
            // The volume of the wall is kept: a'^2 = b'^2 - (B^2 - A^2)/lambda.
            let inner_squared = (state.expansion * b).powi(2) - (b * b - a * a) / l;
            let volume = std::f64::consts::PI * inner_squared * l;
            close(found.volume, volume, 0.0, "V");
            close(found.energy, expected.energy + p * volume, 12.0, "W");
            for (i, j, scale) in [(0, 0, 12.0), (0, 1, 0.07), (1, 0, 0.07), (1, 1, 4e-4)] {
                close(found.stiffness[i][j], expected.stiffness[i][j], scale, "stiffness");
            }
            let slopes = closed.pressure_slopes(p, l, t);
            close(found.pressure_slopes[0], slopes[0], 3e-5, "dN/dp");
            close(found.pressure_slopes[1], slopes[1], 1.7e-7, "dM/dp");
        }
    }
}
