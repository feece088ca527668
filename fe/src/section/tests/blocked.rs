use super::*;
use crate::SectionMesh;
use std::f64::consts::PI;

/// 48 degrees from the axis, six threads of this stiffness on a tube of outer radius 5 mm.
fn specimen(hand: Handedness, wall: f64, modulus: f64, stiffness: f64) -> Free {
    let fibre = Fibre { axial_stiffness: stiffness, diameter: 1.5e-4, law: FibreLaw::TensionOnly };
    Free {
        tube: Tube { length: 0.1, inner_radius: 5e-3 - wall, wall },
        winding: Winding::from_axis(48f64.to_radians(), hand, 6, fibre),
        elastomer: Elastomer::NeoHookean { shear_modulus: modulus },
    }
}

/// Spread over the whole surface, as the membrane of the formula is.
fn spread(mut free: Free) -> Free {
    free.winding.fibre.diameter = 2.0 * PI * free.tube.outer_radius();
    free
}

fn solver(free: &Free) -> SectionSolver {
    SectionSolver::new(free, SectionMesh::default()).unwrap()
}

#[test]
fn blocked_force_is_virtual_work_where_threads_do_not_stretch() {
    let (radius, pressure) = (5e-3f64, 1e4);
    let cot = 1.0 / 48f64.to_radians().tan();
    let force = pressure * PI * radius * radius * (1.0 - 2.0 * cot * cot);
    let torque = -pressure * 2.0 * PI * radius.powi(3) * cot;
    // As the rubber goes and as the threads grow stiff, whatever the wall: the error is what the threads give way, of first order
    // in p B/EA and in mu B t/EA.
    for wall in [0.5e-3, 1.5e-3] {
        let off = |modulus: f64, stiffness: f64| {
            let found = solver(&spread(specimen(Handedness::Right, wall, modulus, stiffness)))
                .blocked(pressure, 1.0, 0.0)
                .unwrap();
            [found.wrench.force[2] / force - 1.0, found.wrench.moment[2] / torque - 1.0]
        };
        let errors = [4.0, 16.0, 64.0].map(|factor| off(0.393e6, 644.0 * factor));
        for component in 0..2 {
            let [coarse, middle, fine] = errors.map(|error| error[component].abs());
            assert!((coarse / middle - 4.0).abs() < 0.3 && (middle / fine - 4.0).abs() < 0.1, "{errors:?}");
            assert!(fine < 2e-3, "{errors:?}");
        }
        let soft = off(0.393e3, 644.0 * 16.0);
        assert!(soft.iter().all(|error| error.abs() < 1e-3), "{soft:?}");
    }
}

#[test]
fn blocked_force_is_minus_the_gradient_of_the_energy() {
    for hand in [Handedness::Right, Handedness::Left] {
        let free = specimen(hand, 1e-3, 0.393e6, 644.0);
        let sign = hand.sign();
        let (pressure, stretch, twist) = (3e4, 1.03, -2.0 * sign);
        let mut solver = solver(&free);
        let mut energy =
            |p: f64, l: f64, t: f64| solver.respond(p, l, sign * t).map(|found| found.energy).unwrap();
        let (h, turn) = (1e-4, 1e-2);
        let by_stretch =
            (energy(pressure, stretch + h, twist) - energy(pressure, stretch - h, twist)) / (2.0 * h);
        let by_twist = (energy(pressure, stretch, twist + turn) - energy(pressure, stretch, twist - turn))
            / (2.0 * turn);
        let found = solver.blocked(pressure, stretch, twist).unwrap();
        let [force, torque] = [found.wrench.force[2], found.wrench.moment[2]];
        assert!((force + by_stretch).abs() < 1e-4 * by_stretch.abs(), "{force} {by_stretch}");
        assert!((torque + by_twist).abs() < 1e-4 * by_twist.abs(), "{torque} {by_twist}");
        let mut at = |p: f64| solver.blocked(p, stretch, twist).unwrap().wrench;
        let slope = (at(pressure + 50.0) - at(pressure - 50.0)) * 0.01;
        let difference = slope - found.slope;
        assert!(difference.force[2].abs() < 1e-4 * slope.force[2].abs(), "{slope:?} {:?}", found.slope);
        assert!(difference.moment[2].abs() < 1e-4 * slope.moment[2].abs(), "{slope:?} {:?}", found.slope);
    }
}

#[test]
fn a_free_state_gives_no_force() {
    let free = specimen(Handedness::Left, 1e-3, 0.393e6, 644.0);
    let mut solver = solver(&free);
    let path = solver.path(&[3e4], 0).unwrap();
    let near = |pressure: f64| (pressure - 3e4).abs() < 1e-3;
    let state = path.states.iter().find(|state| near(state.pressure)).unwrap();
    let found = solver.blocked(3e4, state.axial_stretch, state.twist_per_length).unwrap();
    let blocked = solver.blocked(3e4, 1.0, 0.0).unwrap();
    // The same path without the sign of the hand would be far from free.
    assert!(found.wrench.force[2].abs() < 1e-6 * blocked.wrench.force[2].abs(), "{found:?}");
    assert!(found.wrench.moment[2].abs() < 1e-6 * blocked.wrench.moment[2].abs(), "{found:?}");
    assert!(blocked.wrench.moment[2] > 0.0, "left-handed turns positive: {blocked:?}");
}
