use super::{specimens::*, *};
use crate::ThickTube;
use actuator::{Base, Free, Handedness, Module, PoseChart, TipPose, Wrench, units::STANDARD_GRAVITY};
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Three FREEs of two angles and hands about a centre that is not their mean, with weight.
fn tripod(spacers: u32) -> Module {
    use Handedness::{Left, Right};
    let mut module = module(vec![
        at(free(30.0, Right), 9e-3, 0.0),
        at(free(30.0, Left), -6e-3, 8e-3),
        at(free(60.0, Left), -5e-3, -7e-3),
    ]);
    module.spacers = spacers;
    module.base = Base { gravity: [0.0, 0.6, 0.8], free_mass: 5e-3 };
    module
}

/// So low that no FREE buckles under its own thrust: a sum of buckled states would depend on the way there.
const PRESSURES: [f64; 3] = [6e3, 4e3, 5e3];

/// A pose near rest, moved by a shift (m) and a turn (rad) about the base frame's axes through its centre.
fn pose(moved: [f64; 6]) -> PoseChart {
    let [x, y, z, rx, ry, rz] = moved;
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(rx, ry, rz));
    let rotation = turn * UnitQuaternion::from_scaled_axis(Vector3::new(0.05, -0.08, -0.3));
    let position = Vector3::new(3e-3, -2e-3, 0.178) + Vector3::new(x, y, z);
    PoseChart::from_pose(&TipPose { position, rotation }, 0.0)
}

fn coarse() -> RodSettings {
    RodSettings { elements: 6, ..RodSettings::default() }
}

fn total(found: &Equilibrium) -> [f64; 6] {
    found.wrenches.iter().copied().sum::<Wrench>().to_array()
}

fn unit(i: usize, step: f64) -> [f64; 6] {
    let mut moved = [0.0; 6];
    moved[i] = step * size(i);
    moved
}

/// Size of unit motion i.
fn size(i: usize) -> f64 {
    if i < 3 { 1e-4 } else { 1e-3 }
}

#[test]
fn wrench_is_minus_the_gradient_of_the_energy_in_the_pose() {
    for spacers in [0, 3] {
        let rods = analytic(&tripod(spacers), coarse());
        let at = |moved: [f64; 6]| rods.held(&pose(moved)).unwrap().solve(&PRESSURES).unwrap();
        let found = at([0.0; 6]);
        assert_eq!(found.state.negative_pivots, 0);
        assert_eq!(found.wrenches.len(), if spacers == 0 { 3 } else { 1 });
        let given = total(&found);
        for (i, given) in given.into_iter().enumerate() {
            let energy = |step: f64| at(unit(i, step)).energy;
            let slope =
                (energy(-2.0) - 8.0 * energy(-1.0) + 8.0 * energy(1.0) - energy(2.0)) / (12.0 * size(i));
            // Fourth order, of forces that change by 3 N over a tenth of a millimetre where threads are taut.
            assert!((given + slope).abs() < 1e-5 * (1.0 + given.abs()), "{i}: {given} {slope}");
        }
    }
}

#[test]
fn slopes_with_pressure_are_differences_and_reciprocal_to_volumes() {
    for spacers in [0, 3] {
        let rods = analytic(&tripod(spacers), coarse());
        let held = rods.held(&pose([0.0; 6])).unwrap();
        let found = held.solve(&PRESSURES).unwrap();
        for free in 0..3 {
            let with = |held: &HeldModule, step: f64| {
                let mut pressures = PRESSURES;
                pressures[free] += step;
                held.solve_from(held.unpressurised(), &pressures).unwrap()
            };
            let by_pressure = |step: f64| total(&with(&held, step));
            // Threads tighten within a kilopascal: short steps.
            let (above, below) = (by_pressure(20.0), by_pressure(-20.0));
            let exact = found.wrench_slopes[free].to_array();
            for i in 0..6 {
                let slope = (above[i] - below[i]) / 40.0;
                let arm = if i < 3 { 5e-3f64 } else { 1.0 };
                // A square of the radius is the unit of a force per pressure, its cube of a moment.
                let scale = PI * 5e-3f64.powi(3) / arm;
                assert!((slope - exact[i]).abs() < 1e-4 * scale, "{free} {i}: {slope} {}", exact[i]);
                // The volume that the FREE gains where the plate moves is the force that its pressure gives: d2E/dp dx.
                let volume = |step: f64| {
                    let held = rods.held(&pose(unit(i, step))).unwrap();
                    (with(&held, -100.0).energy - with(&held, 100.0).energy) / 200.0
                };
                let gained = (volume(0.5) - volume(-0.5)) / size(i);
                assert!((gained - exact[i]).abs() < 3e-3 * scale, "{free} {i}: {gained} {}", exact[i]);
            }
        }
    }
}

#[test]
fn stiffness_of_the_held_plate_is_reciprocal() {
    let rods = analytic(&tripod(0), coarse());
    let at = |moved: [f64; 6]| total(&rods.held(&pose(moved)).unwrap().solve(&PRESSURES).unwrap());
    let columns: Vec<[f64; 6]> = (0..6)
        .map(|j| {
            let (above, below) = (at(unit(j, 0.1)), at(unit(j, -0.1)));
            std::array::from_fn(|i| (above[i] - below[i]) / 0.2 * size(i))
        })
        .collect();
    let greatest = columns.iter().flatten().fold(0.0f64, |most, value| most.max(value.abs()));
    // Shifts commute with shifts and with turns; two turns do not, and the moment that acts shows in their difference.
    for i in 0..3 {
        for j in 0..6 {
            assert!((columns[j][i] - columns[i][j]).abs() < 1e-5 * greatest, "{i} {j}: {columns:?}");
        }
    }
}

#[test]
fn a_plate_held_where_it_would_be_free_takes_its_weight_only() {
    for spacers in [0, 3] {
        let mut module = tripod(spacers);
        module.tip.plate_mass = 0.02;
        let rods = analytic(&module, coarse());
        let free = rods.solve(&PRESSURES).unwrap();
        let held = rods.held(&free.state.chart).unwrap().solve(&PRESSURES).unwrap();
        let given = total(&held);
        let weight = 0.02 * STANDARD_GRAVITY;
        let expected = [0.0, -0.6 * weight, -0.8 * weight, 0.0, 0.0, 0.0];
        for i in 0..6 {
            assert!((given[i] - expected[i]).abs() < 1e-7, "{given:?} {expected:?}");
        }
        // And the equilibrium that is free says the same.
        for (a, b) in given.iter().zip(total(&free)) {
            assert!((a - b).abs() < 1e-7, "{given:?}");
        }
    }
}

/// On a straight FREE beside the plate's centre the wrench is that of its section, with the arm's moment.
#[test]
fn a_straight_free_gives_what_its_section_does() {
    let (x, y) = (8e-3, -3e-3);
    let own: Free = free(40.0, Handedness::Left);
    let rods = analytic(&module(vec![at(own, x, y)]), coarse());
    let rest = PoseChart { twist: 0.0, bend: [0.0; 2], position: [0.0, 0.0, own.tube.length] };
    let found = rods.held(&rest).unwrap().solve(&[4e4]).unwrap();
    let section = ThickTube::new(&own).section(4e4, 1.0, 0.0).unwrap();
    let (force, torque) = (-section.force, section.torque);
    let expected = [0.0, 0.0, force, y * force, -x * force, torque];
    for (given, expected) in total(&found).into_iter().zip(expected) {
        assert!((given - expected).abs() < 1e-9, "{found:?} {expected}");
    }
}
