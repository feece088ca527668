//! Where modules buckle, and how: tubes that give way under a vacuum.

use super::*;
use crate::{SolidBuckling, SolidLoad, SolidMesh, SolidPath, SolidSolver, Specimen};

const MESH: [u32; 3] = [1, 12, 8];
/// Vacuum to which the search goes, Pa.
const GOAL: f64 = -12e3;
const TOLERANCE: f64 = 10.0;

/// Bare tubes side by side under a plate without weight.
fn tubes(count: usize) -> Module {
    let places = [[7.5e-3, 0.0], [-7.5e-3, 0.0]];
    let bare = free(60.0, Handedness::Right, 0);
    let frees: Vec<_> = places.into_iter().take(count).map(|place| (bare, place)).collect();
    let mut module = module(&frees, [0.0; 3]);
    module.base.free_mass = 0.0;
    module
}

fn buckling(module: &Module, goal: &[f64]) -> (SolidModule, SolidBuckling) {
    let mut solids = solids(module, MESH);
    let rest = solids.rest().unwrap();
    let found = solids.first_buckling(&rest, goal, TOLERANCE, &mut |_, _| true).unwrap().unwrap();
    (solids, found)
}

#[test]
fn one_tube_under_a_vacuum_buckles_where_the_solid_alone_does() {
    let (_, joined) = buckling(&tubes(1), &[GOAL]);
    let [below, above] =
        [&joined.below, joined.above.as_ref().unwrap()].map(|found| found.shape.pressures()[0]);
    assert!(above < below && below - above <= TOLERANCE);
    let mut alone =
        SolidSolver::new(&Specimen::from(&free(60.0, Handedness::Right, 0)), SolidMesh::of_elements(MESH))
            .unwrap();
    let rest = alone.rest();
    let path = SolidPath::Load(&SolidLoad::pressure);
    let critical = alone.critical_point(&path, (0.0, &rest), above - 1e3, 1.0).unwrap().unwrap();
    assert!(below + 1.0 >= critical.at && critical.at >= above - 1.0, "{below} {above} {}", critical.at);
    // Next to critical, and the plate stays where it is.
    let mode = joined.mode.unwrap();
    let length = |place: &[f64; 3]| place.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(length(&mode.tip_shift) < 1e-3, "{:?}", mode.tip_shift);
    assert!(mode.value < 0.0 && mode.value > -1e-3 && mode.error < 1e-6, "{} {}", mode.value, mode.error);
}

#[test]
fn the_wall_that_gives_way_is_the_one_without_air() {
    let module = tubes(2);
    let (solids, found) = buckling(&module, &[1e3, GOAL]);
    let mode = found.mode.unwrap();
    let shifts = mode.shifts();
    assert!((shifts[1] - 1.0).abs() < 1e-12 && shifts[0] < 0.05, "{shifts:?}");
    // In a ring half way up, the wall goes outwards and inwards in a few waves, and is not shifted as a whole.
    let lines = solids.bulges(&found.below.shape, &mode, 1);
    let ring: Vec<_> = lines.iter().map(|line| line[line.len() / 2]).collect();
    assert!(ring.iter().all(|point| (point.along - 15e-3).abs() < 1e-9));
    let wave = |n: f64| {
        let sums = ring.iter().fold([0.0; 2], |[c, s], point| {
            [c + point.outwards * (n * point.around).cos(), s + point.outwards * (n * point.around).sin()]
        });
        sums[0].hypot(sums[1]) / (0.5 * ring.len() as f64)
    };
    let [shifted, oval, three] = [1.0, 2.0, 3.0].map(wave);
    assert!(shifted < 0.05 && oval.max(three) > 0.5, "{shifted} {oval} {three}");
    let mut text = vec![];
    solids.write_vtu(&found.below.shape, Some(&mode), &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("buckling_mode") && text.contains("free_pressure_kpa"));
    let [ni, nj, nk] = [3, 24, 17];
    assert!(text.contains(&format!("NumberOfPoints=\"{}\"", 2 * ni * nj * nk)));
}

#[test]
fn a_search_that_is_stopped_says_so() {
    let mut solids = solids(&tubes(1), MESH);
    let rest = solids.rest().unwrap();
    let error = solids.first_buckling(&rest, &[GOAL], TOLERANCE, &mut |_, _| false).unwrap_err();
    assert!(matches!(error, SolidModuleError::Stopped), "{error}");
}
