//! Section laws of FREEs of every winding angle, as the sweep makes them.

use crate::{ConstantBending, ModuleSweep, RodLaw, RodModule, RodSettings, Run, ThickTube};
use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, Module, OgdenForm, PlacedFree, Tip, Tube, Winding,
};
use std::sync::{Arc, atomic::AtomicBool};

/// A FREE of the paper, and one of the University of Michigan's thick ones.
fn free(angle_deg: f64, thick: bool) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.15e-3, law: FibreLaw::TensionOnly };
    let (inner_radius, wall) = if thick { (4.7625e-3, 1.4e-3) } else { (4.76e-3, 0.8e-3) };
    Free {
        tube: Tube { length: 0.16, inner_radius, wall },
        winding: Winding::from_hoop(angle_deg.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

/// Between 60 and 80 degrees the threads run along the tube: taut they are fifty times stiffer than the wall. A FREE of 75 degrees was lost at 14 kPa.
#[test]
fn frees_of_all_windings_reach_their_pressures() {
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    for angle in [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 75.0, 80.0] {
        for thick in [false, true] {
            let free = free(angle, thick);
            let tube = ThickTube::new(&free);
            let top = 0.9 * tube.limit_state().unwrap().pressure;
            let module = Module {
                frees: vec![PlacedFree { free, position: [0.0; 2] }],
                tip: Tip {
                    plate_mass: 0.0,
                    payload: 0.0,
                    free_dof: [false, false, true, false, false, true],
                },
                base: Base { gravity: [0.0; 3], free_mass: 0.0 },
                spacers: 0,
            };
            let laws =
                ModuleSweep::default().section_laws(&module, &[vec![0.0, top]], &run).unwrap().unwrap();
            let law = |section| RodLaw { section, bending: Arc::new(ConstantBending::of_bare_tube(&free)) };
            let laws = laws.into_iter().map(|section| law(section)).collect();
            let rods = RodModule::new(&module, laws, RodSettings::default()).unwrap();
            let mut last = rods.rest().unwrap();
            for step in 1..=10 {
                let pressure = top * f64::from(step) / 10.0;
                last = rods
                    .solve_from(&last, &[pressure])
                    .unwrap_or_else(|error| panic!("{angle} deg: {error}"));
                let (found, exact) = (last.state.chart, tube.free_state(pressure).unwrap());
                let stretch = found.position[2] / free.tube.length;
                let twist = found.twist / free.tube.length * free.tube.outer_radius();
                let turned = exact.twist_per_length * free.tube.outer_radius();
                assert!(
                    (stretch - exact.axial_stretch).abs() < 5e-5 && (twist - turned).abs() < 5e-5,
                    "{angle} deg, {pressure} Pa: {stretch} {twist}, {exact:?}"
                );
                assert_eq!(last.state.negative_pivots, 0);
            }
        }
    }
}
