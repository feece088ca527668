use super::*;
use actuator::PoseChart;

/// A map of pressures to position alone, with differences for its Jacobian.
#[derive(Clone, Copy)]
struct Made {
    domain: &'static [(f64, f64)],
    position: fn(&[f64]) -> [f64; 3],
}

impl PoseModel for Made {
    fn domain(&self) -> &[(f64, f64)] {
        self.domain
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        into.chart = PoseChart { twist: 0.0, bend: [0.0; 2], position: (self.position)(pressures) };
        Ok(())
    }
}

const CUBE: [(f64, f64); 5] = [(0.0, 1.0); 5];
const GENERATORS: [[f64; 3]; 4] = [[1.0, 0.1, 0.3], [-0.2, 0.9, 0.2], [0.3, -0.4, 0.8], [-0.6, -0.5, 0.4]];

fn zonotope(pressures: &[f64]) -> [f64; 3] {
    std::array::from_fn(|axis| pressures.iter().zip(GENERATORS).map(|(p, g)| p * g[axis]).sum())
}

/// A shell between two spheres, from 0.5 to 1, a quarter turn wide and 0.6 rad up and down.
fn shell(p: &[f64]) -> [f64; 3] {
    let (r, a, h) = (0.5 + 0.5 * p[0], std::f64::consts::FRAC_PI_2 * p[1], 1.2 * p[2] - 0.6);
    [r * h.cos() * a.cos(), r * h.cos() * a.sin(), r * h.sin()]
}

/// Reaches highest inside the box of pressures, at (1/2, 1/2) of the last two, around which it goes in closed lines.
fn dome(p: &[f64]) -> [f64; 3] {
    [p[0], p[1], 1.0 - 4.0 * ((p[2] - 0.5).powi(2) + (p[3] - 0.5).powi(2))]
}

fn computed(
    position: fn(&[f64]) -> [f64; 3],
    frees: usize,
    steps: usize,
    cells: usize,
    jobs: usize,
) -> ReachableSet {
    let model = Made { domain: &CUBE[..frees], position };
    let bounds = Bounds { lower: vec![0.0; frees], upper: vec![1.0; frees], limit: vec![2.0; frees] };
    let run = ReachRun { progress: &|_, _| (), is_stopped: &|| false };
    ReachableSet::compute(&|| model, &bounds, ReachSettings { steps, cells, jobs }, &run).unwrap()
}

fn exact_zonotope(generators: &[[f64; 3]]) -> f64 {
    let mut sum = 0.0;
    for i in 0..generators.len() {
        for j in 0..i {
            for k in 0..j {
                let [a, b, c] = [i, j, k].map(|g| nalgebra::Vector3::from(generators[g]));
                sum += a.cross(&b).dot(&c).abs();
            }
        }
    }
    sum
}

#[test]
fn a_linear_map_s_volume_is_that_of_a_zonotope() {
    for frees in [3, 4] {
        let exact = exact_zonotope(&GENERATORS[..frees]);
        // The simplices are exact: what is left is the lattice, whose columns miss a share of the rim.
        let off = |cells| (computed(zonotope, frees, 2, cells, 2).volume() / exact - 1.0).abs();
        let (coarse, fine) = (off(16), off(64));
        assert!(coarse < 1e-2 && fine < 1e-3, "{frees}: {coarse} {fine}");
    }
}

#[test]
fn five_pressures_are_seen_on_their_faces() {
    // A generator along another adds to it.
    let five = |p: &[f64]| zonotope(&[p[0] + 0.5 * p[4], p[1], p[2], p[3]]);
    let mut generators = GENERATORS;
    generators[0] = generators[0].map(|g| 1.5 * g);
    let exact = exact_zonotope(&generators);
    let found = computed(five, 5, 1, 48, 2).volume();
    assert!((found / exact - 1.0).abs() < 2e-3, "{found} {exact}");
}

#[test]
fn a_curved_set_s_error_falls_with_the_square_of_the_steps() {
    let exact = std::f64::consts::FRAC_PI_2 * 2.0 * 0.6f64.sin() * (1.0 - 0.125) / 3.0;
    let off = |steps, cells| (computed(shell, 3, steps, cells, 2).volume() / exact - 1.0).abs();
    let (coarse, middle, fine) = (off(4, 64), off(8, 64), off(16, 64));
    assert!(middle < 0.3 * coarse && fine < 0.3 * middle, "{coarse} {middle} {fine}");
    // Chords of angles a and h lie (a^2 + h^2)/12 of the radius inside on average: 3.8e-3 of this volume.
    assert!(fine < 3.8e-3, "{fine}");
}

#[test]
fn a_boundary_from_inside_the_box_is_found() {
    // Volume: from the lowest point, -1, to the top, which no face of the box reaches.
    for (steps, bound) in [(4, 0.02), (8, 0.005)] {
        let set = computed(dome, 4, steps, 32, 2);
        assert!((set.volume() / 2.0 - 1.0).abs() < bound, "{steps}: {}", set.volume());
    }
    let set = computed(dome, 4, 8, 32, 1);
    assert!((set.extent[2].1 - 1.0).abs() < 1e-12);
    let surface = set.surface();
    let top = surface.facets.iter().filter(|facet| surface.middle_and_area(facet).0[2] > 0.9);
    let (top, singular): (Vec<_>, Vec<_>) =
        top.filter(|facet| (0.1..0.9).contains(&surface.middle_and_area(facet).0[0])).partition(|_| true);
    assert!(singular.is_empty() && top.len() > 100);
    let inside = top.iter().filter(|facet| {
        let [x, y, _] = surface.middle_and_area(facet).0;
        (0.1..0.9).contains(&x) && (0.1..0.9).contains(&y)
    });
    assert!(inside.clone().count() > 100 && inside.clone().all(|facet| facet.face.dimension(4) >= 3));
    // The sides of the box at x = 0 are a face of it.
    let side = surface.facets.iter().filter(|facet| {
        let [x, _, z] = surface.middle_and_area(facet).0;
        x < 1e-6 && z.abs() < 0.5
    });
    assert!(side.clone().count() > 100 && side.clone().all(|facet| facet.face.is_least(0)));
}

#[test]
fn nothing_depends_on_the_number_of_threads() {
    let (one, three) = (computed(shell, 3, 6, 24, 1), computed(shell, 3, 6, 24, 3));
    assert!(one.columns == three.columns);
    assert_eq!(one.volume().to_bits(), three.volume().to_bits());
    let (one, three) = (computed(dome, 4, 3, 24, 1), computed(dome, 4, 3, 24, 3));
    assert!(one.columns == three.columns);
    assert!(one.surface() == three.surface());
}

#[test]
fn the_surface_is_closed_looks_outwards_and_encloses_the_volume() {
    let set = computed(shell, 3, 12, 48, 2);
    let surface = set.surface();
    // A surface net cuts edges: its volume is a little less.
    assert!((surface.volume() / set.volume() - 1.0).abs() < 0.01, "{} {}", surface.volume(), set.volume());
    let mut edges: std::collections::HashMap<[usize; 2], i32> = std::collections::HashMap::new();
    for facet in &surface.facets {
        for i in 0..4 {
            let (a, b) = (facet.corners[i], facet.corners[(i + 1) % 4]);
            *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|sum| *sum == 0));
    for facet in &surface.facets {
        let (middle, area) = surface.middle_and_area(facet);
        assert!(area >= 0.0 && middle.iter().all(|value| value.is_finite()));
    }
}

#[test]
fn the_reach_by_direction_is_exact_on_simplices() {
    // The farthest vertices of a zonotope: sums of the generators that point that way.
    let set = computed(zonotope, 4, 2, 16, 2);
    let reaches: Vec<_> = set.sideways.reaches().collect();
    assert_eq!(reaches.len(), 72);
    assert!(reaches.iter().all(|(_, reach)| reach.is_some()));
    let corners: Vec<[f64; 3]> =
        (0..16).map(|bits: u32| zonotope(&[0, 1, 2, 3].map(|i| f64::from(bits >> i & 1)))).collect();
    for (direction, reach) in &reaches {
        // The shadow is a convex polygon around the origin: the half-line leaves it where a pair of corners does.
        let along = |at: &[f64; 3]| direction.cos() * at[0] + direction.sin() * at[1];
        let beside = |at: &[f64; 3]| direction.cos() * at[1] - direction.sin() * at[0];
        let mut expected = 0.0f64;
        for a in &corners {
            for b in &corners {
                let part = beside(a) / (beside(a) - beside(b));
                if (0.0..=1.0).contains(&part) {
                    expected = expected.max(along(a) + part * (along(b) - along(a)));
                }
            }
        }
        assert!((reach.unwrap().0 - expected).abs() < 1e-9, "{direction}: {reach:?} {expected}");
    }
    // A quarter of a shell is met in a quarter of the directions, and in those next to its sides exactly at them.
    let set = computed(shell, 3, 12, 16, 1);
    assert_eq!(set.sideways.reaches().filter(|(_, reach)| reach.is_some()).count(), 19);
    let (_, reach) = set.sideways.reaches().next().unwrap();
    let (radius, height) = reach.unwrap();
    assert!((radius - 1.0).abs() < 1e-12 && height.abs() < 1e-12, "{radius} {height}");
}

#[test]
fn outlines_are_those_of_shadow_and_cut() {
    let set = computed(shell, 3, 12, 64, 2);
    let radius = |[x, y]: &[f64; 2]| x.hypot(*y);
    let shadow = set.shadow(2);
    assert!(shadow.len() > 100);
    let far = shadow.iter().flatten().filter(|at| radius(at) > 0.9 && at[0] > 0.1 && at[1] > 0.1);
    assert!(far.clone().count() > 50);
    for at in far {
        assert!((radius(at) - 1.0).abs() < 0.01, "{at:?}");
    }
    // Across z the plane's coordinates are x and y.
    let (height, cut) = set.cut(2, 0.3);
    assert!((height - 0.3).abs() <= 0.5 * set.spacing[2] + 1e-12);
    let ring = (1.0 - height * height).sqrt();
    let far = cut.iter().flatten().filter(|at| radius(at) > 0.9 * ring && at[0] > 0.1 && at[1] > 0.1);
    assert!(far.clone().count() > 50);
    for at in far {
        assert!((radius(at) / ring - 1.0).abs() < 0.01, "{at:?}");
    }
}

#[test]
fn a_flat_set_has_no_volume_and_says_so() {
    let two = computed(|p| [p[0], p[1], 1.0], 2, 4, 16, 1);
    assert!(two.is_flat() && two.volume() == 0.0 && two.surface().facets.is_empty());
    assert_eq!(two.extent, [(0.0, 1.0), (0.0, 1.0), (1.0, 1.0)]);
    let guided = computed(|p| [0.0, 0.0, p[0] + p[1] + p[2]], 3, 4, 16, 1);
    assert!(guided.is_flat() && guided.extent[2] == (0.0, 3.0) && guided.shadow(0).is_empty());
}

#[test]
fn positions_of_scattered_pressures_lie_in_the_set() {
    let set = computed(zonotope, 4, 2, 24, 1);
    let bounds = Bounds { lower: vec![0.0; 4], upper: vec![1.0; 4], limit: vec![2.0; 4] };
    let model = Made { domain: &CUBE[..4], position: zonotope };
    let scattered = positions(&model, &scattered_pressures(&bounds, 2000)).unwrap();
    assert_eq!(set.count_missed(scattered.iter()), 0);
    let moved: Vec<[f64; 3]> = scattered.iter().map(|at| [at[0] + 9.0, at[1], at[2]]).collect();
    assert_eq!(set.count_missed(moved.iter()), 2000);
}

#[test]
fn senseless_settings_and_stops_are_refused() {
    let model = Made { domain: &CUBE[..3], position: shell };
    let bounds = Bounds { lower: vec![0.0; 3], upper: vec![1.0; 3], limit: vec![2.0; 3] };
    let compute = |steps, cells, stopped: bool| {
        let is_stopped = move || stopped;
        let run = ReachRun { progress: &|_, _| (), is_stopped: &is_stopped };
        ReachableSet::compute(&|| model, &bounds, ReachSettings { steps, cells, jobs: 1 }, &run).unwrap_err()
    };
    assert!(compute(0, 16, false).to_string().contains("steps of each pressure: 0"));
    assert!(compute(4, 5000, false).to_string().contains("cells of the lattice"));
    assert_eq!(compute(4, 16, true), ReachError::Stopped);
}

#[test]
fn dexterity_is_that_of_the_jacobian() {
    let mut evaluation = PoseEvaluation::new(3, 0);
    evaluation.chart.position = [0.0, 0.0, 0.2];
    evaluation.chart.twist = 2.0;
    for (axis, (column, size)) in evaluation.jacobian.iter_mut().zip([1e-6, 2e-6, 4e-6]).enumerate() {
        column[3 + axis] = size;
    }
    let Dexterity { manipulability, condition } = Dexterity::of(&evaluation);
    assert!((manipulability / 8e-18 - 1.0).abs() < 1e-9 && (condition / 4.0 - 1.0).abs() < 1e-9);
    // A turn about the axis through the tip's centre does not move it.
    evaluation.jacobian[0] = [1e-5, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(Dexterity::of(&evaluation), Dexterity { manipulability: 0.0, condition: f64::INFINITY });
}
