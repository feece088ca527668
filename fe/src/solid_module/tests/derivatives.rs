//! What a module of solids says of its derivatives, against differences.

use super::*;
use crate::{TipLoad, solid_module::SolidShape, tip_plate::Plate};
use actuator::PoseChart;
use nalgebra::{Matrix6, Vector3, Vector6};

/// A pose far from equilibrium: bent, turned and shifted.
fn odd_pose() -> PoseChart {
    PoseChart { twist: -0.3, bend: [0.1, 0.06], position: [1e-3, -0.6e-3, 30.5e-3] }
}

#[test]
fn the_plates_forces_and_tangent_are_those_of_the_energy() {
    let mut module = solids(&unlike_pair(), [1, 12, 8]);
    let pressures = [1.5e4, 0.8e4];
    let rest = module.rest().unwrap().shape;
    let middle = module.hold(&rest, &odd_pose(), &pressures).unwrap();
    let plate = Plate::at_chart(&odd_pose());
    let tangent = module.tangent.as_ref().unwrap();
    let hessian: Matrix6<f64> = tangent.hessian;
    // What must act on the plate along its coordinates, from the force and moment on what holds it.
    let load = module.tip.load;
    let gradient = |held: &crate::HeldPlate| -> Vector6<f64> {
        let plate = held.shape.plate;
        let back = plate.frame().rotation.inverse();
        let given: Vector6<f64> = held.wrenches.iter().map(|wrench| Vector6::from(wrench.to_array())).sum();
        let own = crate::rigid_motion::joined(
            back * Vector3::from(given.fixed_rows::<3>(0)),
            back * Vector3::from(given.fixed_rows::<3>(3)),
        );
        -(plate.vary().first.transpose() * own) - load
    };
    // With the pressures, at rest.
    for free in 0..2 {
        let mut at = |step: f64| {
            let mut pressures = pressures;
            pressures[free] += step;
            let held = module.hold(&middle.shape, &odd_pose(), &pressures).unwrap();
            Vector6::from(held.wrenches[free].to_array())
        };
        let difference = (at(20.0) - at(-20.0)) / 40.0;
        let exact = Vector6::from(middle.wrench_slopes[free].to_array());
        for i in 0..6 {
            assert!(
                (difference[i] - exact[i]).abs() < 1e-5 * exact.fixed_rows::<3>(i / 3 * 3).norm(),
                "{free} {i}"
            );
        }
    }
    // Fourth order, and short: with 1e-5 m the axial stiffness still misses by 2e-5 of itself.
    let size = |i: usize| if i < 3 { 2e-6 } else { 4e-4 };
    let scale = |i: usize| if i < 3 { 1.0 } else { 5.56e-3 };
    let stiffness = hessian[(2, 2)];
    for i in 0..6 {
        let mut at = |times: f64| {
            let chart = Plate(plate.0 + Vector6::ith(i, times * size(i))).chart();
            module.hold(&middle.shape, &chart, &pressures).unwrap()
        };
        let four = [2.0, 1.0, -1.0, -2.0].map(&mut at);
        let slope =
            |values: [f64; 4]| (8.0 * (values[1] - values[2]) - (values[0] - values[3])) / (12.0 * size(i));
        let energies = slope([0, 1, 2, 3].map(|k| four[k].energy));
        let force = gradient(&middle)[i];
        assert!((energies - force).abs() < 1e-6 * scale(i), "{i}: {energies} {force}");
        for j in 0..6 {
            let difference = slope([0, 1, 2, 3].map(|k| gradient(&four[k])[j]));
            let off = (difference - hessian[(j, i)]).abs() / (scale(i) * scale(j) * stiffness);
            // Equilibria of 1e-9 of the forces leave some 1e-8 N on the plate, over a step of 2e-6 m: 1e-6 of the axial 7700 N/m.
            assert!(off < 5e-6, "{i} {j}: {difference} {} {off:.1e}", hessian[(j, i)]);
        }
    }
}

#[test]
fn slopes_with_pressures_and_payload_match_differences() {
    for (free_dof, moment) in [([true; 6], 0.0), ([true, false, true, true, true, false], 1e-3)] {
        let mut guided = unlike_pair();
        guided.tip.free_dof = free_dof;
        let tip_load = TipLoad { force: [0.0, 0.02, 0.0], moment: [0.0, moment, 0.0] };
        let settings = SolidModuleSettings { tip_load, ..settings([1, 12, 8]) };
        let mut solids = SolidModule::new(&guided, settings).unwrap();
        let pressures = [2e4, 0.7e4];
        let found = solids.solve(&pressures).unwrap();
        let chart = found.state.chart.to_array();
        for (k, free) in [(1, free_dof[3]), (2, free_dof[4]), (0, free_dof[5])] {
            assert_eq!(chart[k] != 0.0, free, "{chart:?}");
        }
        let close = |[ahead, behind]: [PoseChart; 2], step: f64, exact: [f64; 6], what: &str| {
            let largest = exact.iter().enumerate().map(|(k, x)| if k < 3 { 0.03 * x.abs() } else { x.abs() });
            let largest = largest.fold(0.0, f64::max);
            for (k, exact) in exact.into_iter().enumerate() {
                let difference = (ahead.to_array()[k] - behind.to_array()[k]) / (2.0 * step);
                let scale = largest / if k < 3 { 0.03 } else { 1.0 };
                let off = (difference - exact).abs() / scale;
                assert!(off < 1e-5, "{what} {k}: {difference} {} {off:.1e}", exact);
            }
        };
        let shape: &SolidShape = &found.shape;
        for free in 0..2 {
            let mut at = |step: f64| {
                let mut pressures = pressures;
                pressures[free] += step;
                solids.solve_from(shape, &pressures).unwrap().state.chart
            };
            close([at(20.0), at(-20.0)], 20.0, found.pressure_jacobian[free], "pressure");
        }
        let mut carrying = |mass: f64| solids.loaded(shape, mass).unwrap();
        close([carrying(1e-5), carrying(-1e-5)], 1e-5, found.state.slopes[0], "payload");
        // The mass is the module's own, wherever it is said.
        guided.tip.payload = 0.02;
        let heavy = SolidModule::new(&guided, settings).unwrap().solve(&pressures).unwrap().state.chart;
        let carried = solids.loaded(shape, 0.02).unwrap();
        for (a, b) in heavy.to_array().iter().zip(carried.to_array()) {
            assert!((a - b).abs() < 1e-7, "{heavy:?} {carried:?}");
        }
    }
}
