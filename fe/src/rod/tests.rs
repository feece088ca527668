use super::{
    element::ElementLaw,
    motion::{Frame, joined},
    *,
};
use crate::{BendingLaw, BendingResponse, ConstantBending, SectionLaw, SectionResponse, ThickTube};
use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, Module, OgdenForm, PlacedFree, PoseChart, Tip, Tube,
    Winding,
};
use nalgebra::{UnitQuaternion, Vector3, Vector6};
use std::{f64::consts::PI, sync::Arc};

/// Phi = EA (lambda - 1)^2/2 + GJ tau^2/2 - p (area (lambda - 1) + arm tau), in the units of the test.
struct Linear {
    axial: f64,
    torsion: f64,
    area: f64,
    arm: f64,
}

impl SectionLaw for Linear {
    fn respond(&self, p: f64, stretch: f64, twist: f64) -> SectionResponse {
        let strain = stretch - 1.0;
        SectionResponse {
            energy: 0.5 * self.axial * strain * strain + 0.5 * self.torsion * twist * twist
                - p * (self.area * strain + self.arm * twist),
            force: self.axial * strain - p * self.area,
            torque: self.torsion * twist - p * self.arm,
            stiffness: [[self.axial, 0.0], [0.0, self.torsion]],
        }
    }
}

const MU: f64 = 0.393e6;

fn free(angle_deg: f64, handedness: Handedness) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::TensionOnly };
    Free {
        tube: Tube { length: 0.175, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle_deg.to_radians(), handedness, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: MU, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn at(free: Free, x: f64, y: f64) -> PlacedFree {
    PlacedFree { free, position: [x, y] }
}

fn module(frees: Vec<PlacedFree>) -> Module {
    let tip = Tip { plate_mass: 0.0, payload: 0.0, free_dof: [true; 6] };
    Module { frees, tip, base: Base { gravity: [0.0; 3], free_mass: 0.0 }, spacers: 0 }
}

/// Four 30 degree FREEs on the corners of a square of 15 mm, hands in turn.
fn left_right(gravity: [f64; 3]) -> Module {
    use Handedness::{Left, Right};
    let s = 7.5e-3;
    let corners = [(s, s, Right), (-s, s, Left), (-s, -s, Right), (s, -s, Left)];
    let mut module = module(corners.map(|(x, y, hand)| at(free(30.0, hand), x, y)).to_vec());
    module.base = Base { gravity, free_mass: 4.3e-3 };
    module.tip.plate_mass = 5e-3;
    module
}

/// With the bending of the bare tubes.
fn with_sections(module: &Module, sections: Vec<Arc<dyn SectionLaw>>, settings: RodSettings) -> RodModule {
    let law = |(section, placed): (Arc<dyn SectionLaw>, &PlacedFree)| RodLaw {
        section,
        bending: Arc::new(ConstantBending::of_bare_tube(&placed.free)),
    };
    RodModule::new(module, sections.into_iter().zip(&module.frees).map(law).collect(), settings).unwrap()
}

fn analytic(module: &Module, settings: RodSettings) -> RodModule {
    let law = |placed: &PlacedFree| Arc::new(ThickTube::new(&placed.free)) as Arc<dyn SectionLaw>;
    with_sections(module, module.frees.iter().map(law).collect(), settings)
}

fn linear(module: &Module, law: Linear, settings: RodSettings) -> RodModule {
    let law: Arc<dyn SectionLaw> = Arc::new(law);
    with_sections(module, vec![law; module.frees.len()], settings)
}

fn bending(free: &Free) -> f64 {
    3.0 * MU * free.tube.second_moment()
}

/// A law stiff enough along the axis not to matter beside bending.
const STIFF: Linear = Linear { axial: 1e3, torsion: 1e-3, area: 0.0, arm: 0.0 };

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

/// Stiffnesses that change with pressure, stretch, twist and ends, for tests of derivatives.
struct Varying;

impl BendingLaw for Varying {
    fn respond(&self, p: f64, stretch: f64, twist: f64, ends: f64) -> BendingResponse {
        let sizes = [4e-4 * (1.0 + 1e-3 * ends), 3e-3, 10.0];
        let (a, b, c) = (1.7 * (stretch - 1.0), 0.02 * twist, 1.0 + p / 5e4);
        let value = c * (1.0 + a + b + a * a - 0.5 * a * b + 0.3 * b * b);
        let slopes = [c * 1.7 * (1.0 + 2.0 * a - 0.5 * b), c * 0.02 * (1.0 - 0.5 * a + 0.6 * b)];
        let curvatures = [c * 1.7 * 1.7 * 2.0, c * 1.7 * 0.02 * -0.5, c * 0.02 * 0.02 * 0.6];
        let signs = [1.0, -1.0, 0.5];
        BendingResponse {
            stiffness: std::array::from_fn(|i| sizes[i] * (1.0 + signs[i] * value)),
            slopes: slopes.map(|slope| std::array::from_fn(|i| sizes[i] * signs[i] * slope)),
            curvatures: curvatures.map(|curvature| std::array::from_fn(|i| sizes[i] * signs[i] * curvature)),
        }
    }

    fn respond_tied(&self, p: f64, stretch: f64, twist: f64, ends: f64) -> BendingResponse {
        self.respond(1.5 * p, stretch, twist, ends)
    }
}

#[test]
fn element_derivatives_match_differences() {
    let tube = ThickTube::new(&free(30.0, Handedness::Right));
    for (hand, held_at) in
        [(1.0, None), (-1.0, None), (1.0, Some([7e-3, -4e-3])), (-1.0, Some([-7e-3, 4e-3]))]
    {
        let law = ElementLaw {
            section: &tube,
            hand,
            bending: &Varying,
            bending_scale: 0.8,
            held_at,
            length: 0.02,
            ends: 50.0,
        };
        let a = Frame {
            rotation: UnitQuaternion::from_scaled_axis(Vector3::new(0.3, -0.5, 1.4)),
            position: Vector3::new(0.01, 0.02, 0.03),
        };
        let b = a.moved(&joined(Vector3::new(1e-3, -2e-3, 0.0216), Vector3::new(0.3, -0.2, -0.5 * hand)));
        let element = law.evaluate(&a, &b, 3e4, true).unwrap();
        // Natural units: 10 mm, 1 N. Fourth-order differences of step 1e-3.
        let unit = |i: usize| Vector6::ith(i, if i < 3 { 1e-2 } else { 1.0 });
        let move_both = |i: usize, e: f64| {
            if i < 6 { (a.moved(&(unit(i) * e)), b) } else { (a, b.moved(&(unit(i - 6) * e))) }
        };
        let energy = |i: usize, j: usize, e: f64, f: f64| {
            // Along exp(e u_i + f u_j) on one node, or on two.
            let (mut at_a, mut at_b) = (Vector6::zeros(), Vector6::zeros());
            for (k, step) in [(i, e), (j, f)] {
                if k < 6 { at_a += unit(k) * step } else { at_b += unit(k - 6) * step }
            }
            law.evaluate(&a.moved(&at_a), &b.moved(&at_b), 3e4, false).unwrap().energy
        };
        let h = 1e-3;
        for i in 0..12 {
            let value = |e: f64| {
                let (a, b) = move_both(i, e);
                law.evaluate(&a, &b, 3e4, false).unwrap().energy
            };
            let slope = (value(-2.0 * h) - 8.0 * value(-h) + 8.0 * value(h) - value(2.0 * h)) / (12.0 * h);
            let exact = element.gradient[i / 6].dot(&unit(i % 6));
            assert!((slope - exact).abs() < 1e-9, "{i}: {slope} {exact}");
            for j in 0..12 {
                let mixed = |s: f64| {
                    let s = s * h;
                    (energy(i, j, s, s) - energy(i, j, s, -s) - energy(i, j, -s, s) + energy(i, j, -s, -s))
                        / (4.0 * s * s)
                };
                let difference = (4.0 * mixed(1.0) - mixed(2.0)) / 3.0;
                let [aa, ab, bb] = element.tangent;
                let block = match (i < 6, j < 6) {
                    (true, true) => aa,
                    (true, false) => ab,
                    (false, true) => ab.transpose(),
                    (false, false) => bb,
                };
                let exact = unit(i % 6).dot(&(block * unit(j % 6)));
                // Energies of 1e-3 J: rounding leaves 1e-19/1e-6.
                assert!((difference - exact).abs() < 1e-9, "{i} {j}: {difference} {exact}");
            }
        }
        let pressed = |p: f64| law.evaluate(&a, &b, p, false).unwrap().gradient;
        for node in 0..2 {
            let slope = (pressed(3.1e4)[node] - pressed(2.9e4)[node]) / 2e3;
            assert!((slope - element.pressure_gradient[node]).amax() < 1e-5 * slope.amax());
        }
        let softer = ElementLaw { bending_scale: 0.4, ..law }.evaluate(&a, &b, 3e4, false).unwrap();
        for node in 0..2 {
            let half = element.gradient[node] - softer.gradient[node];
            assert!((half - element.bending_gradient[node] * 0.5).amax() < 1e-12);
        }
    }
}

#[test]
fn end_moment_bends_a_cantilever_to_a_circle() {
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    // In the plane x, z: the bend may pass half a turn there.
    module.tip.free_dof = [true, false, true, false, true, false];
    let length = module.length();
    for turns in [0.5, 1.0] {
        let moment = bending(&module.frees[0].free) * 2.0 * PI * turns / length;
        let tip_load = TipLoad { force: [0.0; 3], moment: [0.0, moment, 0.0] };
        let rods = linear(&module, STIFF, RodSettings { tip_load, ..RodSettings::default() });
        let chart = rods.rest().unwrap().state.chart;
        // Constant strain: exact for any number of elements, up to the residual's tolerance.
        assert!((chart.bend[1] - 2.0 * PI * turns).abs() < 1e-7, "{chart:?}");
        let x = length * (1.0 - (2.0 * PI * turns).cos()) / (2.0 * PI * turns);
        assert!((chart.position[0] - x).abs() < 1e-7 * length, "{chart:?}");
        assert!(chart.position[2].abs() < 1e-7 * length);
    }
}

#[test]
fn cantilever_converges_with_second_order() {
    // Tip force across: large deflection, F L^2/EI = 2. So soft in bending that shear and stretch do not matter.
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = [true, false, true, false, true, false];
    let free = module.frees[0].free;
    let ei = 0.01 * bending(&free);
    let soft = ConstantBending { bending: ei, ..ConstantBending::of_bare_tube(&free) };
    let tip_load = TipLoad { force: [2.0 * ei / module.length().powi(2), 0.0, 0.0], moment: [0.0; 3] };
    let tip = |elements: usize| {
        let law = RodLaw { section: Arc::new(STIFF), bending: Arc::new(soft) };
        let settings = RodSettings { elements, tip_load, ..RodSettings::default() };
        let rods = RodModule::new(&module, vec![law], settings).unwrap();
        rods.rest().unwrap().state.chart.position[0]
    };
    let [coarse, middle, fine] = [5, 10, 20].map(tip);
    let order = ((coarse - middle) / (middle - fine)).log2();
    assert!((order - 2.0).abs() < 0.05, "{order}");
    // Elastica (Bisshopp and Drucker): 0.4935 L at F L^2/EI = 2; shear adds F/GA = 3e-5.
    let limit = (fine + (fine - middle) / 3.0) / module.length();
    assert!((limit - 0.4935).abs() < 1e-4, "{limit}");
}

#[test]
fn a_clamped_rod_buckles_at_euler_load() {
    // Both ends clamped, the tip free to slide sideways: P = pi^2 EI/L^2, as is known for a rod with a guided end.
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = [true, false, true, false, false, false];
    let (length, ei) = (module.length(), bending(&module.frees[0].free));
    let shear = MU * module.frees[0].free.tube.wall_area();
    let negative = |load: f64, elements: usize| {
        let tip_load = TipLoad { force: [0.0, 0.0, -load], moment: [0.0; 3] };
        let rods = linear(&module, STIFF, RodSettings { elements, tip_load, bending_stiffness_scale: 1.0 });
        rods.rest().unwrap().state.negative_pivots
    };
    let euler = PI * PI * ei / (length * length);
    // With shear stiffness in series (Engesser): 1/P = 1/P_Euler + 1/GA.
    let expected = 1.0 / (1.0 / euler + 1.0 / shear);
    let critical = |elements: usize| {
        let (mut low, mut high) = (0.5 * euler, 1.5 * euler);
        assert_eq!(negative(low, elements), 0);
        assert_eq!(negative(high, elements), 1);
        while high - low > 1e-6 * euler {
            let middle = 0.5 * (low + high);
            if negative(middle, elements) == 0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let [coarse, fine] = [10, 20].map(|elements| critical(elements) / expected - 1.0);
    // The mesh errs with 1/n^2; what is left of it is the axial shortening P/EA of 1e-6 and Engesser's own order (P/GA)^2.
    assert!((coarse / fine - 4.0).abs() < 0.4, "{coarse} {fine}");
    assert!(((4.0 * fine - coarse) / 3.0).abs() < 1e-3, "{coarse} {fine}");
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
    let RodError::NoEquilibrium { reached, .. } = &too_much else { panic!("{too_much}") };
    assert!(reached[0] > 6e4 && reached[0] < 1.5e5, "{too_much}");
    let settings = RodSettings { bending_stiffness_scale: -1.0, ..RodSettings::default() };
    assert!(RodModule::new(&module, Vec::new(), settings).is_err());
}

#[test]
fn a_fully_clamped_rod_buckles_inside() {
    // Clamped ends that do not slide sideways: 4 pi^2 EI/L^2, in both planes at once, and in the inner nodes alone.
    let mut module = module(vec![at(free(30.0, Handedness::Right), 0.0, 0.0)]);
    module.tip.free_dof = [false, false, true, false, false, true];
    let euler = 4.0 * PI * PI * bending(&module.frees[0].free) / module.length().powi(2);
    for (part, negative) in [(0.85, 0), (1.15, 2)] {
        let tip_load = TipLoad { force: [0.0, 0.0, -part * euler], moment: [0.0; 3] };
        let rods = linear(&module, STIFF, RodSettings { tip_load, elements: 16, ..RodSettings::default() });
        assert_eq!(rods.rest().unwrap().state.negative_pivots, negative, "{part}");
    }
}

#[test]
fn a_tabulated_law_places_the_tip_like_the_law_itself() {
    let module = left_right([0.0, 0.0, 1.0]);
    let tube = ThickTube::new(&free(30.0, Handedness::Right));
    let states = (0..=8).map(|i| tube.free_state(5e4 * i as f64 / 8.0).unwrap()).collect();
    let path = actuator::FreePath::solved(states, actuator::PathEnd::Range);
    let grid = TableGrid::for_free(&free(30.0, Handedness::Right), &path, 5e4);
    let stop = std::sync::atomic::AtomicBool::new(false);
    let run = crate::Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let law = tube.clone();
    let table = SectionTable::tabulate(grid, &move |p, l, t| law.section(p, l, t), &run).unwrap();
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
