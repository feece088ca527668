//! A single FREE of few quasi-static points: hysteresis is found where it was put in, nothing is claimed where nothing was, and the errors told are of
//! points that took no part in the fit.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use identify::{
    Finding, FreeMechanics, FreeResponse, IdentifyError, Outcome, Tolerances, Watch, identify_free,
};
use record::{Motion, Recording};
use rom::OutOfDomain;
use rom::effect::{Chain, Effect, EffectKind};
use std::sync::atomic::AtomicBool;

/// Analytic FREE that softens; the maker's softens otherwise than the fitted one.
struct Analytic {
    soft: f64,
}

impl FreeResponse for Analytic {
    fn respond(&self, pressure: f64, winding_angle: f64, modulus: f64) -> Result<[f64; 3], OutOfDomain> {
        let x = pressure / modulus;
        let f = x * (1.0 + self.soft * x);
        Ok([1.0 + 0.6 * f * (winding_angle - 1.0), 1.0 + f, 110.0 * f * (2.0 * winding_angle).sin()])
    }

    fn domain(&self, _: f64, modulus: f64) -> (f64, f64) {
        (0.0, 0.5 * modulus)
    }

    fn winding_angles(&self) -> (f64, f64) {
        (0.5, 1.2)
    }
}

fn free() -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::TensionOnly };
    Free {
        tube: Tube { length: 0.0864, inner_radius: 4.76e-3, wall: 1.59e-3 },
        winding: Winding::from_hoop(0.87, Handedness::Left, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

/// Up in two cycles and down in the second, 29 points, with a small error that looks random.
fn record(chain: &Chain) -> Recording {
    let maker = Analytic { soft: 2.1 };
    let up = |count: usize| (0..count).map(move |k| 17e3 + 73e3 * k as f64 / (count - 1) as f64);
    let path: Vec<f64> = up(10).chain(up(10)).chain(up(10).rev().skip(1)).collect();
    let mut state = chain.at_rest(1);
    let (mut twist, mut extension, mut diameter) = (Vec::new(), Vec::new(), Vec::new());
    for (k, pressure) in path.iter().enumerate() {
        let mut own = [*pressure];
        chain.deform(&mut state, 10.0, &mut own);
        let [stretch, expansion, turn] = maker.respond(own[0], 0.87, 0.393e6).unwrap();
        let shake = (7.3 * k as f64).sin();
        twist.push(turn * 0.0864 + 0.02 * shake);
        extension.push((stretch - 1.0) * 0.0864 + 5e-5 * shake);
        diameter.push(expansion * 0.0127);
    }
    let count = path.len();
    Recording {
        name: "cycles".into(),
        time: (0..count).map(|k| 10.0 * k as f64).collect(),
        command: vec![],
        pressure: vec![path],
        motion: Motion::Free {
            twist,
            extension,
            outer_diameter: diameter,
            torque: vec![0.0; count],
            force: vec![f64::NAN; count],
        },
    }
}

fn identify(recording: &Recording) -> Result<Outcome, IdentifyError> {
    let model = Analytic { soft: 1.9 };
    let mechanics = FreeMechanics::new(&model, free());
    let stop = AtomicBool::new(false);
    let outcome = identify_free(
        &mechanics,
        std::slice::from_ref(recording),
        &Tolerances::default(),
        &Watch { tell: &|_| (), stop: &stop },
    )?;
    println!("{}\n{}", outcome.log.join("\n"), serde_json::to_string_pretty(&outcome.verdict).unwrap());
    Ok(outcome)
}

#[test]
fn hysteresis_of_a_free_is_named_and_improves_points_that_were_held_out() {
    let play = Effect { kind: EffectKind::Hysteresis, frees: vec![0], values: vec![6e3, 0.8] };
    let outcome = identify(&record(&Chain { effects: vec![play] })).unwrap();
    let verdict = &outcome.verdict;
    let names: Vec<&str> = verdict.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!((verdict.verdict, names), (Finding::Explained, vec!["hysteresis"]));
    // Radius and share are known apart only from the few points about a reversal; their product is the loop's half-width.
    let [radius, share] = ["radius_kpa", "share"].map(|name| verdict.effects[0].parameters[name].value);
    assert!((radius * share - 4.8).abs() < 1.0, "{radius} {share}");
    let stages = verdict.held_out.unwrap();
    // The shake and the other softening stay; the loop is the larger half of the mean square.
    assert!(stages.after.twist_rms_rad.unwrap() < 0.7 * stages.calibrated.twist_rms_rad.unwrap());
    assert!(stages.before.extension_rms_mm.is_some() && stages.before.position_rms_mm.is_none());
    assert_eq!(outcome.series[0].before[0].len(), 29);
}

#[test]
fn nothing_is_claimed_of_a_free_that_lacks_nothing() {
    let verdict = identify(&record(&Chain::default())).unwrap().verdict;
    assert_eq!(verdict.verdict, Finding::NothingMissing, "{:?}", verdict.effects);
}

#[test]
fn a_length_that_moves_against_the_model_is_told_and_left_out() {
    let mut recording = record(&Chain::default());
    if let Motion::Free { extension, .. } = &mut recording.motion {
        extension.iter_mut().for_each(|length| *length = -*length);
    }
    let verdict = identify(&recording).unwrap().verdict;
    assert!(verdict.findings.iter().any(|finding| finding.contains("change of length moves against")));
    assert_eq!(verdict.verdict, Finding::NothingMissing);
}

#[test]
fn too_few_points_are_refused_with_their_number() {
    let mut recording = record(&Chain::default());
    if let Motion::Free { twist, extension, outer_diameter, .. } = &mut recording.motion {
        for channel in [twist, extension, outer_diameter] {
            channel[5..].fill(f64::NAN);
        }
    }
    let error = identify(&recording).unwrap_err();
    assert!(error.to_string().contains("has 5 samples with a deformation; at least 8"), "{error}");
}
