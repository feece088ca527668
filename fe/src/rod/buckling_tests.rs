//! Where modules buckle, how, and where they go then.

use super::{specimens::*, *};
use crate::ConstantBending;
use actuator::Handedness;
use nalgebra::Vector3;
use std::{f64::consts::PI, sync::Arc};

/// A FREE between held plates that pressure would lengthen: a column under the thrust p times the law's area.
fn column(elements: usize) -> (RodModule, f64) {
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = [false; 6];
    let free = module.frees[0].free;
    let law = Linear { axial: 1e3, torsion: 1e-3, area: 7e-5, arm: 0.0 };
    let (ei, ga) = (bending(&free), 10.0 * MU * free.tube.wall_area());
    let bending = ConstantBending { bending: ei, coupling: 0.0, shear: ga };
    let law = RodLaw { section: Arc::new(law), bending: Arc::new(bending) };
    let settings = RodSettings { elements, ..RodSettings::default() };
    let rods = RodModule::new(&module, vec![law], settings).unwrap();
    let euler = 4.0 * PI * PI * ei / module.length().powi(2);
    // Shear in series (Engesser).
    (rods, 1.0 / (1.0 / euler + 1.0 / ga) / 7e-5)
}

#[test]
fn a_held_free_buckles_to_a_cosine_at_eulers_load() {
    let off = |elements: usize| {
        let (rods, expected) = column(elements);
        let rest = rods.rest().unwrap();
        assert!(rods.first_buckling(&rest, &[0.9 * expected], 1.0).unwrap().is_none());
        let found = rods.first_buckling(&rest, &[1.5 * expected], 1e-4 * expected).unwrap().unwrap();
        assert!(!found.below.state.is_buckled() && found.above.state.is_buckled());
        assert!(found.above.pressures[0] - found.below.pressures[0] < 1.01e-4 * expected);
        // Nothing is left of the tangent along the mode, and the plate stays.
        let mode = &found.mode;
        assert!(mode.value < 0.0 && mode.value > -1e-6, "{}", mode.value);
        assert_eq!((mode.tip_shift, mode.shifts()), ([0.0; 3], vec![1.0]));
        let line = &mode.centrelines[0];
        let middle = Vector3::from(line[elements / 2]);
        for (k, shift) in line.iter().enumerate() {
            let shape = 0.5 * (1.0 - (2.0 * PI * k as f64 / elements as f64).cos());
            // Helicoidal elements of a cosine: second order.
            assert!((Vector3::from(*shift) - middle * shape).norm() < 4.0 / (elements * elements) as f64);
        }
        found.above.pressures[0] / expected - 1.0
    };
    let [coarse, fine] = [12, 24].map(off);
    assert!((coarse / fine).log2() > 1.8 && fine.abs() < 0.01, "{coarse} {fine}");
}

/// A module that bends sideways under equal pressures comes to rest beside its axis, with less energy, on either side.
#[test]
fn a_buckled_module_settles_where_it_is_stable() {
    let rods = analytic(&left_right([0.0; 3]), RodSettings { elements: 10, ..RodSettings::default() });
    let found = rods.first_buckling(&rods.rest().unwrap(), &[6e4; 4], 50.0).unwrap().unwrap();
    let pressure = 1.05 * found.above.pressures[0];
    let straight = rods.solve(&[pressure; 4]).unwrap();
    let mode = rods.softest_mode(&straight).unwrap();
    assert!(straight.state.is_buckled() && mode.value < 0.0);
    let settled = [1e-3, -1e-3].map(|offset| rods.settle(&straight, &mode, offset).unwrap());
    for state in &settled {
        assert!(!state.state.is_buckled() && state.state.residual < 1e-10);
        assert!(state.energy < straight.energy - 1e-8, "{} {}", state.energy, straight.energy);
    }
    let gained = settled.each_ref().map(|state| straight.energy - state.energy);
    assert!((gained[0] / gained[1] - 1.0).abs() < 1e-6, "{gained:?}");
    // It stays there without the unstable path.
    let again = rods.solve_from(&settled[0], &[pressure * 1.01; 4]).unwrap();
    assert!(!again.state.is_buckled());
}

/// A guided plate between a FREE that lengthens and one that only holds it: the idle one is in tension, the other may buckle, and pressure in
/// the idle one takes the load off.
#[test]
fn idle_frees_need_pressure_from_where_the_module_buckles_on() {
    let mut module = left_right([0.0; 3]);
    module.tip.free_dof = [true, true, true, false, false, false];
    let law = Linear { axial: 300.0, torsion: 1e-3, area: 7e-5, arm: 0.0 };
    let rods = linear(&module, law, RodSettings { elements: 12, ..RodSettings::default() });
    let case = |pressure: f64| [pressure, 0.0, pressure, 0.0];
    let critical =
        rods.first_buckling(&rods.rest().unwrap(), &case(4e4), 20.0).unwrap().unwrap().above.pressures[0];
    let least = |pressure: f64| rods.least_idle_pressure(&case(pressure), pressure, 20.0).unwrap();
    assert_eq!(least(0.98 * critical), IdlePressure::NotNeeded);
    let IdlePressure::Least(idle) = least(1.05 * critical) else { panic!("{critical}") };
    assert!(rods.is_stable_with(&case(1.05 * critical), idle).unwrap());
    assert!(!rods.is_stable_with(&case(1.05 * critical), idle - 20.0).unwrap());
    // The thrust of a pair is (p - q) A/2: the difference of the pressures counts.
    assert!((idle - 0.05 * critical).abs() < 0.003 * critical, "{idle} {critical}");
}
