//! A cantilever bent far.

use crate::{
    ConstantBending,
    rod::{specimens::*, *},
};
use actuator::Handedness;
use std::{f64::consts::PI, sync::Arc};

#[test]
fn end_moment_bends_a_cantilever_to_a_circle() {
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    // In the plane x, z: the bend may pass half a turn there.
    module.tip.free_dof = [true, false, true, false, true, false];
    let length = module.length();
    for turns in [0.5, 1.0] {
        let moment = bending(&module.frees[0].free) * 2.0 * PI * turns / length;
        let tip_load = TipLoad { force: [0.0; 3], moment: [0.0, moment, 0.0] };
        let rods = linear(&module, STIFF, RodSettings { tip_load, ..RodSettings::default() });
        let chart = rods.rest().unwrap().state.chart;
        // Constant strain: exact for any number of elements, up to the residual's tolerance.
        assert!((chart.bend[1] - 2.0 * PI * turns).abs() < 1e-7, "{chart:?}");
        let x = length * (1.0 - (2.0 * PI * turns).cos()) / (2.0 * PI * turns);
        assert!((chart.position[0] - x).abs() < 1e-7 * length, "{chart:?}");
        assert!(chart.position[2].abs() < 1e-7 * length);
    }
}

#[test]
fn cantilever_converges_with_second_order() {
    // Tip force across: large deflection, F L^2/EI = 2. So soft in bending that shear and stretch do not matter.
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = [true, false, true, false, true, false];
    let free = module.frees[0].free;
    let ei = 0.01 * bending(&free);
    let soft = ConstantBending { bending: ei, ..ConstantBending::of_bare_tube(&free) };
    let tip_load = TipLoad { force: [2.0 * ei / module.length().powi(2), 0.0, 0.0], moment: [0.0; 3] };
    let tip = |elements: usize| {
        let law = RodLaw { section: Arc::new(STIFF), bending: Arc::new(soft) };
        let settings = RodSettings { elements, tip_load, ..RodSettings::default() };
        let rods = RodModule::new(&module, vec![law], settings).unwrap();
        rods.rest().unwrap().state.chart.position[0]
    };
    let [coarse, middle, fine] = [5, 10, 20].map(tip);
    let order = ((coarse - middle) / (middle - fine)).log2();
    assert!((order - 2.0).abs() < 0.05, "{order}");
    // Elastica (Bisshopp and Drucker): 0.4935 L at F L^2/EI = 2; shear adds F/GA = 3e-5.
    let limit = (fine + (fine - middle) / 3.0) / module.length();
    assert!((limit - 0.4935).abs() < 1e-4, "{limit}");
}
