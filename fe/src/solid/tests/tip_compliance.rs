//! What a cap gives way to, against equilibria under small loads; and what a bare tube's says of the rod that it is.

use super::{specimen, winding};
use crate::{
    RodCompliance, StraightRod,
    solid::{SolidError, SolidLoad, SolidMesh, SolidSolver, SolidState, Specimen},
};
use actuator::{Handedness, Tube};
use nalgebra::{Vector3, Vector6};

const TUBE: Tube = Tube { length: 0.0, inner_radius: 4.76e-3, wall: 0.8e-3 };

fn along(pressure: f64, [force, torque]: [f64; 2]) -> SolidLoad {
    SolidLoad { force: Vector3::z() * force, moment: Vector3::z() * torque, ..SolidLoad::pressure(pressure) }
}

/// The state of a sector under pressure and loads along the axis, that of the whole, and the solvers.
fn straight(
    specimen: &Specimen,
    mesh: SolidMesh,
    pressure: f64,
    loads: [f64; 2],
) -> (SolidSolver, SolidState, StraightRod) {
    let mut sector = SolidSolver::sector(specimen, mesh).unwrap();
    let rest = sector.rest();
    let load = |part: f64| along(part * pressure, loads.map(|load| part * load));
    let state = sector.follow(&rest, 0.0, &[1.0], &load, &mut |_, _| true).unwrap();
    let whole = SolidSolver::new(specimen, mesh).unwrap();
    let all = whole.whole_of(&sector, &state).unwrap();
    let rod = StraightRod {
        length: specimen.tube.length,
        force: loads[0],
        torque: loads[1],
        stretch: sector.deformation(&state).stretch_mid,
        height: all.cap().0.z,
    };
    (whole, all, rod)
}

#[test]
fn compliance_is_the_slope_of_equilibria() {
    let winding = winding(30.0, Handedness::Right, 6, 0.15e-3);
    let specimen = specimen(20e-3, &[winding], 1e4);
    let torque = 1.5e-3;
    let mesh = SolidMesh::new(12, 14);
    let (mut solver, state, _) = straight(&specimen, mesh, 2e4, [0.4, torque]);
    let compliance = solver.tip_compliance(&state).unwrap();
    assert!(compliance.asymmetry() < 1e-12, "{:.1e}", compliance.asymmetry());
    // Differences of second order: loads that move the tip by some micrometres.
    for direction in 0..6 {
        let size = if direction < 3 { 1e-3 } else { 1e-5 };
        let tip = |sign: f64| {
            let to = |part: f64| {
                let mut load = *state.load();
                let on = if direction < 3 { &mut load.force } else { &mut load.moment };
                on[direction % 3] += part * sign * size;
                load
            };
            let found = solver.follow(&state, 0.0, &[1.0], &to, &mut |_, _| true).unwrap();
            let (cap, rotation) = found.cap();
            let turn = (rotation * state.cap().1.inverse()).scaled_axis();
            let shift = cap - state.cap().0;
            Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
        };
        let mut tip = tip;
        let slope = (tip(1.0) - tip(-1.0)) / (2.0 * size);
        // The torque of the state stays where it is in space, and the compliance is for one that turns by half.
        let mut load = Vector6::ith(direction, 1.0);
        let turn: Vector3<f64> = slope.fixed_rows::<3>(3).into();
        let mut moment = load.fixed_rows_mut::<3>(3);
        moment -= turn.cross(&Vector3::z()) * (0.5 * torque);
        let expected = compliance.matrix * load;
        for i in 0..6 {
            let scale = (compliance.matrix[(i, i)] * compliance.matrix[(direction, direction)]).sqrt();
            let off = (slope[i] - expected[i]).abs() / scale;
            assert!(off < 2e-6, "{direction} {i}: {} {}", slope[i], expected[i]);
        }
    }
}

#[test]
fn a_bare_tube_is_the_rod_of_the_textbook() {
    let mu = 1e6;
    let rod_of = |lengths: [f64; 2]| {
        let [a, b] = lengths.map(|length| {
            let mut bare = specimen(length, &[], 1e5);
            bare.elastomer = bare.elastomer.with_shear_modulus(mu);
            let mesh = SolidMesh { radial: 1, ..SolidMesh::new(12, (700.0 * length).round() as usize) };
            let (mut solver, state, rod) = straight(&bare, mesh, 0.0, [0.0; 2]);
            (rod, solver.tip_compliance(&state).unwrap())
        });
        let span = lengths[1] - lengths[0];
        let axial = [2, 5].map(|k| span / (b.1.matrix[(k, k)] - a.1.matrix[(k, k)]));
        (RodCompliance::identified([(&a.0, &a.1), (&b.0, &b.1)]).unwrap(), axial)
    };
    let (short, [stretching, twisting]) = rod_of([20e-3, 40e-3]);
    let (long, _) = rod_of([40e-3, 60e-3]);
    let (area, second) = (TUBE.wall_area(), TUBE.second_moment());
    // Poisson's ratio 1/2 (to 5e-6): E = 3 mu.
    assert!((stretching / (3.0 * mu * area) - 1.0).abs() < 1e-3, "{}", stretching / (3.0 * mu * area));
    assert!((twisting / (2.0 * mu * second) - 1.0).abs() < 1e-3, "{}", twisting / (2.0 * mu * second));
    let bending = long.bending_stiffness() / (3.0 * mu * second);
    assert!((bending - 1.0).abs() < 1e-3, "{bending}");
    // Shear coefficient of a hollow circle (Hutchinson, J. Appl. Mech. 68 (2001) 87) at nu = 1/2.
    let (a2, b2) = (TUBE.inner_radius.powi(2), TUBE.outer_radius().powi(2));
    let (fourth, mixed) = (a2 * a2 + b2 * b2, a2 * b2);
    let divisor = 7.0 * fourth + 34.0 * mixed + 6.0 * fourth + 24.0 * mixed + fourth + 4.0 * mixed;
    let coefficient = 6.0 * (a2 + b2).powi(2) * 2.25 / divisor;
    let shear = long.shear_stiffness() / (mu * area);
    assert!((shear / coefficient - 1.0).abs() < 2e-3, "{shear} {coefficient}");
    assert!(long.coupling.abs() < 1e-6 * (long.bending * long.shear).sqrt(), "{long:?}");
    // Two diameters of length are enough.
    assert!((short.bending / long.bending - 1.0).abs() < 1e-4, "{short:?} {long:?}");
    assert!((short.folded(1.0).shear / long.folded(1.0).shear - 1.0).abs() < 1e-3, "{short:?} {long:?}");
    // Caps hold the tube round and stiffen it by less than a tenth of its radius.
    assert!(long.stiff_length() > 0.0 && long.stiff_length() < 0.1 * TUBE.outer_radius());
}

#[test]
fn axial_loads_leave_the_sections_alone_but_for_what_they_do_to_them() {
    // The same sections from tubes of other lengths, though a pull or a thrust straightens or bends a long one much more; and past
    // the buckling load of the longer one (0.57 N at 40 mm).
    let winding = winding(40.0, Handedness::Right, 6, 0.15e-3);
    let sections = |lengths: [f64; 2], loads: [f64; 2]| {
        let [a, b] = lengths.map(|length| {
            let mesh = SolidMesh::new(12, (700.0 * length).round() as usize);
            let (mut solver, state, rod) = straight(&specimen(length, &[winding], 1e4), mesh, 2e4, loads);
            (rod, solver.tip_compliance(&state).unwrap())
        });
        let found = RodCompliance::identified([(&a.0, &a.1), (&b.0, &b.1)]).unwrap();
        let folded = found.folded(b.0.stretch);
        [folded.bending, folded.shear, folded.coupling * (folded.bending / folded.shear).sqrt()]
    };
    for loads in [[0.0, 0.0], [-0.8, 0.0], [0.8, 2e-3]] {
        let [short, long] = [[20e-3, 40e-3], [30e-3, 60e-3]].map(|lengths| sections(lengths, loads));
        for (a, b) in short.iter().zip(&long) {
            assert!((a - b).abs() < 0.01 * long[0].max(b.abs()), "{loads:?}: {short:?} {long:?}");
        }
        assert!((short[0] / long[0] - 1.0).abs() < 2e-3, "{loads:?}: {short:?} {long:?}");
    }
}

#[test]
fn threads_along_a_tube_are_found_to_couple_bending_and_shear() {
    let winding = winding(75.0, Handedness::Right, 6, 0.15e-3);
    for pressure in [1e3, 1.5e4, 4e4] {
        let [short, long] = [[20e-3, 40e-3], [40e-3, 70e-3]].map(|lengths: [f64; 2]| {
            let [a, b] = lengths.map(|length: f64| {
                let mesh = SolidMesh::new(12, (700.0 * length).round() as usize);
                let (mut solver, state, rod) =
                    straight(&specimen(length, &[winding], 1e4), mesh, pressure, [0.0; 2]);
                (rod, solver.tip_compliance(&state).unwrap())
            });
            let found = RodCompliance::identified([(&a.0, &a.1), (&b.0, &b.1)]).unwrap();
            found.folded(b.0.stretch)
        });
        let share = |rod: &RodCompliance| rod.coupling / (rod.bending * rod.shear).sqrt();
        assert!(
            share(&long) > 0.75 && (share(&short) / share(&long) - 1.0).abs() < 0.02,
            "{pressure}: {short:?} {long:?}"
        );
        assert!((short.bending / long.bending - 1.0).abs() < 0.01, "{pressure}: {short:?} {long:?}");
    }
}

#[test]
fn a_tip_that_cannot_bend_has_no_compliance() {
    let specimen = specimen(10e-3, &[], 1e4);
    let mesh = SolidMesh::new(12, 4);
    let mut sector = SolidSolver::sector(&specimen, mesh).unwrap();
    let rest = sector.rest();
    assert!(matches!(sector.tip_compliance(&rest), Err(SolidError::Invalid { .. })));
    let mut whole = SolidSolver::new(&specimen, mesh).unwrap();
    let held = SolidLoad { held: [true; 6], ..SolidLoad::default() };
    let rest = whole.follow(&rest_of(&whole), 0.0, &[1.0], &|_| held, &mut |_, _| true).unwrap();
    assert!(whole.tip_compliance(&rest).unwrap_err().to_string().contains("held"));
    let other = SolidSolver::new(&specimen, SolidMesh::new(12, 6)).unwrap();
    assert!(other.whole_of(&sector, &sector.rest()).is_err());
}

fn rest_of(solver: &SolidSolver) -> SolidState {
    solver.rest()
}
