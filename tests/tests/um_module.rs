//! The real module of the University of Michigan, where its recording is at hand: what the rods say of it and what they do not.

use actuator::{Description, Handedness, Rig};
use freeact_tests::{
    measured,
    plateau::{Plateau, plateaus},
    um_module::{Errors, Predictor, Variation, ranges},
};

#[test]
fn hands_agree_and_the_drawing_is_too_soft() {
    let Some(folder) = measured("um-module") else {
        println!("skipped: the University of Michigan module is not at hand (FREEACT_MEASURED)");
        return;
    };
    let rig = Rig::read(&folder.join("rig.toml")).expect("the rig");
    let Description::Module(module) = rig.description else { panic!("not a module") };
    let (found, lost) = plateaus(&folder.join("grid.csv"));
    println!("{} plateaus, {lost} lost; range {:?}", found.len(), ranges(&found));
    assert!(found.len() >= 720 && lost <= 10);
    let alone = |free: usize| -> Vec<Plateau> {
        let own = |plateau: &&Plateau| (0..3).all(|k| (k == free) == (plateau.command_kpa[k] > 0.0));
        found.iter().filter(own).cloned().collect()
    };
    for (free, hand) in [Handedness::Right, Handedness::Left, Handedness::Right].into_iter().enumerate() {
        let line = alone(free);
        let turned = line[line.len() - 1].rz_rad - line[0].rz_rad;
        assert_eq!(module.frees[free].free.winding.handedness, hand);
        // A right-handed FREE turns the plate clockwise.
        assert!(turned * hand.sign() < -0.05, "FREE {}: {turned}", free + 1);
    }
    let line = alone(0);
    let pressures: Vec<[f64; 3]> = line.iter().map(|plateau| plateau.command_kpa).collect();
    let predictor = Predictor::new(&module);
    let errors = |modulus: f64| {
        let variation = Variation { modulus, ..Variation::default() };
        let motions = predictor.predict(&variation, &pressures).expect("rods");
        let errors = Errors::of(motions.iter().zip(&line));
        println!("FREE 1 alone, modulus x {modulus}: {errors:?}");
        assert_eq!(errors.missing, 0);
        errors
    };
    let (soft, stiff) = (errors(1.0), errors(5.0));
    for k in 0..2 {
        assert!(soft.mean[k] < 0.0, "the drawing moves farther than the module: {soft:?}");
        assert!(stiff.mean[k] > soft.mean[k], "{soft:?} {stiff:?}");
    }
}
