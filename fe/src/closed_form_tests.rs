use super::*;
use actuator::{Elastomer, Fibre, FibreLaw, Handedness, OgdenForm, OgdenTerm, OgdenTerms, Tube, Winding};

/// The specimen of the published study: 9.52 mm tube with a 0.8 mm wall, six linear fibres of 644 N.
fn specimen(angle_deg: f64, shear_modulus: f64, axial_stiffness: f64, alpha: f64) -> Free {
    let fibre = Fibre { axial_stiffness, diameter: 3e-4, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 0.13, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle_deg.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus, alpha, form: OgdenForm::InitialModulus },
    }
}

fn twist_deg_per_mm(state: &FreeState) -> f64 {
    state.twist_per_length.to_degrees() * 1e-3
}

/// Half a unit of the last printed digit, and a hair for the printed number's own rounding.
fn assert_printed(value: f64, printed: f64, digits: i32, what: &str) {
    assert!((value - printed).abs() <= 0.5001 * 10f64.powi(-digits), "{what}: {value} against {printed}");
}

#[test]
fn bare_tube_meets_the_printed_table() {
    for (alpha, p_kpa, expansion, stretch) in [
        (0.8, 4.0, 1.014556, 1.000076),
        (0.8, 24.0, 1.114052, 1.004257),
        (1.2, 4.0, 1.014537, 1.000114),
        (1.2, 12.0, 1.047686, 1.001195),
        (1.2, 20.0, 1.088382, 1.003981),
        (1.2, 24.0, 1.112867, 1.006378),
        (2.0, 4.0, 1.014498, 1.000190),
        (2.0, 24.0, 1.110515, 1.010575),
    ] {
        let state = ThickTube::bare(&specimen(20.0, 0.393e6, 644.0, alpha)).free_state(p_kpa * 1e3).unwrap();
        let what = format!("alpha {alpha}, {p_kpa} kPa");
        assert_printed(state.expansion, expansion, 6, &what);
        assert_printed(state.axial_stretch, stretch, 6, &what);
    }
    // The energy as the study prints it, at 24 kPa.
    for (alpha, expansion) in [(0.8, 1.15993), (1.2, 1.08838), (2.0, 1.04727)] {
        let mut free = specimen(20.0, 0.393e6, 644.0, alpha);
        free.elastomer = Elastomer::Ogden { shear_modulus: 0.393e6, alpha, form: OgdenForm::Printed };
        let state = ThickTube::bare(&free).free_state(24e3).unwrap();
        assert_printed(state.expansion, expansion, 5, &format!("printed form, alpha {alpha}"));
    }
}

#[test]
fn smeared_fibres_meet_the_printed_table() {
    let (mu, ea) = (0.393e6, 644.0);
    for (angle, mu, ea, rows, limit) in [
        (10.0, mu, ea, [(10.0, 1.01944, 1.00389, -0.2585), (68.9, 1.18384, 1.03527, -2.3147)], 134.0),
        (20.0, mu, ea, [(30.0, 1.04203, 1.04325, -1.3187), (68.9, 1.14573, 1.13295, -3.8176)], 94.5),
        (30.0, mu, ea, [(50.0, 1.04741, 1.16000, -2.6968), (68.9, 1.11740, 1.30809, -4.7535)], 74.9),
        (40.0, mu, ea, [(20.0, 0.99797, 1.06902, -0.7719), (60.0, 1.04943, 1.39379, -3.7680)], 63.7),
        (50.0, mu, ea, [(30.0, 0.98902, 1.13972, -0.9368), (50.0, 0.99850, 1.34532, -2.1914)], 56.8),
        (60.0, mu, ea, [(10.0, 0.99499, 1.04009, -0.1428), (50.0, 0.99155, 1.45683, -1.7481)], 52.5),
        (70.0, mu, ea, [(20.0, 0.99335, 1.09206, -0.1459), (40.0, 0.98799, 1.27498, -0.5457)], 49.9),
        (80.0, mu, ea, [(20.0, 0.99787, 1.09110, -0.0388), (40.0, 0.99595, 1.28400, -0.2163)], 48.5),
        (20.0, mu / 2.0, ea, [(10.0, 1.02589, 1.02734, -0.8462), (40.0, 1.20329, 1.17826, -4.9894)], 47.3),
        (
            20.0,
            mu,
            ea / 2.0,
            [(10.0, 1.01197, 1.01318, -0.4067), (68.9, 1.14592, 1.13387, -3.8106)],
            f64::NAN,
        ),
    ] {
        let tube = ThickTube::new(&specimen(angle, mu, ea, 1.2));
        for (p_kpa, stretch, expansion, twist) in rows {
            let state = tube.free_state(p_kpa * 1e3).unwrap();
            let what = format!("{angle} deg, {p_kpa} kPa");
            assert_printed(state.axial_stretch, stretch, 5, &what);
            assert_printed(state.expansion, expansion, 5, &what);
            assert_printed(twist_deg_per_mm(&state), twist, 4, &what);
        }
        if limit.is_finite() {
            let found = tube.limit_state().unwrap();
            assert_printed(found.pressure * 1e-3, limit, 1, &format!("limit at {angle} deg"));
            assert!(tube.free_state(found.pressure * 1.0001).is_err());
            assert!(tube.free_state(found.pressure * 0.999).is_ok());
        }
    }
}

#[test]
fn enthalpy_derivatives_match_differences() {
    let mu = 0.393e6;
    let one = specimen(30.0, mu, 644.0, 1.2);
    let term = |share: f64, alpha| OgdenTerm { shear_modulus: share * mu, alpha };
    let terms = OgdenTerms::new(&[term(0.9, 1.3), term(0.02, 5.0), term(0.08, -2.0)]).unwrap();
    for elastomer in [
        one.elastomer,
        Elastomer::OgdenSeries { terms },
        Elastomer::MooneyRivlin { c10: 0.4 * mu, c01: 0.1 * mu },
        Elastomer::Gent { shear_modulus: mu, locking_invariant: 20.0 },
        Elastomer::StVenantKirchhoff { shear_modulus: mu },
        Elastomer::LinearElastic { shear_modulus: mu },
    ] {
        check_enthalpy(&ThickTube::new(&Free { elastomer, ..one }));
    }
}

fn check_enthalpy(tube: &ThickTube) {
    // Rest (equal principal stretches: the series), near it, and a state far from it (the closed formula).
    for at in [[1.0, 1.0, 0.0], [1.02, 1.01, 0.01], [1.5, 1.1, -0.3], [0.8, 1.3, 0.6]] {
        let at = Unknowns::from(at);
        let phi = tube.enthalpy(2e4, &at);
        for i in 0..3 {
            // Fourth-order differences, step 1e-3: truncation and rounding both near 1e-9 of the terms' size.
            let h = 1e-3;
            let shifted = |n: f64| {
                let mut moved = at;
                moved[i] += n * h;
                tube.enthalpy(2e4, &moved)
            };
            let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(shifted);
            let slope = (a.value - 8.0 * b.value + 8.0 * c.value - d.value) / (12.0 * h);
            assert!((slope - phi.gradient[i]).abs() < 1e-6 * phi.hessian.amax());
            let row = (a.gradient - b.gradient * 8.0 + c.gradient * 8.0 - d.gradient) / (12.0 * h);
            assert!((row - phi.hessian.column(i)).amax() < 1e-6 * phi.hessian.amax(), "{at} {i}");
        }
    }
}

#[test]
fn response_is_the_derivative_of_the_condensed_energy() {
    for law in [FibreLaw::Linear, FibreLaw::TensionOnly] {
        let mut free = specimen(30.0, 0.393e6, 644.0, 1.2);
        free.winding.fibre.law = law;
        let tube = ThickTube::new(&free);
        for (p, stretch, twist) in
            [(3e4, 1.05, -20.0), (1e4, 0.97, 15.0), (0.0, 1.08, -30.0), (0.0, 1.08, 30.0)]
        {
            let at = |ds: f64, dt: f64| tube.section(p, stretch + ds, twist + dt).unwrap();
            let here = at(0.0, 0.0);
            let (h, k) = (1e-4, 1e-2);
            let difference = |value: &dyn Fn(&SectionResponse) -> f64, stretched: bool| {
                let shift = |n: f64| if stretched { at(n * h, 0.0) } else { at(0.0, n * k) };
                let step = if stretched { h } else { k };
                let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|n| value(&shift(n)));
                (a - 8.0 * b + 8.0 * c - d) / (12.0 * step)
            };
            // Sizes of the terms: shear modulus times area, times B for torques, times B^2 for their slopes.
            let (force, arm) = (0.393e6 * free.tube.wall_area(), free.tube.outer_radius());
            let close =
                |a: f64, b: f64, size: f64| assert!((a - b).abs() < 1e-6 * size, "{a} {b} {law:?} {p}");
            close(here.force, difference(&|r| r.energy, true), force);
            close(here.torque, difference(&|r| r.energy, false), force * arm);
            close(here.stiffness[0][0], difference(&|r| r.force, true), 100.0 * force);
            close(here.stiffness[0][1], difference(&|r| r.force, false), 100.0 * force * arm);
            close(here.stiffness[1][0], difference(&|r| r.torque, true), 100.0 * force * arm);
            close(here.stiffness[1][1], difference(&|r| r.torque, false), 100.0 * force * arm * arm);
        }
    }
}

#[test]
fn section_at_the_free_state_is_free_of_force_and_torque() {
    let free = specimen(40.0, 0.393e6, 644.0, 1.2);
    let tube = ThickTube::new(&free);
    let state = tube.free_state(5e4).unwrap();
    let response = tube.section(5e4, state.axial_stretch, state.twist_per_length).unwrap();
    let force = 0.393e6 * free.tube.wall_area();
    assert!(response.force.abs() < 1e-8 * force, "{}", response.force);
    assert!(response.torque.abs() < 1e-8 * force * free.tube.outer_radius());
}

#[test]
fn young_modulus_is_three_times_mu_at_rest() {
    let free = specimen(30.0, 0.393e6, 644.0, 1.2);
    let response = ThickTube::bare(&free).section(0.0, 1.0, 0.0).unwrap();
    let expected = 3.0 * 0.393e6 * free.tube.wall_area();
    assert!((response.stiffness[0][0] / expected - 1.0).abs() < 1e-9);
    let polar = 2.0 * free.tube.second_moment();
    assert!((response.stiffness[1][1] / (0.393e6 * polar) - 1.0).abs() < 1e-9);
}

#[test]
fn a_ballooning_section_has_no_response() {
    let tube = ThickTube::new(&specimen(86.0, 0.393e6, 644.0, 1.2));
    // Nearly axial fibres would hold it again at several times the radius: another branch, not an answer.
    assert!(tube.section(9e4, 1.0, 0.0).is_none());
    assert!(tube.respond(9e4, 1.0, 0.0).energy.is_nan());
    assert!(tube.section(f64::NAN, 1.0, 0.0).is_none());
}

/// Loose threads do nothing until the bare tube has filled them, and are then as long as they are.
#[test]
fn loose_threads_wait_for_the_tube() {
    let mut free = specimen(60.0, 0.393e6, 644e3, 1.2);
    free.winding.fibre.law = FibreLaw::TensionOnly;
    let slack = 0.02;
    let (bare, loose) = (ThickTube::bare(&free), ThickTube::new(&free).with_slack(slack));
    let turn = free.winding.turn_per_length(free.tube.outer_radius()) * free.tube.outer_radius();
    let thread = |state: &FreeState| {
        let turned = turn + state.twist_per_length * free.tube.outer_radius();
        (((state.expansion * turned).powi(2) + state.axial_stretch.powi(2)) / (turn * turn + 1.0)).sqrt()
    };
    let [low, high] = [5e3, 3e4];
    let waiting = loose.free_state(low).unwrap();
    assert!(thread(&waiting) < 1.0 + slack);
    for (a, b) in waiting.deformation().into_iter().zip(bare.free_state(low).unwrap().deformation()) {
        assert!((a - b).abs() < 1e-9, "{waiting:?}");
    }
    let taut = loose.free_state(high).unwrap();
    assert!(thread(&bare.free_state(high).unwrap()) > 1.0 + slack);
    // Of threads a thousand times stiffer than cotton 1e-5 of strain is left.
    assert!((thread(&taut) - 1.0 - slack).abs() < 2e-5, "{}", thread(&taut));
}
