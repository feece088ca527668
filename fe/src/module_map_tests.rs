use super::*;
use crate::TipLoad;
use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, MapParameter, ModuleState, OgdenForm, PlacedFree,
    Tip, Tube, Winding, payload_curvature,
};
use std::sync::{
    Mutex,
    atomic::{AtomicBool, Ordering},
};

/// Two FREEs of both hands side by side, hanging; the section is the same.
fn pair() -> Module {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::TensionOnly };
    let placed = |x: f64, hand| PlacedFree {
        free: Free {
            tube: Tube { length: 0.1, inner_radius: 4.76e-3, wall: 0.8e-3 },
            winding: Winding::from_hoop(30f64.to_radians(), hand, 6, fibre),
            elastomer: Elastomer::Ogden {
                shear_modulus: 0.393e6,
                alpha: 1.2,
                form: OgdenForm::InitialModulus,
            },
        },
        position: [x, 0.0],
    };
    Module {
        frees: vec![placed(-7.5e-3, Handedness::Right), placed(7.5e-3, Handedness::Left)],
        tip: Tip { plate_mass: 5e-3, payload: 0.0, free_dof: [true; 6] },
        base: Base { gravity: [0.0, 0.0, 1.0], free_mass: 2e-3 },
        spacers: 0,
    }
}

fn sweep() -> ModuleSweep {
    let mesh = SectionMesh { radial: 1, under_fibre: 1, between_fibres: 2 };
    let rods = RodSettings { elements: 6, bending_stiffness_scale: 2.0, tip_load: TipLoad::default() };
    ModuleSweep {
        mesh,
        rods,
        solids: None,
        bending: None,
        caps: None,
        use_symmetry: true,
        checks: 3,
        seed: 5,
    }
}

fn empty(sweep: &ModuleSweep) -> ModuleMap {
    let limits = Limits { pressure_max: vec![3e4; 2], pressure_rate: 2e5, idle_pressure: 0.0 };
    let axes = vec![vec![0.0, 1e4, 3e4], vec![0.0, 1.5e4, 3e4]];
    sweep.empty_map(pair(), limits, axes, ("pair.toml".into(), "kind".into())).unwrap()
}

fn fill(map: &mut ModuleMap, shard: Shard, jobs: usize) -> ModuleSweepReport {
    let stop = AtomicBool::new(false);
    let run = Run { jobs, progress: &|_, _| (), stop: &stop };
    sweep().fill(map, shard, &run, &mut |_, _| ()).unwrap()
}

#[test]
fn a_map_is_filled_alike_by_any_number_of_threads_and_shards() {
    let mut whole = empty(&sweep());
    let report = fill(&mut whole, Shard::WHOLE, 2);
    assert_eq!((report.computed, report.rows_left, report.failed.len()), (12, 0, 0));
    assert!(whole.is_complete() && whole.checks.len() == 3);
    let mut parts = empty(&sweep());
    for index in [2, 0, 1] {
        let before = parts.states.iter().flatten().count();
        fill(&mut parts, Shard { index, count: 3 }, 1);
        assert!(parts.states.iter().flatten().count() > before);
    }
    assert_eq!(whole, parts);
    // Nothing is computed twice.
    assert_eq!(fill(&mut whole, Shard::WHOLE, 2).computed, 0);
}

#[test]
fn states_are_those_of_the_module_and_carry_its_slopes() {
    let mut map = empty(&sweep());
    fill(&mut map, Shard::WHOLE, 2);
    let rest = map.states[0].as_ref().unwrap();
    assert!(rest.chart.twist.abs() < 1e-9 && rest.chart.position[2] > 0.1);
    assert_eq!(map.parameters.len(), rest.slopes.len());
    // A hanging payload lengthens it: by L/(3 mu A) per newton and FREE, roughly, as the fibres are slack.
    let tube = map.module.frees[0].free.tube;
    let expected = 0.1 * 9.80665 / (2.0 * 3.0 * 0.393e6 * tube.wall_area());
    assert!((rest.slopes[0][5] / expected - 1.0).abs() < 0.05, "{:?} {expected}", rest.slopes);
    // The mirror exchanges the FREEs: node (2, 0) against (0, 2).
    let [right, left] = [6, 2].map(|node| map.states[node].as_ref().unwrap().chart);
    assert!(right.twist < -0.1 && (right.twist + left.twist).abs() < 1e-7);
    for state in map.states.iter().flatten().chain(map.checks.iter().map(|check| &check.state)) {
        assert!(state.residual < 1e-9 && state.negative_pivots == 0);
    }
    let limits: Vec<f64> = map.limit_pressures.iter().copied().flatten().collect();
    assert!(
        limits.len() == 2 && limits[0] == limits[1] && (limits[0] / 74.7e3 - 1.0).abs() < 0.01,
        "{limits:?}"
    );
    assert!(map.settings.contains("bending and shear stiffness x 2"));
    assert!(map.settings.contains("of the bare tube, 3 mu I and mu A"));
    assert!(map.checks.iter().all(|check| check.pressures.iter().all(|p| (0.0..=3e4).contains(p))));
}

/// Four FREEs at the corners of a square, tied by spacers, hanging.
fn square(hands: [Handedness; 4]) -> Module {
    let pair = pair();
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let placed = |(hand, [x, y]): (Handedness, [f64; 2])| {
        let mut free = pair.frees[0].free;
        free.winding.handedness = hand;
        PlacedFree { free, position: [7.5e-3 * x, 7.5e-3 * y] }
    };
    Module { frees: hands.into_iter().zip(corners).map(placed).collect(), spacers: 5, ..pair }
}

#[test]
fn nodes_alike_by_symmetry_are_what_they_would_be_computed_each() {
    use Handedness::{Left, Right};
    // Two mirrors and half a turn; quarter turns; a mirror. (81 + 3 * 9)/4, (81 + 2 * 3 + 9)/4 and (81 + 9)/2 nodes are apart.
    for (hands, apart) in
        [([Right, Left, Right, Left], 27), ([Right; 4], 24), ([Right, Right, Left, Left], 45)]
    {
        let limits = Limits { pressure_max: vec![3e4; 4], pressure_rate: 2e5, idle_pressure: 0.0 };
        let axes = vec![vec![0.0, 1e4, 3e4]; 4];
        let whole = |use_symmetry| {
            let sweep = ModuleSweep { use_symmetry, checks: 1, ..sweep() };
            let source = (String::new(), String::new());
            let mut map = sweep.empty_map(square(hands), limits.clone(), axes.clone(), source).unwrap();
            let stop = AtomicBool::new(false);
            let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
            let report = sweep.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).unwrap();
            assert!(map.is_complete() && report.failed.is_empty());
            (map, report.computed)
        };
        let ((each, computed), (cut, fewer)) = (whole(false), whole(true));
        assert_eq!((computed, fewer), (82, apart + 1));
        let numbers = |state: &ModuleState| -> Vec<[f64; 6]> {
            std::iter::once(state.chart.to_array()).chain(state.slopes.iter().copied()).collect()
        };
        let size = |row: &[f64; 6]| row.iter().map(|value| value.abs()).fold(0.0, f64::max);
        let all: Vec<Vec<[f64; 6]>> = each.states.iter().flatten().map(numbers).collect();
        let sizes = (0..all[0].len()).map(|k| all.iter().map(|rows| size(&rows[k])).fold(0.0, f64::max));
        let sizes: Vec<f64> = sizes.collect();
        let mut bent = 0;
        for (rows, other) in all.iter().zip(cut.states.iter().flatten()) {
            for ((a, b), size) in rows.iter().zip(numbers(other)).zip(&sizes) {
                // Converged to 1e-10 of the rubber's stiffness, of which bending takes a hundredth.
                assert!((0..6).all(|k| (a[k] - b[k]).abs() < 1e-7 * size), "{hands:?} {a:?} {b:?}");
            }
            bent += usize::from(rows[0][1].hypot(rows[0][2]) > 0.02);
        }
        let pivots = |map: &ModuleMap| {
            map.states.iter().flatten().map(|state| state.negative_pivots).collect::<Vec<_>>()
        };
        assert_eq!(pivots(&each), pivots(&cut));
        assert!(bent > 20, "{hands:?} {bent}");
    }
}

#[test]
fn shards_and_an_earlier_map_of_every_node_are_completed_by_symmetry() {
    let limits = Limits { pressure_max: vec![3e4; 2], pressure_rate: 2e5, idle_pressure: 0.0 };
    let source = (String::new(), String::new());
    let map = sweep().empty_map(pair(), limits, vec![vec![0.0, 1e4, 3e4]; 2], source).unwrap();
    let (mut whole, mut parts, mut taken_up) = (map.clone(), map.clone(), map);
    assert_eq!(fill(&mut whole, Shard::WHOLE, 2).computed, 6 + 3);
    for index in [1, 0] {
        fill(&mut parts, Shard { index, count: 2 }, 1);
    }
    assert_eq!(parts, whole);
    // The last node of the first line, without its image.
    taken_up.states[2] = whole.states[2].clone();
    fill(&mut taken_up, Shard::WHOLE, 1);
    assert!(taken_up.is_complete());
    // A load that leans to one side leaves no symmetry.
    let mut leaning = sweep();
    leaning.rods.tip_load.force = [0.01, 0.0, 0.0];
    assert_eq!(leaning.lines(&whole, Shard::WHOLE).len(), 3 + 3);
    assert_eq!(leaning.lines(&whole, Shard::WHOLE)[2].pressures.len(), 3);
    assert_eq!(sweep().lines(&whole, Shard::WHOLE)[2].pressures.len(), 1);
}

#[test]
fn stopping_keeps_what_is_done_and_leaves_the_rest() {
    let mut map = empty(&sweep());
    let stop = AtomicBool::new(false);
    let told = Mutex::new(vec![]);
    let tell = |done, all| {
        told.lock().unwrap().push((done, all));
        stop.store(done == 3, Ordering::Relaxed);
    };
    let run = Run { jobs: 1, progress: &tell, stop: &stop };
    let mut saved = vec![];
    let mut save = |pressures: &[Vec<f64>], states: &[ModuleState]| {
        saved.push((pressures.to_vec(), states.to_vec()));
    };
    let report = sweep().fill(&mut map, Shard::WHOLE, &run, &mut save).unwrap();
    assert_eq!((report.computed, report.rows_left), (3, 5));
    let row: Vec<ModuleState> = map.states.iter().flatten().cloned().collect();
    assert_eq!(saved, [((0..3).map(|node| map.node_pressures(node)).collect(), row)]);
    assert_eq!(fill(&mut map, Shard::WHOLE, 2).rows_left, 0);
    assert!(map.is_complete() && map.checks.len() == 3);
    // Nine states and three checks; what is there already counts.
    map.checks.pop();
    stop.store(false, Ordering::Relaxed);
    sweep().fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).unwrap();
    assert_eq!(*told.lock().unwrap(), [(0, 12), (3, 12), (11, 12), (12, 12)]);
    let early = AtomicBool::new(true);
    let run = Run { jobs: 1, progress: &|_, _| (), stop: &early };
    let report = sweep().fill(&mut empty(&sweep()), Shard::WHOLE, &run, &mut |_, _| ()).unwrap();
    assert_eq!((report.computed, report.rows_left), (0, 6));
}

#[test]
fn a_map_beyond_the_limit_is_left_empty_there_and_says_so() {
    let mut module = pair();
    for placed in &mut module.frees {
        // Of one hand: FREEs that hold each other's twist bear more than each alone.
        placed.free.winding = pair().frees[0].free.winding.with_angle_from_hoop(50f64.to_radians());
    }
    let limits = Limits { pressure_max: vec![8e4; 2], pressure_rate: 2e5, idle_pressure: 0.0 };
    let sweep = ModuleSweep { checks: 0, ..sweep() };
    let axes = vec![vec![0.0, 2e4, 8e4]; 2];
    let mut map = sweep.empty_map(module, limits, axes, (String::new(), String::new())).unwrap();
    let limit = map.limit_pressures[0].unwrap();
    assert!(limit < 8e4, "{limit}");
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let report = sweep.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).unwrap();
    assert!(map.states[0].is_some() && map.states[4].is_some());
    assert!(map.states[8].is_none() && report.failed.iter().any(|failed| failed.pressures == [8e4, 8e4]));
    // Nine nodes, of which half a turn makes three.
    assert_eq!(report.computed + report.failed.len(), 6);
}

#[test]
fn axes_and_shapes_are_checked() {
    let limits = Limits { pressure_max: vec![3e4; 2], pressure_rate: 2e5, idle_pressure: 0.0 };
    let refuse = |axes: Vec<Vec<f64>>| {
        sweep()
            .empty_map(pair(), limits.clone(), axes, (String::new(), String::new()))
            .unwrap_err()
            .to_string()
    };
    assert!(refuse(vec![vec![0.0, 1e4]]).starts_with("pressures (kPa) of FREE 2: are missing"));
    assert!(refuse(vec![vec![0.0, 1e4]; 3]).contains("FREE 3: there is no such FREE"));
    assert!(refuse(vec![vec![0.0, 1e4], vec![0.0, 2e4, 1e4]]).contains("rising from zero, not 0, 20, 10"));
    assert!(refuse(vec![vec![0.0, 1e4], vec![1e3, 2e4]]).contains("rising from zero"));
    let mut map = empty(&sweep());
    map.states.pop();
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 1, progress: &|_, _| (), stop: &stop };
    assert!(matches!(
        sweep().fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()),
        Err(ModuleSweepError::Shape { expected: 9, found: 8 })
    ));
}

/// A bent, hanging pair under payloads: the slope alone overstates how far they straighten it, slope and curvature do not.
#[test]
fn payloads_are_predicted_by_slope_and_curvature() {
    let mut map = empty(&sweep());
    fill(&mut map, Shard::WHOLE, 2);
    let node = 6;
    let state = map.states[node].as_ref().unwrap();
    for payload in [0.01, 0.03, 0.05] {
        let mut loaded = empty(&sweep());
        loaded.module.tip.payload = payload;
        fill(&mut loaded, Shard::WHOLE, 2);
        let exact = loaded.states[node].as_ref().unwrap().chart.to_array();
        let [by_slope, by_both] = [0.0, 1.0].map(|curved| {
            let factors = [payload, 0.0, curved * payload_curvature(payload)];
            let predicted = state.chart.to_array();
            let off = (0..6).map(|k| {
                let change: f64 =
                    factors.iter().zip(&state.slopes).map(|(factor, slope)| factor * slope[k]).sum();
                // Angles count by the length of the pair.
                (predicted[k] + change - exact[k]) * if k < 3 { 0.1 } else { 1.0 }
            });
            off.fold(0.0f64, |most, off| most.max(off.abs()))
        });
        assert!(by_both < 0.1 * by_slope, "{payload} kg: {by_slope} m by the slope, {by_both} m by both");
    }
}

/// Solids in the place of rods: the same map on any number of threads, without the slopes that only rods have.
#[test]
fn solids_fill_a_map_as_rods_do() {
    let solids = SolidModuleSettings { elements: Some([1, 12, 8]), ..SolidModuleSettings::default() };
    let sweep = ModuleSweep { solids: Some(solids), checks: 1, use_symmetry: false, ..sweep() };
    let mut module = pair();
    for placed in &mut module.frees {
        placed.free.tube.length = 30e-3;
    }
    let limits = Limits { pressure_max: vec![3e4; 2], pressure_rate: 2e5, idle_pressure: 0.0 };
    let axes = || vec![vec![0.0, 1e4], vec![0.0, 1.5e4]];
    let filled = |jobs| {
        let mut map =
            sweep.empty_map(module.clone(), limits.clone(), axes(), ("pair".into(), String::new())).unwrap();
        let stop = AtomicBool::new(false);
        let run = Run { jobs, progress: &|_, _| (), stop: &stop };
        let report = sweep.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).unwrap();
        assert_eq!((report.computed, report.rows_left, report.failed.len()), (5, 0, 0));
        map
    };
    let map = filled(1);
    assert_eq!(map, filled(2));
    assert_eq!(map.parameters, [MapParameter::Payload, MapParameter::PayloadCurvature]);
    assert!(map.settings.contains("solids") && map.settings.contains("1 x 12 x 8"), "{}", map.settings);
    let state = map.states[2].as_ref().unwrap();
    let direct = SolidModule::new(&module, solids).unwrap().solve(&[1e4, 0.0]).unwrap().state;
    assert_eq!((state.chart, state.slopes[0]), (direct.chart, direct.slopes[0]));
    assert!(state.slopes.len() == 2 && state.slopes[1] != [0.0; 6]);
    module.spacers = 9;
    let refused = sweep.empty_map(module, limits, axes(), Default::default()).unwrap_err().to_string();
    assert!(refused.contains("set spacers = 0"), "{refused}");
}

#[test]
fn a_payload_too_heavy_for_one_step_is_put_on_in_several() {
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 1, progress: &|_, _| (), stop: &stop };
    let axes = vec![vec![0.0, 3e4]; 2];
    let laws = sweep().rod_laws(&pair(), &axes, &run).unwrap().unwrap();
    let mut module = pair();
    for placed in &mut module.frees {
        placed.free.tube.length = 0.25;
    }
    let settings = RodSettings { elements: 20, bending_stiffness_scale: 0.05, tip_load: TipLoad::default() };
    let rods = RodModule::new(&module, laws, settings).unwrap();
    let (found, payload) = (rods.solve(&[2.5e4, 0.0]).unwrap(), 0.05);
    module.tip.payload += payload;
    let carrying = RodModule::new(&module, rods.laws(), settings).unwrap();
    assert!(carrying.solve_from(&found, &found.pressures).is_err(), "it is carried in one step");
    let from_rest = carrying.solve(&found.pressures).unwrap().state.chart.to_array();
    for (a, b) in rods.loaded(&found, payload).unwrap().to_array().into_iter().zip(from_rest) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}
