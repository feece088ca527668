use super::*;
use actuator::{Base, Elastomer, Fibre, FibreLaw, Handedness, Tip, Tube, Winding};
use std::sync::atomic::AtomicBool;

fn module(spacers: u32) -> Module {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 1.5e-4, law: FibreLaw::TensionOnly };
    let placed = |angle: f64, handedness, position| PlacedFree {
        free: Free {
            tube: Tube { length: 0.12, inner_radius: 4.5e-3, wall: 1e-3 },
            winding: Winding::from_hoop(f64::to_radians(angle), handedness, 6, fibre),
            elastomer: Elastomer::NeoHookean { shear_modulus: 0.393e6 },
        },
        position,
    };
    use Handedness::{Left, Right};
    Module {
        frees: vec![
            placed(30.0, Right, [9e-3, 0.0]),
            placed(30.0, Left, [-6e-3, 8e-3]),
            placed(60.0, Left, [-5e-3, -7e-3]),
        ],
        tip: Tip { plate_mass: 0.0, payload: 0.0, free_dof: [true; 6] },
        base: Base { gravity: [0.0; 3], free_mass: 0.0 },
        spacers,
    }
}

fn solved(spacers: u32, chart: PoseChart, steps: usize) -> BlockedForces {
    let axis: Vec<f64> = (0..=steps).map(|i| 5e4 * i as f64 / steps as f64).collect();
    let run = Run { jobs: 1, progress: &|_, _| (), stop: &AtomicBool::new(false) };
    let settings = RodSettings { elements: 6, ..RodSettings::default() };
    let sweep = BlockedSweep { rods: settings, bending: None };
    sweep.module(&module(spacers), &chart, vec![axis; 3], &run).unwrap().unwrap()
}

fn rest() -> PoseChart {
    PoseChart { twist: 0.0, bend: [0.0; 2], position: [0.0, 0.0, 0.12] }
}

fn turned() -> PoseChart {
    PoseChart { twist: -0.4, bend: [0.06, -0.03], position: [2e-3, 1e-3, 0.123] }
}

/// The module without spacers is the sum of its FREEs: the same from the whole solved at once.
#[test]
fn frees_without_spacers_add_up() {
    let forces = solved(0, turned(), 2);
    assert!(forces.states.iter().all(Option::is_some) && forces.states.len() == 27);
    let laws = BlockedSweep::default().laws(
        &module(0),
        &forces.pressures,
        &Run { jobs: 1, progress: &|_, _| (), stop: &AtomicBool::new(false) },
    );
    let settings = RodSettings { elements: 6, ..RodSettings::default() };
    let rods = RodModule::new(&module(0), laws.unwrap().unwrap(), settings).unwrap();
    let held = rods.held(&turned()).unwrap();
    for node in [0, 5, 13, 26] {
        let whole = state(&held.solve(&forces.node_pressures(node)).unwrap());
        let sum = forces.states[node].unwrap();
        let off = (whole.wrench - sum.wrench).to_array();
        assert!(off.iter().all(|off| off.abs() < 1e-7), "{node}: {off:?}");
        assert_eq!(whole.negative_pivots, sum.negative_pivots);
    }
    assert!(forces.coupling().to_array().iter().all(|off| *off < 1e-12));
}

/// With spacers it is not: of a turned bundle each FREE's helix presses on the holes, which bend the others.
#[test]
fn spacers_couple_frees() {
    let forces = solved(4, turned(), 2);
    let [_, _, _, mx, my, mz] = forces.coupling().to_array();
    assert!(mx.max(my).max(mz) > 1e-6, "{forces:?}");
    // The straight bundle is not: its FREEs stay straight whatever the others do.
    let straight = solved(4, rest(), 2);
    assert!(straight.coupling().to_array().iter().all(|off| *off < 1e-9), "{:?}", straight.coupling());
}

#[test]
fn the_linear_set_is_the_tangent_at_rest() {
    // To second order in the pressure: half of the range leaves a quarter of the departure.
    let departure = |greatest: f64| {
        let run = Run { jobs: 1, progress: &|_, _| (), stop: &AtomicBool::new(false) };
        let sweep =
            BlockedSweep { rods: RodSettings { elements: 2, ..RodSettings::default() }, bending: None };
        let forces = sweep.module(&module(0), &rest(), vec![vec![0.0, greatest]; 3], &run).unwrap().unwrap();
        let [.., fz, _, _, mz] = forces.departure().to_array();
        [fz, mz]
    };
    let [far, near] = [1e4, 5e3].map(departure);
    for component in 0..2 {
        let ratio = far[component] / near[component];
        // The slope is taken at a hundredth of the range, not at zero: 4 but for its 2 %.
        assert!((ratio - 4.0).abs() < 0.2, "{far:?} {near:?}");
    }
}

#[test]
fn shadows_hold_every_state() {
    let forces = solved(0, rest(), 4);
    for components in [[2, 5], [3, 4], [2, 3]] {
        let shadow = forces.shadow(components);
        let all = ConvexPolygon::hull(
            forces.states.iter().flatten().map(|state| components.map(|k| state.wrench.to_array()[k])),
        );
        assert!((shadow.area() - all.area()).abs() < 1e-9 * all.area(), "{components:?}");
        let linear = forces.linear.shadow(components);
        assert!((linear.area() / shadow.area() - 1.0).abs() < 0.1, "{components:?}");
    }
}

#[test]
fn pressures_that_make_no_sense_are_refused() {
    let free = module(0).frees[0].free;
    for axis in [vec![], vec![0.0], vec![1.0, 2.0], vec![0.0, -1.0], vec![0.0, f64::NAN]] {
        assert!(matches!(
            BlockedSweep::free(&free, [1.0, 0.0], axis),
            Err(ModuleSweepError::Axis { free: 0, .. })
        ));
    }
    let run = Run { jobs: 1, progress: &|_, _| (), stop: &AtomicBool::new(false) };
    let sweep = BlockedSweep::default();
    assert!(sweep.module(&module(0), &rest(), vec![vec![0.0, 1.0]; 2], &run).is_err());
}
