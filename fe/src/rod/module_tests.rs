use super::{specimens::*, *};
use crate::{SectionLaw, SectionMesh, ThickTube};
use actuator::{Base, Handedness, Module, PoseChart};
use nalgebra::Vector3;
use std::{f64::consts::PI, sync::Arc};

/// Spacers on a module and none: the same where FREEs only lengthen.
#[test]
fn spacers_do_not_hinder_lengthening() {
    let lone = left_right([0.0; 3]);
    let tied = Module { spacers: 5, ..lone.clone() };
    let pressures = [3e4; 4];
    let free = analytic(&lone, RodSettings::default()).solve(&pressures).unwrap().state.chart.to_array();
    let held = analytic(&tied, RodSettings::default()).solve(&pressures).unwrap().state.chart.to_array();
    for (a, b) in free.iter().zip(held) {
        assert!((a - b).abs() < 1e-9, "{free:?} {held:?}");
    }
}

/// Two equal FREEs opposite each other, held in the holes of spacers, turn as the bundle does: each is a helix of radius a, whose
/// length the bundle's pitch and height give: the energy per length is 2 Phi(sqrt(lambda^2 + (tau a)^2), tau).
#[test]
fn a_turning_bundle_lays_its_frees_on_helices() {
    let arm = 8e-3;
    let pair = module(vec![
        at(free(30.0, Handedness::Right), arm, 0.0),
        at(free(30.0, Handedness::Right), -arm, 0.0),
    ]);
    let chart = analytic(&Module { spacers: 7, ..pair }, RodSettings::default())
        .solve(&[2e4; 2])
        .unwrap()
        .state
        .chart;
    let (stretch, twist) = (chart.position[2] / 0.175, chart.twist / 0.175);
    let tube = ThickTube::new(&free(30.0, Handedness::Right));
    let energy =
        |stretch: f64, twist: f64| tube.section(2e4, stretch.hypot(twist * arm), twist).unwrap().energy;
    // Equilibrium: the bundle's energy is stationary in its height and turn.
    let (by_stretch, by_twist) = (
        (energy(stretch + 1e-4, twist) - energy(stretch - 1e-4, twist)) / 2e-4,
        (energy(stretch, twist + 0.01) - energy(stretch, twist - 0.01)) / 0.02,
    );
    assert!(by_stretch.abs() < 1e-5 && by_twist.abs() < 1e-7, "{by_stretch} N, {by_twist} N m at {chart:?}");
    assert!(twist < -5.0, "{chart:?}");
}

#[test]
fn a_free_free_is_the_sections_free_state() {
    for hand in [Handedness::Right, Handedness::Left] {
        let free = free(40.0, hand);
        let section = ThickTube::new(&free).free_state(5e4).unwrap();
        for (x, y) in [(0.0, 0.0), (4e-3, -3e-3)] {
            let module = module(vec![at(free, x, y)]);
            let found = analytic(&module, RodSettings::default()).solve(&[5e4]).unwrap();
            let length = free.tube.length;
            let chart = found.state.chart;
            let twist = hand.sign() * section.twist_per_length * length;
            assert!((chart.twist - twist).abs() < 1e-7, "{} {twist}", chart.twist);
            // More than a whole turn: the unwrapped count is what is tested.
            assert!(twist.abs() > 2.0 * PI);
            let pose = chart.to_pose();
            assert!((pose.position.z / length - section.axial_stretch).abs() < 1e-8);
            // The plate turns about the FREE's axis, wherever that stands.
            let axis = pose.position + pose.rotation * Vector3::new(x, y, 0.0);
            assert!((axis - Vector3::new(x, y, pose.position.z)).norm() < 1e-9);
            assert_eq!(found.state.negative_pivots, 0);
        }
    }
}

#[test]
fn equal_pressures_lengthen_a_left_right_module_without_twist() {
    let rods = analytic(&left_right([0.0; 3]), RodSettings::default());
    let chart = rods.solve(&[3e4; 4]).unwrap().state.chart;
    assert!(chart.twist.abs() < 1e-10 && chart.bend[0].abs() < 1e-10 && chart.bend[1].abs() < 1e-10);
    assert!(chart.position[2] > 0.176, "{chart:?}");
    // A diagonal pair of one hand turns without bending, in the sense of its hand: right-handed 30 degrees turn negative.
    let right = rods.solve(&[3e4, 0.0, 3e4, 0.0]).unwrap().state.chart;
    assert!(right.twist < -0.3 && right.bend[0].abs() < 1e-9 && right.position[0].abs() < 1e-10, "{right:?}");
    let left = rods.solve(&[0.0, 3e4, 0.0, 3e4]).unwrap().state.chart;
    assert!((left.twist + right.twist).abs() < 1e-8);
    // An adjacent pair at y > 0 lengthens that side: the tip leans to -y, by a positive turn about x.
    let bend = rods.solve(&[1.2e4, 1.2e4, 0.0, 0.0]).unwrap().state.chart;
    assert!(bend.position[1] < -1e-3 && bend.bend[0] > 0.05, "{bend:?}");
    assert!(bend.twist.abs() < 1e-8 && bend.position[0].abs() < 1e-9);
}

#[test]
fn mirrored_modules_move_as_mirror_images() {
    let mut mirrored = left_right([0.0, 0.0, 1.0]);
    for placed in &mut mirrored.frees {
        placed.position[0] = -placed.position[0];
        placed.free.winding.handedness = match placed.free.winding.handedness {
            Handedness::Right => Handedness::Left,
            Handedness::Left => Handedness::Right,
        };
    }
    let pressures = [3e4, 1e4, 0.0, 2e4];
    let one = analytic(&left_right([0.0, 0.0, 1.0]), RodSettings::default()).solve(&pressures).unwrap();
    let other = analytic(&mirrored, RodSettings::default()).solve(&pressures).unwrap();
    let ([t, bx, by, x, y, z], mirror) = (one.state.chart.to_array(), other.state.chart.to_array());
    for (a, b) in [-t, bx, -by, -x, y, z].iter().zip(mirror) {
        assert!((a - b).abs() < 1e-8, "{one:?} {other:?}");
    }
}

#[test]
fn turning_the_whole_module_turns_its_answer() {
    // A quarter turn about z of FREEs and gravity: the chart's vectors turn with it.
    let mut turned = left_right([-1.0, 0.0, 0.0]);
    for placed in &mut turned.frees {
        let [x, y] = placed.position;
        placed.position = [-y, x];
    }
    let pressures = [3e4, 1e4, 0.0, 2e4];
    let one = analytic(&left_right([0.0, 1.0, 0.0]), RodSettings::default()).solve(&pressures).unwrap();
    let other = analytic(&turned, RodSettings::default()).solve(&pressures).unwrap();
    let ([t, bx, by, x, y, z], turn) = (one.state.chart.to_array(), other.state.chart.to_array());
    for (a, b) in [t, -by, bx, -y, x, z].iter().zip(turn) {
        assert!((a - b).abs() < 1e-8);
    }
}

#[test]
fn the_answer_does_not_depend_on_the_path() {
    let rods = analytic(&left_right([0.0, 0.0, 1.0]), RodSettings::default());
    let goal = [4e4, 1e4, 2e4, 0.0];
    let straight = rods.solve(&goal).unwrap();
    let mut other = rods.solve(&[0.0, 3e4, 3e4, 1e4]).unwrap();
    for corner in [[2e4, 4e4, 0.0, 0.0], goal] {
        other = rods.solve_from(&other, &corner).unwrap();
    }
    for (a, b) in straight.state.chart.to_array().iter().zip(other.state.chart.to_array()) {
        assert!((a - b).abs() < 1e-8);
    }
    assert!(straight.state.residual < 1e-10);
}

#[test]
fn slopes_match_differences() {
    let module = left_right([0.0, 0.6, 0.8]);
    let pressures = [3e4, 1e4, 0.0, 2e4];
    let chart = |module: &Module, scale: f64, pressures: &[f64]| -> [f64; 6] {
        let settings = RodSettings { bending_stiffness_scale: scale, ..RodSettings::default() };
        analytic(module, settings).solve(pressures).unwrap().state.chart.to_array()
    };
    let found = analytic(&module, RodSettings::default()).solve(&pressures).unwrap();
    let close = |ahead: [f64; 6], behind: [f64; 6], step: f64, slope: [f64; 6], what: &str| {
        let size = slope.iter().fold(0.0f64, |size, value| size.max(value.abs()));
        for k in 0..6 {
            let difference = (ahead[k] - behind[k]) / (2.0 * step);
            // Central differences over one part in a thousand: 1e-6 of the slopes and some rounding.
            assert!((difference - slope[k]).abs() < 1e-4 * size, "{what} {k}: {difference} {}", slope[k]);
        }
    };
    let heavier = |grams: f64| {
        let mut module = module.clone();
        module.tip.payload += grams * 1e-3;
        module
    };
    // The payload may not be negative in a file, here it may.
    close(
        chart(&heavier(0.1), 1.0, &pressures),
        chart(&heavier(-0.1), 1.0, &pressures),
        1e-4,
        found.state.slopes[0],
        "payload",
    );
    close(
        chart(&module, 1.001, &pressures),
        chart(&module, 0.999, &pressures),
        1e-3,
        found.state.slopes[1],
        "bending",
    );
    for i in [0, 1, 3] {
        let shifted = |step: f64| {
            let mut moved = pressures;
            moved[i] += step;
            chart(&module, 1.0, &moved)
        };
        close(shifted(20.0), shifted(-20.0), 20.0, found.pressure_jacobian[i], "pressure");
    }
}

#[test]
fn energy_falls_by_the_enclosed_volume() {
    // dE/dp along equilibria is minus the volume: of four free, straight FREEs here.
    let module = left_right([0.0; 3]);
    let rods = analytic(&module, RodSettings::default());
    let [below, above] = [0.99e4, 1.01e4].map(|p| rods.solve(&[p; 4]).unwrap());
    let volume = (below.energy - above.energy) / 200.0;
    let tube = module.frees[0].free.tube;
    // The radius is not known here, so bound it: swelling between nothing and 10 %.
    let empty = 4.0 * PI * tube.inner_radius.powi(2) * tube.length;
    assert!(volume > empty && volume < 1.1 * empty, "{volume} {empty}");
}

#[test]
fn a_guided_tip_stays_on_its_guide() {
    let mut module = left_right([0.0, 1.0, 0.0]);
    module.tip.free_dof = [false, false, true, false, false, true];
    let rods = analytic(&module, RodSettings::default());
    let PoseChart { twist, bend, position } = rods.solve(&[4e4, 1e4, 3e4, 0.0]).unwrap().state.chart;
    assert_eq!((bend, position[0], position[1]), ([0.0; 2], 0.0, 0.0));
    assert!(twist < -0.3 && position[2] > 0.175);
    module.tip.free_dof = [true, true, true, true, true, false];
    let locked = analytic(&module, RodSettings::default()).solve(&[4e4, 1e4, 3e4, 0.0]).unwrap();
    assert_eq!(locked.state.chart.twist, 0.0);
    assert!(locked.state.residual < 1e-10 && locked.state.chart.bend[0].abs() > 1e-3);
}

#[test]
fn a_hanging_module_is_stretched_by_its_weight() {
    // One FREE with its mass lumped on nodes: tip force m_plate g + m_free g/2 stretches it on average (trapezoid: exact).
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.base = Base { gravity: [0.0, 0.0, 1.0], free_mass: 4e-3 };
    module.tip.plate_mass = 5e-3;
    module.tip.payload = 1e-3;
    let axial = 2.0;
    let law = Linear { axial, torsion: 1e-3, area: 0.0, arm: 0.0 };
    let chart = linear(&module, law, RodSettings::default()).rest().unwrap().state.chart;
    let expected = module.length() * (1.0 + 9.80665 * (6e-3 + 0.5 * 4e-3) / axial);
    assert!((chart.position[2] - expected).abs() < 1e-9, "{} {expected}", chart.position[2]);
}

#[test]
fn a_wrong_question_is_refused_with_numbers() {
    let module = left_right([0.0; 3]);
    let rods = analytic(&module, RodSettings::default());
    assert!(rods.solve(&[0.0; 3]).unwrap_err().to_string().contains("3 finite pressures for 4 FREEs"));
    assert!(matches!(rods.solve(&[0.0, f64::NAN, 0.0, 0.0]), Err(RodError::Count { given: 3, .. })));
    let too_much = rods.solve(&[1.5e5, 0.0, 0.0, 0.0]).unwrap_err();
    let RodError::NoEquilibrium(end) = &too_much else { panic!("{too_much}") };
    assert!(end.reached[0] > 6e4 && end.reached[0] < 1.5e5, "{too_much}");
    let settings = RodSettings { bending_stiffness_scale: -1.0, ..RodSettings::default() };
    assert!(RodModule::new(&module, Vec::new(), settings).is_err());
}

#[test]
fn a_tabulated_law_places_the_tip_like_the_law_itself() {
    let module = left_right([0.0, 0.0, 1.0]);
    let free = free(30.0, Handedness::Right);
    let tube = ThickTube::new(&free);
    let states = (0..=8).map(|i| tube.free_state(5e4 * i as f64 / 8.0).unwrap()).collect();
    let path = actuator::FreePath::solved(states, actuator::PathEnd::Range);
    let grid = TableGrid::for_free(&free, &path, 5e4);
    let stop = std::sync::atomic::AtomicBool::new(false);
    let run = crate::Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let mesh = SectionMesh { radial: 2, under_fibre: 1, between_fibres: 1 };
    let table = SectionTable::new(&free, grid, mesh, &run).unwrap();
    let settings = RodSettings { bending_stiffness_scale: 2.5, ..RodSettings::default() };
    let tabulated = with_sections(&module, vec![Arc::new(table) as Arc<dyn SectionLaw>; 4], settings);
    let exact = analytic(&module, settings);
    let mut worst = [0.0f64; 2];
    for pressures in
        [[2e4, 0.0, 0.0, 0.0], [4e4, 1e4, 0.0, 2e4], [5e3, 4e4, 4e4, 0.0], [4.5e4, 2e3, 4.5e4, 0.0]]
    {
        let [a, b] = [&exact, &tabulated].map(|rods| rods.solve(&pressures).unwrap().state.chart.to_pose());
        worst[0] = worst[0].max((a.position - b.position).norm() / module.length());
        worst[1] = worst[1].max(a.rotation_distance(&b));
    }
    // 0.05 % of the length, and a third of a degree after up to 190 of twist.
    assert!(worst[0] < 5e-4 && worst[1] < 6e-3, "{worst:?}");
}

/// FREEs of other lengths than the mean are strained at rest: between plates that stay parallel by their own z/L, whose forces cancel.
#[test]
fn frees_of_different_lengths_share_a_prestress() {
    let mut module = module([-7.5e-3, 7.5e-3].map(|x| at(free(30.0, Handedness::Right), x, 0.0)).to_vec());
    module.frees[1].free.tube.length = 0.18;
    module.tip.free_dof = [false, false, true, false, false, false];
    let law = Linear { axial: 30.0, torsion: 1e-3, area: 0.0, arm: 0.0 };
    let settings = RodSettings { bending_stiffness_scale: 10.0, ..RodSettings::default() };
    let found = linear(&module, law, settings).rest().unwrap();
    let height = 2.0 / (1.0 / 0.175 + 1.0 / 0.18);
    assert!((found.state.chart.position[2] - height).abs() < 1e-10, "{found:?}");
    let pulls = found.wrenches.iter().map(|wrench| wrench.force[2]);
    let expected = [0.175, 0.18].map(|length| -30.0 * (height / length - 1.0));
    for (pull, expected) in pulls.zip(expected) {
        assert!((pull - expected).abs() < 1e-8, "{pull} {expected}");
    }
    assert_eq!(found.state.negative_pivots, 0);
}

/// One of four a good centimetre off its fellows is a third of what a FREE can be pressed before it buckles: a start that Newton's method does
/// not survive at once. A long one tips the plate over to the others, a short one to itself.
#[test]
fn a_free_that_is_a_centimetre_off_tips_the_plate() {
    let tipped = [1e-2, -1e-2].map(|off| {
        let mut module = left_right([0.0, 0.0, 1.0]);
        module.frees[0].free.tube.length += off;
        let rods = analytic(&module, RodSettings::default());
        let rest = rods.rest().unwrap();
        let tip = rest.state.chart.to_pose().position;
        // The FREE stands at (+, +).
        assert!(tip.x * off < 0.0 && tip.y * off < 0.0, "{off}: {rest:?}");
        assert!(tip.x.abs() > 5e-3, "{off}: {tip}");
        let goal = [2e4, 1e4, 0.0, 5e3];
        let found = rods.solve(&goal).unwrap();
        assert!(rest.state.residual < 1e-10 && found.state.residual < 1e-10);
        // Put on in pieces, it ends at the same equilibrium.
        let again = rods.solve_from(&rods.solve(&[1e4; 4]).unwrap(), &goal).unwrap();
        for (a, b) in found.state.chart.to_array().iter().zip(again.state.chart.to_array()) {
            assert!((a - b).abs() < 1e-8, "{found:?} {again:?}");
        }
        tip
    });
    assert!(tipped[0].x * tipped[1].x < 0.0);
}
