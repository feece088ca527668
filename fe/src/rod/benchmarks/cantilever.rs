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
    // Not beyond a circle: closed, it may turn about its clamped tangent without effort, and the tangent is singular.
    for (turns, elements) in [(0.5, 3), (0.98, 20), (1.0, 20)] {
        let moment = bending(&module.frees[0].free) * 2.0 * PI * turns / length;
        let tip_load = TipLoad { force: [0.0; 3], moment: [0.0, moment, 0.0] };
        let rods = linear(&module, STIFF, RodSettings { elements, tip_load, ..RodSettings::default() });
        let chart = rods.rest().unwrap().state.chart;
        // Constant strain: exact for any number of elements, up to the residual's tolerance.
        assert!((chart.bend[1] - 2.0 * PI * turns).abs() < 1e-7, "{chart:?}");
        let x = length * (1.0 - (2.0 * PI * turns).cos()) / (2.0 * PI * turns);
        assert!((chart.position[0] - x).abs() < 1e-7 * length, "{chart:?}");
        let z = length * (2.0 * PI * turns).sin() / (2.0 * PI * turns);
        assert!((chart.position[2] - z).abs() < 1e-7 * length);
    }
}

/// Stiffnesses of a rod in a plane.
#[derive(Clone, Copy)]
struct Planar {
    bending: f64,
    shear: f64,
    axial: f64,
    length: f64,
}

impl Planar {
    /// Place (x, z) and rotation of the tip of a cantilever along z under a dead force (across, along), by integration (Runge and Kutta, 2000
    /// steps) of `t' = M/EI, (x, z)' = R(t) (V/GA, 1 + N/EA), M' = -(z' F_x - x' F_z)`, with the moment at the base found by secants so that
    /// there is none at the tip.
    fn tip(&self, [fx, fz]: [f64; 2]) -> [f64; 3] {
        let slope = |[fx, fz]: [f64; 2], [_, _, angle, moment]: [f64; 4]| -> [f64; 4] {
            let (sine, cosine) = angle.sin_cos();
            let (normal, across) = (fx * sine + fz * cosine, fx * cosine - fz * sine);
            let (stretch, shear) = (1.0 + normal / self.axial, across / self.shear);
            let (x, z) = (stretch * sine + shear * cosine, stretch * cosine - shear * sine);
            [x, z, moment / self.bending, -(z * fx - x * fz)]
        };
        let shoot = |force: [f64; 2], base: f64| -> [f64; 4] {
            let slope = |y: [f64; 4]| slope(force, y);
            let steps = 2000;
            let h = self.length / f64::from(steps);
            let mut y = [0.0, 0.0, 0.0, base];
            let add = |y: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
            for _ in 0..steps {
                let a = slope(y);
                let b = slope(add(y, a, 0.5 * h));
                let c = slope(add(y, b, 0.5 * h));
                let d = slope(add(y, c, h));
                y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
            }
            y
        };
        // The force is raised in steps; the arm of the moment at the base is the next guess.
        let mut arm = self.length;
        let mut tip = [0.0; 4];
        for part in (1..=10).map(|step| f64::from(step) / 10.0) {
            let shoot = |arm: f64| shoot([part * fx, part * fz], part * fx * arm);
            let (mut a, mut b) = (0.99 * arm, arm);
            let (mut at_a, mut at_b) = (shoot(a)[3], shoot(b)[3]);
            for _ in 0..30 {
                if at_b.abs() < 1e-12 * part * fx * self.length {
                    break;
                }
                let next = b - at_b * (b - a) / (at_b - at_a);
                (a, at_a) = (b, at_b);
                (b, at_b) = (next, shoot(next)[3]);
            }
            (arm, tip) = (b, shoot(b));
        }
        let [x, z, angle, moment] = tip;
        assert!(moment.abs() < 1e-9 * fx * self.length, "{moment}");
        [x, z, angle]
    }

    fn rods(&self, [fx, fz]: [f64; 2], elements: usize) -> [f64; 3] {
        let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
        module.tip.free_dof = [true, false, true, false, true, false];
        assert_eq!(module.length(), self.length);
        let section = Linear { axial: self.axial, torsion: 1e-3, area: 0.0, arm: 0.0 };
        let bending = ConstantBending { bending: self.bending, coupling: 0.0, shear: self.shear };
        let law = RodLaw { section: Arc::new(section), bending: Arc::new(bending) };
        let tip_load = TipLoad { force: [fx, 0.0, fz], moment: [0.0; 3] };
        let settings = RodSettings { elements, tip_load, ..RodSettings::default() };
        let chart = RodModule::new(&module, vec![law], settings).unwrap().rest().unwrap().state.chart;
        [chart.position[0], chart.position[2], chart.bend[1]]
    }
}

#[test]
fn a_force_at_the_tip_is_met_with_second_order() {
    let (ei, length) = (4e-4, 0.175);
    let unit = ei / (length * length);
    // Slender first: the elastica, x = 0.4935 L, z = (1 - 0.1606) L at F L^2/EI = 2 (Bisshopp and Drucker 1945), F L^2/EI = 10: x = 0.8106 L.
    let slender = Planar { bending: ei, shear: 1e6 * unit, axial: 1e6 * unit, length };
    for (load, x, z) in [(2.0, 0.49346, 1.0 - 0.16064), (10.0, 0.81061, 1.0 - 0.55500)] {
        let tip = slender.tip([load * unit, 0.0]);
        assert!((tip[0] / length - x).abs() < 2e-5 && (tip[1] / length - z).abs() < 2e-5, "{tip:?}");
    }
    // Across and along, with shear and stretch that matter.
    let free = Planar { shear: 800.0 * unit, axial: 2000.0 * unit, ..slender };
    let stout = Planar { shear: 40.0 * unit, axial: 60.0 * unit, ..slender };
    for (planar, force) in [(free, [2.0, 0.0]), (free, [8.0, 0.0]), (stout, [2.0, 0.0]), (stout, [3.0, 1.5])]
    {
        let force = force.map(|part| part * unit);
        let exact = planar.tip(force);
        let [coarse, fine] = [10, 20].map(|elements| planar.rods(force, elements));
        for k in 0..3 {
            let (first, second) = (coarse[k] - exact[k], fine[k] - exact[k]);
            let size = if k < 2 { length } else { 1.0 };
            assert!(second.abs() < 5e-3 * size, "{k}: {fine:?} {exact:?}");
            // An error that crosses zero near here shows no order.
            if second.abs() > 1e-5 * size {
                let order = (first / second).log2();
                assert!((order - 2.0).abs() < 0.1, "{k}: {order}, {first:.1e} {second:.1e}");
            }
            let left = (4.0 * second - first) / 3.0;
            assert!(left.abs() < 2e-5 * size, "{k}: {left:.1e}");
        }
    }
}
