use super::*;
use crate::{map_file::samples, plot::Chart};
use actuator::{FreeMap, FreeParameter, MapAxis, PathEnd};

fn chart<'a>(charts: &'a [(String, Picture)], stem: &str) -> &'a Chart {
    let names = || charts.iter().map(|(stem, _)| stem.as_str()).collect::<Vec<_>>();
    match charts.iter().find(|(own, _)| own == stem) {
        Some((_, Picture::Chart(chart))) => chart,
        _ => panic!("{stem} is no chart of {:?}", names()),
    }
}

fn named(chart: &Chart) -> Vec<&str> {
    chart.series.iter().map(|series| series.name.as_str()).filter(|name| !name.is_empty()).collect()
}

/// The sample over angles, moduli and walls: eight angles, of which the last three end at 30 kPa.
fn wide() -> FreeMap {
    let mut map = samples::free_map();
    let (open, limited) = (map.paths[0].clone(), map.paths[1].clone());
    let angles: Vec<f64> = (1..=8).map(|i| f64::from(10 * i).to_radians()).collect();
    let axis = |parameter, values: &[f64]| MapAxis { parameter, values: values.to_vec() };
    map.axes = vec![
        axis(FreeParameter::Wall, &[0.6e-3, 0.8e-3, 1.0e-3]),
        axis(FreeParameter::WindingAngle, &angles),
        axis(FreeParameter::ShearModulus, &[0.2e6, 0.393e6]),
    ];
    map.paths = (0..48).map(|node| if node / 2 % 8 < 5 { open.clone() } else { limited.clone() }).collect();
    // Only at the description's wall and modulus, and at one angle: another end of the path.
    if let Some(path) = &mut map.paths[16 + 2 * 2 + 1] {
        path.states[2].twist_per_length *= 2.0;
    }
    map
}

#[test]
fn a_small_map_has_its_curves_and_limit_points() {
    let map = samples::free_map();
    let charts = all(&map);
    let stems: Vec<&str> = charts.iter().map(|(stem, _)| stem.as_str()).collect();
    assert_eq!(
        stems,
        [
            "axial-stretch-by-winding-angle",
            "expansion-by-winding-angle",
            "twist-by-winding-angle",
            "limit-pressure"
        ]
    );
    let twist = chart(&charts, "twist-by-winding-angle");
    assert_eq!(named(twist), ["20°", "70°", "limit point"]);
    assert!(twist.legend.contains("from hoop") && twist.subtitle == "µ 0.393 MPa", "{}", twist.subtitle);
    let ring = twist.series.iter().find(|series| series.mark == crate::plot::Mark::Rings).unwrap();
    assert_eq!(ring.points.iter().map(|point| point.0).collect::<Vec<_>>(), [30.0]);
    // A solid's middle stands beside it.
    let solid = all(&samples::solid_map());
    assert_eq!(named(chart(&solid, "twist-by-winding-angle")), ["20°", "70°", "middle", "limit point"]);
    assert_eq!(named(chart(&solid, "expansion-by-winding-angle")), ["20°", "70°", "limit point"]);
}

#[test]
fn unstable_states_go_on_from_the_limit_point() {
    let mut map = samples::free_map();
    let path = map.paths[1].as_mut().unwrap();
    let mut state = *path.states.last().unwrap();
    state.pressure = 25e3;
    path.beyond = vec![state];
    let charts = all(&map);
    let twist = chart(&charts, "twist-by-winding-angle");
    let dashed = twist.series.iter().find(|series| series.mark == crate::plot::Mark::Dashed).unwrap();
    assert_eq!(dashed.points.iter().map(|point| point.0).collect::<Vec<_>>(), [30.0, 25.0]);
    assert!(named(twist).contains(&"unstable"));
}

#[test]
fn each_axis_is_a_family_at_the_values_of_the_description() {
    let map = wide();
    let charts = all(&map);
    let walls = chart(&charts, "twist-by-wall");
    assert_eq!(named(walls), ["0.6", "0.8", "1"]);
    assert_eq!(walls.subtitle, "µ 0.393 MPa, winding angle 30° from hoop");
    let ends: Vec<f64> = walls.series.iter().filter_map(|series| Some(series.points.last()?.1)).collect();
    assert!((ends[1] / ends[0] - 2.0).abs() < 1e-9 && (ends[2] / ends[0] - 1.0).abs() < 1e-9, "{ends:?}");
    assert_eq!(named(chart(&charts, "expansion-by-shear-modulus")), ["0.2", "0.393"]);

    // Over the angle, a curve ends where the paths do: at 40 kPa before 60 degrees.
    let over = chart(&charts, "twist-over-winding-angle");
    assert_eq!(named(over), ["20", "40", "greatest", "limit ahead"]);
    let last = |place: usize| over.series[place].runs().last().unwrap().last().unwrap().0.round();
    assert_eq!((last(0), last(1)), (80.0, 50.0));
    let ring = over.series.iter().find(|series| series.mark == crate::plot::Mark::Rings).unwrap();
    assert_eq!(ring.points[0].0.round(), 50.0);
    assert_eq!(map.paths[0].as_ref().unwrap().end, PathEnd::Range);

    for stem in [
        "design-space-twist-by-wall",
        "design-space-axial-stretch-by-shear-modulus",
        "limit-pressure-by-wall",
    ] {
        chart(&charts, stem);
    }
    let field = charts.iter().find(|(stem, _)| stem == "sensitivity-of-twist");
    let Some((_, Picture::Field(field))) = field else { panic!("no field") };
    // 30e-5 rad/m a pascal is 0.0171887 deg/mm a kilopascal, but for one path's last step to twice the twist.
    let slope = 0.3f64.to_degrees() * 1e-3;
    let usual = field.patches.iter().filter(|patch| (patch.value / slope - 1.0).abs() < 1e-9).count();
    assert_eq!((field.patches.len(), usual), (16, 15));
    assert_eq!(field.lines[0].points.iter().map(|point| point.0).collect::<Vec<_>>(), [30.0; 3]);
}

#[test]
fn values_are_spread_with_both_ends() {
    assert_eq!(spread(3, 8), [0, 1, 2]);
    assert_eq!(spread(36, 8), [0, 5, 10, 15, 20, 25, 30, 35]);
    assert_eq!((spread(1, 8), spread(5, 2)), (vec![0], vec![0, 4]));
}
