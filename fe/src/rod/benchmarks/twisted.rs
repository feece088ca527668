//! A straight rod twisted between clamps (Greenhill's problem with clamped ends).
//!
//! In complex rotation t = t_x + i t_y and shift w, with torque M, no axial force and a constant force F across: `EI t' - i M t = c - i F s`
//! and `w' = -i t + F/GA`, so that `t = A + F s/M + C exp(i M s/EI)`. Both ends clamped, t = 0. With the tip held, w vanishes too:
//! `tan b/2 = (b/2)/(1 + b^2 EI/(GA L^2))` for b = M L/EI; rigid in shear, b = 8.9868. With the tip free to move but not to tilt, F = 0 and
//! exp(i b) = 1: b = 2 pi. The torque does work on the
//! chart's twist, so it has an energy; twisted by an angle instead, the same b is reached at the angle b EI/GJ, because bending changes the
//! turn by its square only.

use crate::{
    ConstantBending,
    rod::{specimens::*, *},
};
use actuator::Handedness;
use std::{f64::consts::PI, sync::Arc};

/// GA L^2/EI: as of a FREE.
const SHEAR: f64 = 2e3;

/// Rod with a tip that may move as said, twisted by a torque M: the same at any M L/EI, for GA L^2/EI, GJ/EI, elements, and the torque's sign.
fn twisted(
    free_dof: [bool; 6],
    (shear, torsion): (f64, f64),
    elements: usize,
    hand: f64,
) -> impl Fn(f64) -> Equilibrium {
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = free_dof;
    let (length, ei) = (module.length(), 1e-4);
    let bending = ConstantBending { bending: ei, coupling: 0.0, shear: shear * ei / (length * length) };
    let section = Linear { axial: 30.0, torsion: torsion * ei, area: 0.0, arm: 0.0 };
    let law = RodLaw { section: Arc::new(section), bending: Arc::new(bending) };
    move |b: f64| {
        let tip_load = crate::TipLoad { force: [0.0; 3], moment: [0.0, 0.0, hand * b * ei / length] };
        let settings = RodSettings { elements, tip_load, bending_stiffness_scale: 1.0 };
        let found = RodModule::new(&module, vec![law.clone()], settings).unwrap().rest().unwrap();
        // Before it buckles it is straight and turns evenly, by more than one turn where torsion is soft.
        assert!((found.state.chart.twist - hand * b / torsion).abs() < 1e-8, "{found:?}");
        found
    }
}

/// Critical M L/EI by inertia, for GJ over EI.
fn critical(free_dof: [bool; 6], torsion: f64, elements: usize, hand: f64) -> f64 {
    let twisted = twisted(free_dof, (SHEAR, torsion), elements, hand);
    let is_stable = |b: f64| !twisted(b).state.is_buckled();
    let (mut low, mut high) = (4.0, 12.0);
    assert!(is_stable(low) && !is_stable(high));
    while high - low > 1e-7 {
        let middle = 0.5 * (low + high);
        if is_stable(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

fn converges(free_dof: [bool; 6], expected: f64) {
    for (torsion, hand) in [(2.0, 1.0), (0.7, -1.0)] {
        let [coarse, fine] = [64, 128].map(|elements| critical(free_dof, torsion, elements, hand));
        let order = ((coarse - expected) / (fine - expected)).log2();
        assert!((order - 2.0).abs() < 0.1, "GJ/EI {torsion}, order {order}: {coarse} {fine}");
        let left = (4.0 * fine - coarse) / 3.0 / expected - 1.0;
        assert!(left.abs() < 1e-4, "{left:.1e}");
    }
}

#[test]
fn with_its_tip_held() {
    // b/2 lies between pi and the least root of tan x = x beyond 0, by bisection of sin x - x cos x/(1 + 4 x^2 EI/(GA L^2)).
    let root = |shear: f64| {
        let (mut low, mut high) = (PI, 4.6);
        while high - low > 1e-12 {
            let x = 0.5 * (low + high);
            let off = x.sin() - x * x.cos() / (1.0 + 4.0 * x * x / shear);
            if off > 0.0 { low = x } else { high = x }
        }
        2.0 * low
    };
    assert!((root(f64::INFINITY) - 8.986818916).abs() < 1e-8);
    converges([false, false, true, false, false, true], root(SHEAR));
}

#[test]
fn with_a_tip_that_moves_but_does_not_tilt() {
    converges([true, true, true, false, false, true], 2.0 * PI);
}

/// A rod as good as rigid in shear: elimination has to keep what bending leaves of an element's stiffness. Of n elements of length l it
/// loses about 1e-16 n^3 (GA l^2/EI)^2 of it by rounding, 1e-4 here at worst, all at 1e8. A pair of pivots changes its sign at the critical torque, and none before.
#[test]
fn whatever_its_shear_stiffness() {
    for shear in [3e4, 3e5, 3e6] {
        for elements in [16, 64, 128] {
            let twisted = twisted([true, true, true, false, false, true], (shear, 2.0), elements, 1.0);
            // Elements bend too little by a twelfth of the square of their angle: 1.3 % of 16.
            let negative = [0.01, 0.5, 0.98, 1.03].map(|part| twisted(part * 2.0 * PI).state.negative_pivots);
            assert_eq!(negative, [0, 0, 0, 2], "GA L^2/EI {shear:e}, {elements} elements");
        }
    }
}
