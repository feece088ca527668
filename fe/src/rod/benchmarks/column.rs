//! A straight column under a dead load along its axis.
//!
//! With the stretch s = 1 - P/EA before buckling, rotation t and shift w: `w' = (s + P/GA) t` where no force acts across, and
//! `EI t'' = -P w'`. So `P (1 - P/EA + P/GA) = EI k^2`, Haringx' correction for shear with one for the stretch; k L is pi/2 for a free tip,
//! pi for one that slides without turning, 2 pi for one that only comes nearer.

use crate::{
    ConstantBending,
    rod::{specimens::*, *},
};
use actuator::Handedness;
use std::{f64::consts::PI, sync::Arc};

/// Critical load by inertia, over that expected.
fn critical(free_dof: [bool; 6], turns: f64, elements: usize) -> f64 {
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = free_dof;
    let (length, ei) = (module.length(), 1e-4);
    let euler = ei * (turns * PI / length).powi(2);
    // So soft that neither correction is small.
    let (axial, shear) = (20.0 * euler, 6.0 * euler);
    let bending = ConstantBending { bending: ei, coupling: 0.0, shear };
    let section = Linear { axial, torsion: 1e-3, area: 0.0, arm: 0.0 };
    let law = RodLaw { section: Arc::new(section), bending: Arc::new(bending) };
    let c = 1.0 / shear - 1.0 / axial;
    let expected = ((1.0 + 4.0 * c * euler).sqrt() - 1.0) / (2.0 * c);
    assert!(expected < 0.91 * euler);
    let is_stable = |load: f64| {
        let tip_load = crate::TipLoad { force: [0.0, 0.0, -load], moment: [0.0; 3] };
        let settings = RodSettings { elements, tip_load, bending_stiffness_scale: 1.0 };
        !RodModule::new(&module, vec![law.clone()], settings).unwrap().rest().unwrap().state.is_buckled()
    };
    let (mut low, mut high) = (0.8 * expected, 1.25 * expected);
    assert!(is_stable(low) && !is_stable(high));
    while high - low > 1e-9 * expected {
        let middle = 0.5 * (low + high);
        if is_stable(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high) / expected
}

fn converges(free_dof: [bool; 6], turns: f64) {
    let [coarse, fine] = [10, 20].map(|elements| critical(free_dof, turns, elements) - 1.0);
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() < 0.1, "order {order}: {coarse:.2e} {fine:.2e}");
    // What the second order leaves is of the fourth.
    let left = (4.0 * fine - coarse) / 3.0;
    assert!(left.abs() < 0.05 * fine.abs(), "{left:.2e} {fine:.2e}");
}

#[test]
fn with_a_free_tip() {
    converges([true; 6], 0.5);
}

#[test]
fn with_a_tip_that_slides_but_does_not_turn() {
    converges([true, false, true, false, false, false], 1.0);
}

#[test]
fn with_a_tip_that_only_comes_nearer() {
    converges([false, false, true, false, false, true], 2.0);
}
