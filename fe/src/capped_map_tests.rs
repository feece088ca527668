//! Tests of sections between caps against whole solids.

use super::*;
use crate::{SectionMesh, section::tests::free};
use actuator::{FreeState, Handedness, OgdenForm, units::DEG};
use std::sync::atomic::{AtomicBool, Ordering};

/// Coarse, like the solids it is compared with: 9 elements on 20 mm.
const SWEEP: CappedSweep = CappedSweep {
    section: FreeSweep {
        mesh: SectionMesh { radial: 1, under_fibre: 1, between_fibres: 2 },
        extra_states: 3,
        interpolation_tolerance: None,
        beyond_limit: None,
        estimate_errors: false,
        checks: 1,
        seed: 7,
    },
    solid: SolidSweep { elements: Some([1, 12, 45]), checks: 0, seed: 1 },
};

/// The paper's tube with fibres as descriptions have them.
fn paper(angle: f64, length: f64) -> Free {
    let mut free = free(angle);
    (free.tube.length, free.winding.fibre.diameter) = (length, 0.15e-3);
    free
}

fn effect(free: &Free) -> EndEffect {
    SWEEP.end_effect(&(*free).into(), 0.2, &mut || true).unwrap()
}

/// The section and a solid of the FREE's own length at shares of the section's limit pressure.
fn both(free: &Free, shares: &[f64]) -> Vec<(f64, FreeState, FreeState)> {
    let node = LoadedFree::from(*free);
    let limit = SWEEP.section.path(&node, &[0.0]).unwrap().limit_pressure().unwrap();
    let pressures: Vec<f64> = shares.iter().map(|share| share * limit).collect();
    let section = SWEEP.section.path(&node, &pressures).unwrap();
    let along = (free.tube.length / 100e-3 * 45.0).round() as u32;
    let sweep = SolidSweep { elements: Some([1, 12, along]), ..SWEEP.solid };
    let solid = sweep.path(&node, &pressures, &mut || true).unwrap();
    let at = |path: &FreePath, p: f64| {
        *path.states.iter().find(|state| (state.pressure - p).abs() <= 1e-8 * p).unwrap()
    };
    pressures[1..].iter().map(|p| (*p, at(&section, *p), at(&solid, *p))).collect()
}

#[test]
fn layers_of_a_long_free_are_those_of_another_length() {
    // At pressures between those of the end effect.
    for angle in [20.0, 60.0] {
        let free = paper(angle, 130e-3);
        let effect = effect(&free);
        for (pressure, section, solid) in both(&free, &[0.0, 0.13, 0.55, 0.87]) {
            let own = EndChange::of(free.tube.length, &solid, &solid).unwrap();
            let ours = effect.at(effect.unit().coordinate(pressure)).unwrap();
            let outer = free.tube.outer_radius();
            let off = (ours.extension - own.extension).abs();
            assert!(off < 0.02 * own.extension.abs() + 2e-4 * outer, "{angle}: {ours:?} {own:?}");
            let off = (ours.turn - own.turn).abs();
            assert!(off < 0.01 * own.turn.abs() + 0.02 * DEG, "{angle}: {ours:?} {own:?}");
            assert_eq!(ours.expansion, 0.0);
            // What the section misses of the whole, beside the solid's mesh, is the end effect.
            let ours = ours.cap_to_cap(free.tube.length, &section);
            let mesh = solid.middle.unwrap().twist_per_length - section.twist_per_length;
            let missed = solid.twist_per_length - mesh - section.twist_per_length;
            let left = solid.twist_per_length - mesh - ours.twist_per_length;
            assert!(left.abs() < 0.02 * missed.abs() + 1e-3, "{angle}: {left} of {missed}");
            assert_eq!(ours.middle.unwrap().axial_stretch, section.axial_stretch);
        }
    }
}

#[test]
fn a_short_free_is_the_whole_solid_up_to_the_mesh() {
    // Near the limit the layers of 40 mm meet in the middle, which then does less than the section.
    let free = paper(60.0, 40e-3);
    let effect = effect(&free);
    let long = both(&paper(60.0, 100e-3), &[0.0, 0.5, 0.93]);
    for ((pressure, section, solid), (_, _, long)) in both(&free, &[0.0, 0.5, 0.93]).into_iter().zip(long) {
        let ours = effect.at(effect.unit().coordinate(pressure)).unwrap().cap_to_cap(40e-3, &section);
        let mesh = long.expansion - section.expansion;
        assert!((ours.expansion + mesh - solid.expansion).abs() < 1e-4, "{ours:?} {solid:?}");
        let mesh = long.middle.unwrap().axial_stretch - section.axial_stretch;
        assert!((ours.axial_stretch + mesh - solid.axial_stretch).abs() < 1e-5, "{ours:?} {solid:?}");
        let mesh = long.middle.unwrap().twist_per_length - section.twist_per_length;
        let off = (ours.twist_per_length + mesh) / solid.twist_per_length - 1.0;
        assert!(off.abs() < 1e-3, "{off} {ours:?} {solid:?}");
    }
    let (_, section, solid) = both(&free, &[0.0, 0.93])[0];
    assert!(section.expansion - solid.expansion > 5e-3);
}

#[test]
fn the_hand_of_the_winding_turns_the_end_twist() {
    let right = paper(30.0, 100e-3);
    let mut left = right;
    left.winding.handedness = Handedness::Left;
    let (right, left) = (effect(&right).at(0.4).unwrap(), effect(&left).at(0.4).unwrap());
    assert!(right.turn > 0.0 && (left.turn / right.turn + 1.0).abs() < 1e-6, "{right:?} {left:?}");
    assert!((left.extension / right.extension - 1.0).abs() < 1e-6);
}

fn axes(moduli: &[f64]) -> Vec<MapAxis> {
    MapAxis::of_angles_and_moduli(vec![20.0 * DEG, 60.0 * DEG], moduli.to_vec())
}

fn map_of(sweep: &CappedSweep, moduli: &[f64]) -> FreeMap {
    let pressures = (0..=4).map(|i| 1e4 * f64::from(i)).collect();
    sweep.empty_map(paper(30.0, 130e-3).into(), axes(moduli), pressures, Default::default()).unwrap()
}

fn fill(sweep: &CappedSweep, map: &mut FreeMap, shard: Shard, jobs: usize) -> (FreeSweepReport, CapsReport) {
    let run = Run { jobs, progress: &|_, _| {}, stop: &AtomicBool::new(false) };
    sweep.fill(map, shard, &run, &mut |_, _| {}).unwrap()
}

#[test]
fn moduli_between_have_the_end_effects_of_their_own_solids() {
    let sweep = CappedSweep { section: FreeSweep { checks: 0, ..SWEEP.section }, ..SWEEP };
    let moduli = [0.2e6, 0.6e6, 1.2e6];
    let mut map = map_of(&sweep, &moduli);
    let (report, caps) = fill(&sweep, &mut map, Shard::WHOLE, 2);
    assert_eq!((report.computed, caps.end_effects, map.is_complete()), (6, 4, true));
    // Other shear moduli, other end effects: by what fibres stretch.
    assert!(caps.difference > 0.01 && caps.difference < ALIKE, "{caps:?}");
    for (i, angle) in [20.0, 60.0].into_iter().enumerate() {
        let own = effect(&paper(30.0, 130e-3).at(angle * DEG, moduli[1]));
        let path = map.path(i, 1).unwrap();
        assert_eq!(path.end, PathEnd::LimitPoint);
        let limit = path.limit_pressure().unwrap();
        for state in path.states.iter().filter(|state| state.pressure < 0.98 * limit) {
            let own = own.at(own.unit().coordinate(state.pressure)).unwrap();
            let middle = state.middle.unwrap();
            let extension = (state.axial_stretch - middle.axial_stretch) * 130e-3;
            let turn = (state.twist_per_length - middle.twist_per_length) * 130e-3;
            assert!((extension - own.extension).abs() < 0.005 * own.extension.abs() + 1e-7, "{state:?}");
            assert!((turn - own.turn).abs() < 0.005 * own.turn.abs() + 2e-4, "{turn} {own:?}");
        }
    }
}

#[test]
fn shards_and_threads_make_the_same_map() {
    let moduli = [0.3e6, 0.4e6];
    let (mut whole, mut parts) = (map_of(&SWEEP, &moduli), map_of(&SWEEP, &moduli));
    let (_, caps) = fill(&SWEEP, &mut whole, Shard::WHOLE, 2);
    // Four nodes, of which none lies between moduli, and a check.
    assert_eq!((caps.end_effects, whole.checks.len()), (5, 1));
    for index in 0..2 {
        fill(&SWEEP, &mut parts, Shard { index, count: 2 }, 1);
    }
    assert_eq!(parts, whole);
    assert_eq!(fill(&SWEEP, &mut parts, Shard::WHOLE, 1).0.computed, 0);
    assert!(whole.settings.contains("100.0800 mm long") && whole.settings.contains("0.3000 and 0.4000 MPa"));
}

#[test]
fn a_stop_leaves_what_is_not_finished() {
    let mut map = map_of(&SWEEP, &[0.393e6]);
    let stop = AtomicBool::new(false);
    let run = Run {
        jobs: 2,
        progress: &|done, _| {
            if done > 3 {
                stop.store(true, Ordering::Relaxed);
            }
        },
        stop: &stop,
    };
    let (report, _) = SWEEP.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| {}).unwrap();
    assert!(report.left > 0 && report.failed.is_empty(), "{report:?}");
    assert!(!map.is_complete());
}

#[test]
fn without_a_limit_pressure_paths_go_as_far_as_asked() {
    // A rubber that stiffens.
    let mut free = paper(20.0, 130e-3);
    free.elastomer =
        actuator::Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 3.0, form: OgdenForm::InitialModulus };
    let sweep = CappedSweep { section: FreeSweep { checks: 0, ..SWEEP.section }, ..SWEEP };
    let axes = MapAxis::of_angles_and_moduli(vec![20.0 * DEG], vec![0.3e6, 0.4e6, 0.6e6]);
    let pressures = vec![0.0, 1e4, 2e4, 3e4];
    let mut map = sweep.empty_map(free.into(), axes, pressures, Default::default()).unwrap();
    let (report, caps) = fill(&sweep, &mut map, Shard::WHOLE, 2);
    assert_eq!((report.computed, caps.end_effects), (3, 2), "{report:?}");
    for path in map.paths.iter().flatten() {
        assert_eq!(path.end, PathEnd::Range);
        assert!((path.states[3].pressure - 3e4).abs() < 1e-4 && path.states.len() == 4);
        assert!(path.states[3].middle.unwrap().twist_per_length < path.states[3].twist_per_length);
    }
}

#[test]
fn what_no_solid_reaches_is_left_out() {
    let state = |pressure: f64| FreeState {
        pressure,
        axial_stretch: 1.1,
        expansion: 1.2,
        twist_per_length: -10.0,
        residual: 1e-12,
        middle: None,
        section: None,
        mesh_error: None,
    };
    let mut section = FreePath::solved(vec![state(0.0), state(1e4), state(2e4)], PathEnd::LimitPoint);
    section.beyond = vec![state(1.9e4)];
    let change = EndChange { extension: 1e-3, turn: 0.2, expansion: -0.01 };
    let all = capped(section.clone(), 0.1, &[change; 3]);
    assert_eq!((all.end, all.states.len(), all.beyond.len()), (PathEnd::LimitPoint, 3, 0));
    let last = all.states[2];
    assert!((last.axial_stretch - 1.11).abs() < 1e-15 && (last.twist_per_length + 8.0).abs() < 1e-13);
    assert!((last.expansion - 1.19).abs() < 1e-15 && last.middle.unwrap().twist_per_length == -10.0);
    let part = capped(section, 0.1, &[change; 2]);
    assert_eq!((part.end, part.states.len()), (PathEnd::Range, 2));
}
