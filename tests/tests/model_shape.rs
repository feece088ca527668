//! Models keep the shape of the finite elements between the states that they were fitted to.

use actuator::{Description, FreeParameter, MapAxis, Rig, units::*};
use fe::{FreeSweep, Run, Shard};
use freeact_tests::data;
use rom::FreeModel;
use std::sync::atomic::AtomicBool;

/// Wherever stretch, expansion or twist of the sections rises from one state to the next, the model's does all the way between, and
/// falls where it falls: at the fitted windings and between them. Next to a state where the sections turn round nothing is asked.
#[test]
fn the_model_is_monotone_where_the_sections_are() {
    let rig = Rig::read(&data("actuators/buffinton-2020.toml")).expect("the paper's FREE");
    let Description::Free(free) = rig.description else { panic!("a FREE") };
    let angles: Vec<f64> = (2..=7).map(|ten| f64::from(10 * ten) * DEG).collect();
    let axes = vec![MapAxis { parameter: FreeParameter::WindingAngle, values: angles }];
    let pressures: Vec<f64> = (0..=35).map(|k| 2.0 * f64::from(k) * KPA).collect();
    let sweep = FreeSweep { checks: 4, ..FreeSweep::default() };
    let mut map = sweep.empty_map(free.into(), axes, pressures, Default::default()).expect("a map");
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    sweep.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).expect("a full map");
    let model = FreeModel::fit(&map).expect("a model");

    let (mut judged, mut turning) = (0, 0);
    let fitted = map.paths.iter().flatten().enumerate().map(|(k, path)| (map.winding_angles()[k], path));
    let held_out = map.checks.iter().map(|(node, path)| (node.free.winding.angle_from_hoop(), path));
    for (angle, path) in fitted.chain(held_out) {
        let of = |state: &actuator::FreeState| [state.axial_stretch, state.expansion, state.twist_per_length];
        let greatest = model.greatest_pressure(angle, free.elastomer.shear_modulus()).expect("inside");
        for four in path.states.windows(4).filter(|four| four[2].pressure < greatest) {
            let changes: [[f64; 3]; 3] = std::array::from_fn(|k| {
                std::array::from_fn(|output| of(&four[k + 1])[output] - of(&four[k])[output])
            });
            for share in [0.05, 0.3, 0.5, 0.7, 0.95] {
                let pressure = four[1].pressure + share * (four[2].pressure - four[1].pressure);
                let here = model.evaluate(pressure, angle, free.elastomer.shear_modulus()).expect("inside");
                for output in 0..3 {
                    let [before, within, after] = changes.map(|change| change[output]);
                    if before * within <= 0.0 || within * after <= 0.0 {
                        turning += 1;
                        continue;
                    }
                    judged += 1;
                    assert!(
                        here.jacobian[0][output] * within > 0.0,
                        "output {output} at {:.2} deg and {:.3} kPa turns between states",
                        angle / DEG,
                        pressure / KPA
                    );
                }
            }
        }
    }
    println!("{judged} slopes judged, {turning} next to a turn");
    assert!(judged > 3000 && turning < judged / 20, "{judged} slopes were judged, {turning} were not");
}
