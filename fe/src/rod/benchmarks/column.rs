//! A straight column under a load along its axis.

use crate::rod::{specimens::*, *};
use actuator::Handedness;
use std::f64::consts::PI;

#[test]
fn a_clamped_rod_buckles_at_euler_load() {
    // Both ends clamped, the tip free to slide sideways: P = pi^2 EI/L^2, as is known for a rod with a guided end.
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = [true, false, true, false, false, false];
    let (length, ei) = (module.length(), bending(&module.frees[0].free));
    let shear = MU * module.frees[0].free.tube.wall_area();
    let negative = |load: f64, elements: usize| {
        let tip_load = TipLoad { force: [0.0, 0.0, -load], moment: [0.0; 3] };
        let rods = linear(&module, STIFF, RodSettings { elements, tip_load, bending_stiffness_scale: 1.0 });
        rods.rest().unwrap().state.negative_pivots
    };
    let euler = PI * PI * ei / (length * length);
    // With shear stiffness in series (Engesser): 1/P = 1/P_Euler + 1/GA.
    let expected = 1.0 / (1.0 / euler + 1.0 / shear);
    let critical = |elements: usize| {
        let (mut low, mut high) = (0.5 * euler, 1.5 * euler);
        assert_eq!(negative(low, elements), 0);
        assert_eq!(negative(high, elements), 1);
        while high - low > 1e-6 * euler {
            let middle = 0.5 * (low + high);
            if negative(middle, elements) == 0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let [coarse, fine] = [10, 20].map(|elements| critical(elements) / expected - 1.0);
    // The mesh errs with 1/n^2; what is left of it is the axial shortening P/EA of 1e-6 and Engesser's own order (P/GA)^2.
    assert!((coarse / fine - 4.0).abs() < 0.4, "{coarse} {fine}");
    assert!(((4.0 * fine - coarse) / 3.0).abs() < 1e-3, "{coarse} {fine}");
}

#[test]
fn a_fully_clamped_rod_buckles_inside() {
    // Clamped ends that do not slide sideways: 4 pi^2 EI/L^2, in both planes at once, and in the inner nodes alone.
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = [false, false, true, false, false, true];
    let euler = 4.0 * PI * PI * bending(&module.frees[0].free) / module.length().powi(2);
    for (part, negative) in [(0.85, 0), (1.15, 2)] {
        let tip_load = TipLoad { force: [0.0, 0.0, -part * euler], moment: [0.0; 3] };
        let rods = linear(&module, STIFF, RodSettings { tip_load, elements: 16, ..RodSettings::default() });
        assert_eq!(rods.rest().unwrap().state.negative_pivots, negative, "{part}");
    }
}
