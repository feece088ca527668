//! An injected effect is found and named with its numbers, and with none injected none is claimed, although the model that is fitted is not the one
//! that made the recordings.

mod common;

use common::{PARAMETERS, Synthetic, effect, module, recordings};
use identify::{Finding, IdentifyError, ModuleMechanics, Options, Outcome, Verdict, Watch, identify_module};
use rom::effect::{Effect, EffectKind};
use std::sync::atomic::{AtomicBool, Ordering};

fn identify(effects: Vec<Effect>, missing: f64, outliers: f64) -> Outcome {
    let (fit, held) = recordings(effects, missing, outliers);
    let model = Synthetic::fitted();
    let module = module();
    let mechanics = ModuleMechanics::new(&model, &PARAMETERS, &module);
    let stop = AtomicBool::new(false);
    let outcome =
        identify_module(&mechanics, &fit, &held, &Options::default(), &Watch { tell: &|_| (), stop: &stop })
            .unwrap();
    println!("{}", outcome.log.join("\n"));
    println!("{}", serde_json::to_string_pretty(&outcome.verdict).unwrap());
    outcome
}

fn names(verdict: &Verdict) -> Vec<&str> {
    verdict.effects.iter().map(|effect| effect.name.as_str()).collect()
}

/// Checks that a number was found within a tolerance that covers the difference of the two models.
fn near(verdict: &Verdict, parameter: &str, value: f64, tolerance: f64) {
    let found = verdict.effects[0].parameters[parameter];
    assert!((found.value - value).abs() < tolerance, "{parameter} = {} instead of {value}", found.value);
    assert!(found.ci95[0] < found.value && found.value < found.ci95[1]);
}

#[test]
fn nothing_is_claimed_where_nothing_is_missing() {
    let verdict = identify(vec![], 0.0, 0.0).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::NothingMissing, vec![]));
    let held_out = verdict.held_out.unwrap();
    assert!(held_out.calibrated.position_rms_mm < held_out.before.position_rms_mm);
}

#[test]
fn a_stiffer_rubber_is_named() {
    let verdict = identify(vec![effect(EffectKind::Stiffness, &[0.2])], 0.0, 0.0).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::Explained, vec!["stiffness"]));
    // The two models differ by 4 % of stiffness, and that stays in the number.
    near(&verdict, "change", 0.2, 0.05);
}

#[test]
fn a_lag_of_the_supply_is_named_with_both_time_constants() {
    let verdict = identify(vec![effect(EffectKind::SupplyLag, &[0.25, 0.4])], 0.0, 0.0).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::Explained, vec!["supply_lag"]));
    near(&verdict, "fill_time_constant_s", 0.25, 0.005);
    near(&verdict, "vent_time_constant_s", 0.4, 0.005);
    let (reading, command) = (verdict.held_out.unwrap(), verdict.held_out_from_command.unwrap());
    // The reading contains the lag, so it shows only from the command.
    assert!(command.calibrated.rotation_rms_deg.unwrap() > 2.0 * command.after.rotation_rms_deg.unwrap());
    assert!(reading.calibrated.rotation_rms_deg.unwrap() < 1.1 * reading.after.rotation_rms_deg.unwrap());
}

#[test]
fn a_payload_is_named() {
    let verdict = identify(vec![effect(EffectKind::Payload, &[0.06])], 0.0, 0.0).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::Explained, vec!["payload"]));
    near(&verdict, "mass_g", 60.0, 12.0);
}

#[test]
fn hysteresis_is_named() {
    let verdict = identify(vec![effect(EffectKind::Hysteresis, &[2e3, 0.8])], 0.0, 0.0).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::Explained, vec!["hysteresis"]));
    near(&verdict, "radius_kpa", 2.0, 0.3);
    near(&verdict, "share", 0.8, 0.1);
}

#[test]
fn a_tilted_base_is_named() {
    let verdict =
        identify(vec![effect(EffectKind::BaseFrame, &[0.05, -0.03, 0.0, 1e-3, 0.0, 0.0])], 0.0, 0.0).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::Explained, vec!["base_frame"]));
    near(&verdict, "rotation_x_deg", 0.05f64.to_degrees(), 0.2);
}

#[test]
fn a_biased_sensor_is_named() {
    let mut bias = effect(EffectKind::PressureBias, &[1.5e3]);
    bias.frees = vec![2];
    let verdict = identify(vec![bias], 0.0, 0.0).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::Explained, vec!["pressure_bias"]));
    assert_eq!(verdict.effects[0].frees, [3]);
    near(&verdict, "bias_kpa", 1.5, 0.1);
}

#[test]
fn missing_samples_and_outliers_change_neither_names_nor_numbers() {
    let verdict = identify(vec![effect(EffectKind::Hysteresis, &[2e3, 0.8])], 0.03, 0.01).verdict;
    assert_eq!(names(&verdict), ["hysteresis"]);
    near(&verdict, "radius_kpa", 2.0, 0.3);
    let verdict = identify(vec![], 0.03, 0.01).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::NothingMissing, vec![]));
}

#[test]
fn two_effects_at_once_are_both_named() {
    let both = vec![effect(EffectKind::SupplyLag, &[0.2, 0.3]), effect(EffectKind::Creep, &[0.1, 15.0])];
    let verdict = identify(both, 0.0, 0.0).verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::Explained, vec!["supply_lag", "creep"]));
}

#[test]
fn the_same_recordings_give_the_same_answer_and_a_recording_cannot_be_on_both_sides() {
    let (fit, held) = recordings(vec![], 0.0, 0.0);
    let (model, module) = (Synthetic::fitted(), module());
    let mechanics = ModuleMechanics::new(&model, &PARAMETERS, &module);
    let stop = AtomicBool::new(false);
    let watch = Watch { tell: &|_| (), stop: &stop };
    let run =
        |held: &[record::Recording]| identify_module(&mechanics, &fit, held, &Options::default(), &watch);
    let (one, two) = (run(&held).unwrap(), run(&held).unwrap());
    assert_eq!(serde_json::to_string(&one.verdict).unwrap(), serde_json::to_string(&two.verdict).unwrap());
    let overlap = run(&fit[2..3]).unwrap_err();
    assert!(matches!(overlap, IdentifyError::Overlap { .. }), "{overlap}");
    stop.store(true, Ordering::Relaxed);
    assert!(matches!(run(&held).unwrap_err(), IdentifyError::Stopped));
}

#[test]
fn without_a_reading_the_command_drives_and_without_a_command_the_reading() {
    let (mut fit, mut held) = recordings(vec![], 0.0, 0.0);
    let (model, module) = (Synthetic::fitted(), module());
    let mechanics = ModuleMechanics::new(&model, &PARAMETERS, &module);
    let stop = AtomicBool::new(false);
    let watch = Watch { tell: &|_| (), stop: &stop };
    for recording in fit.iter_mut().chain(&mut held) {
        recording.pressure.clear();
    }
    let verdict = identify_module(&mechanics, &fit, &held, &Options::default(), &watch).unwrap().verdict;
    assert!(verdict.held_out.is_none() && verdict.held_out_from_command.is_some());
    assert_eq!(names(&verdict), [""; 0]);
    for recording in fit.iter_mut().chain(&mut held) {
        recording.command.clear();
    }
    let nothing = identify_module(&mechanics, &fit, &held, &Options::default(), &watch).unwrap_err();
    assert!(nothing.to_string().contains("neither commands nor readings of 4 pressures"), "{nothing}");
}

#[test]
fn the_answer_has_the_documented_shape() {
    let verdict = identify(vec![effect(EffectKind::SupplyLag, &[0.25, 0.4])], 0.0, 0.0).verdict;
    let json = serde_json::to_value(&verdict).unwrap();
    assert_eq!(json["verdict"], "explained");
    let lag = &json["effects"][0];
    assert_eq!((&lag["name"], &lag["link"]), (&"supply_lag".into(), &"supply".into()));
    assert_eq!(lag["frees"], serde_json::json!([1, 2, 3, 4]));
    let time = &lag["parameters"]["fill_time_constant_s"];
    assert!(time["value"].is_f64() && time["ci95"].as_array().unwrap().len() == 2);
    assert!(lag["indistinguishable_from"].is_array() && lag["gain_held_out"].is_f64());
    assert!(json["calibration"]["stiffness_scale"]["value"].is_f64());
    for drive in ["held_out", "held_out_from_command"] {
        for stage in ["before", "calibrated", "after", "noise"] {
            assert!(
                json[drive][stage]["position_rms_mm"].is_f64()
                    && json[drive][stage]["rotation_rms_deg"].is_f64()
            );
        }
    }
    assert!(json["residual_after"]["white"].is_boolean() && json["residual_after"]["structure"].is_string());
    assert!(json["next_experiment"].is_string() && json["seconds"].is_f64());
    let back: Verdict = serde_json::from_value(json).unwrap();
    assert_eq!(back, verdict);
}

#[test]
fn the_sets_are_kept_apart_in_what_is_reported() {
    let outcome = identify(vec![], 0.0, 0.0);
    let named = |held_out: bool| -> Vec<&str> {
        let chosen = outcome.series.iter().filter(|series| series.is_held_out == held_out);
        chosen.map(|series| series.name.as_str()).collect()
    };
    assert_eq!(named(false), ["staircase", "triangles", "setpoints", "holds"]);
    assert_eq!(named(true), ["smooth"]);
}

#[test]
fn a_play_as_narrow_as_the_noise_is_no_hysteresis() {
    // Long holds judge best what smooths the reading: there a play of one standard deviation of its noise gains.
    let (mut fit, mut held) = recordings(vec![], 0.0, 0.0);
    std::mem::swap(&mut fit[3], &mut held[0]);
    let (model, module) = (Synthetic::fitted(), module());
    let mechanics = ModuleMechanics::new(&model, &PARAMETERS, &module);
    let stop = AtomicBool::new(false);
    let watch = Watch { tell: &|_| (), stop: &stop };
    let verdict = identify_module(&mechanics, &fit, &held, &Options::default(), &watch).unwrap().verdict;
    assert_eq!((verdict.verdict, names(&verdict)), (Finding::NothingMissing, vec![]));
}
