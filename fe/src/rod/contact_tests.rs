use super::*;
use crate::{
    SectionLaw, ThickTube,
    rod::{specimens::*, *},
};
use actuator::Handedness;

#[test]
fn straight_frees_touch_when_their_radii_say_so() {
    let pair = left_right([0.0; 3]);
    let rods = analytic(&pair, RodSettings::default());
    let tube = ThickTube::new(&pair.frees[0].free);
    for pressure in [0.0, 2e4, 4e4] {
        let found = rods.solve(&[pressure; 4]).unwrap();
        let closest = found.closest.unwrap();
        // All lengthen alike and none turns: the section is held against its twist.
        let stretch = found.state.chart.position[2] / pair.length();
        let volume = tube.volume(pressure, stretch, 0.0);
        let free = pair.frees[0].free.tube;
        let (a, b) = (free.inner_radius, free.outer_radius());
        let radius = ((volume / PI + b * b - a * a) / stretch).sqrt();
        assert!((closest.gap - (15e-3 - 2.0 * radius)).abs() < 1e-9, "{closest:?} {radius}");
        assert_eq!(found.state.gap, Some(closest.gap));
        // The difference over 10 Pa either way sees half of what they widen a slack tube by.
        assert!(pressure > 0.0 || (radius / b - 1.0).abs() < 2e-5, "{radius}");
    }
    let single = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    assert_eq!(analytic(&single, RodSettings::default()).solve(&[2e4]).unwrap().state.gap, None);
}

/// A free FREE's outer radius is the section's own.
#[test]
fn the_radius_is_the_sections_expansion() {
    let free = free(40.0, Handedness::Right);
    let rods = analytic(&module(vec![at(free, 0.0, 0.0)]), RodSettings::default());
    let found = rods.solve(&[4e4]).unwrap();
    let loads = Loads::at(&[4e4]);
    let expansion = ThickTube::new(&free).free_state(4e4).unwrap().expansion;
    assert!(expansion > 1.1);
    for radius in &rods.tubes(&found.configuration, &loads)[0].radii {
        assert!((radius / free.tube.outer_radius() / expansion - 1.0).abs() < 1e-6, "{radius} {expansion}");
    }
}
