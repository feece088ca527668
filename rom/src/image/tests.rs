use super::*;
use crate::{
    PoseModel, Provenance,
    effect::{Effect, EffectKind},
    synthetic::{PRESSURE_MAX, free_map, module_map},
};
use actuator::MapParameter;
use evaluator::{Content, Image, ImageError};

fn even(count: usize) -> Vec<f64> {
    (0..count).map(|i| PRESSURE_MAX * i as f64 / (count - 1) as f64).collect()
}

fn module(effects: &[(EffectKind, &[f64])]) -> Model {
    let map = module_map(vec![even(6), even(5)], 40);
    let provenance = Provenance::new(&map, &map.source, &map.settings).unwrap();
    let mut model = Model::new(ModelContent::Module(ModuleModel::fit(&map).unwrap()), provenance);
    model.effects.effects = effects
        .iter()
        .map(|(kind, values)| Effect { kind: *kind, frees: vec![0, 1], values: values.to_vec() })
        .collect();
    model
}

/// The image where its numbers may lie.
fn aligned(bytes: &[u8]) -> Vec<u64> {
    let mut words = vec![0u64; bytes.len().div_ceil(8)];
    bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
    words
}

/// What acts on a module beyond its splines, one of each kind that does not need time.
const EFFECTS: &[(EffectKind, &[f64])] = &[
    (EffectKind::Stiffness, &[0.1]),
    (EffectKind::Payload, &[0.02]),
    (EffectKind::BendingStiffness, &[-0.1]),
    (EffectKind::BendingScale, &[0.15]),
    (EffectKind::Hysteresis, &[1e3, 0.8]),
    (EffectKind::MarkerFrame, &[0.1, 0.0, 0.2, 0.001, 0.002, 0.003]),
    (EffectKind::BaseFrame, &[0.0, 0.3, 0.1, 0.004, 0.0, -0.002]),
];

#[test]
fn an_image_answers_as_the_model_with_its_effects() {
    let model = module(EFFECTS);
    let bytes = model.image::<f64>().unwrap();
    let words = aligned(&bytes);
    let image = Image::<f64>::read(&bytemuck::cast_slice(&words)[..bytes.len()]).unwrap();
    let Content::Module(tip) = &image.content else { panic!("it is of a module") };
    let chain = image.effects.chain();
    let mut memory = vec![0.0; chain.memory()];
    let splines = model.as_module().unwrap();
    let mut state = model.effects.at_rest(2);
    let mut into = splines.workspace();
    for pressures in [[10e3, 30e3], [50e3, 8e3], [20e3, 22e3]] {
        let held = memory.clone();
        let found = tip.evaluate(&chain, &mut memory, 0.01, &pressures).unwrap();
        // The same by the lists that own their numbers.
        let mut answered = pressures;
        model.effects.deform(&mut state, 0.01, &mut answered);
        assert_eq!(found.answered[..2], answered);
        splines.evaluate(&answered, &mut into).unwrap();
        let loads = model.effects.loads(hanging_mass(splines.module()));
        let factors = splines.parameters().iter().map(|parameter| match parameter {
            MapParameter::Payload => loads.mass,
            MapParameter::PayloadCurvature => actuator::payload_curvature(loads.mass),
            MapParameter::BendingStiffness => loads.bending_stiffness,
        });
        let mut chart = into.chart.to_array();
        for (factor, slope) in factors.zip(&into.slopes) {
            for (value, slope) in chart.iter_mut().zip(slope) {
                *value += factor * slope;
            }
        }
        let chart = model.effects.bend(&actuator::PoseChart::from_array(chart));
        let pose = model.effects.read_pose(&chart.to_pose());
        for (a, b) in found.pose.position.iter().zip(pose.position.iter()) {
            assert!((a - b).abs() < 1e-14, "{found:?} for {pose:?}");
        }
        for (a, b) in found.pose.rotation.iter().zip(pose.wxyz()) {
            assert!((a - b).abs() < 1e-13, "{found:?} for {pose:?}");
        }
        // Derivatives against differences, from the memory before the step.
        for free in 0..2 {
            let at = |by: f64| {
                let mut moved = pressures;
                moved[free] += by;
                tip.evaluate(&chain, &mut held.clone(), 0.01, &moved).unwrap().pose
            };
            let (ahead, behind) = (at(1.0), at(-1.0));
            for axis in 0..3 {
                let rate = (ahead.position[axis] - behind.position[axis]) / 2.0;
                assert!((rate - found.jacobian[free][axis]).abs() < 1e-11, "{rate}");
            }
            let turn = |pose: &evaluator::Pose<f64>| {
                let [w, x, y, z] = pose.rotation;
                nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z))
            };
            let turned = (turn(&behind).inverse() * turn(&ahead)).scaled_axis() / 2.0;
            for axis in 0..3 {
                assert!((turned[axis] - found.jacobian[free][3 + axis]).abs() < 1e-10, "{turned}");
            }
        }
    }
}

#[test]
fn single_precision_answers_to_its_own_digits() {
    let model = module(EFFECTS);
    let (bytes, short) = (model.image::<f64>().unwrap(), model.image::<f32>().unwrap());
    assert!(short.len() < bytes.len() * 11 / 20);
    let (words, short_words) = (aligned(&bytes), aligned(&short));
    let double = Image::<f64>::read(&bytemuck::cast_slice(&words)[..bytes.len()]).unwrap();
    let single = Image::<f32>::read(&bytemuck::cast_slice(&short_words)[..short.len()]).unwrap();
    let (Content::Module(a), Content::Module(b)) = (&double.content, &single.content) else {
        panic!("both are of a module")
    };
    let (chain, short_chain) = (double.effects.chain(), single.effects.chain());
    let mut memory = vec![0.0; chain.memory()];
    let mut short_memory = vec![0.0; chain.memory()];
    let one = a.evaluate(&chain, &mut memory, 0.01, &[33e3, 12e3]).unwrap();
    let other = b.evaluate(&short_chain, &mut short_memory, 0.01, &[33e3, 12e3]).unwrap();
    for (a, b) in one
        .pose
        .position
        .iter()
        .chain(&one.pose.rotation)
        .zip(other.pose.position.iter().chain(&other.pose.rotation))
    {
        // 24 bits, on numbers below one.
        assert!((a - f64::from(*b)).abs() < 1e-6);
    }
    let size = |row: &[f64; 6]| row.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    for (row, short) in one.jacobian.iter().zip(&other.jacobian) {
        for (a, b) in row.iter().zip(short) {
            assert!((a - f64::from(*b)).abs() <= 1e-4 * size(row));
        }
    }
}

#[test]
fn a_free_s_image_answers_as_its_model() {
    let map = free_map(vec![0.4, 0.8, 1.2], vec![0.2e6, 0.4e6], 12, None);
    let provenance = Provenance::new(&map, &map.source, &map.settings).unwrap();
    let model = Model::new(ModelContent::Free(crate::FreeModel::fit(&map).unwrap()), provenance);
    let bytes = model.image::<f64>().unwrap();
    let words = aligned(&bytes);
    let image = Image::<f64>::read(&bytemuck::cast_slice(&words)[..bytes.len()]).unwrap();
    let Content::Free { splines, winding_angle, .. } = &image.content else { panic!("it is of a FREE") };
    assert_eq!(*winding_angle, map.node.free.winding.angle_from_hoop());
    let free = model.as_free().unwrap();
    assert_eq!(splines.evaluate(9e3, 0.7, 0.3e6, 0.0), free.evaluate(9e3, 0.7, 0.3e6));
    assert!(model.image::<f32>().is_ok());
}

#[test]
fn a_free_s_image_answers_with_its_effects() {
    let map = free_map(vec![0.4, 0.8, 1.2], vec![0.2e6, 0.4e6], 12, None);
    let provenance = Provenance::new(&map, &map.source, &map.settings).unwrap();
    let mut model = Model::new(ModelContent::Free(crate::FreeModel::fit(&map).unwrap()), provenance);
    let effects: [(EffectKind, &[f64]); 3] = [
        (EffectKind::WindingAngle, &[0.02]),
        (EffectKind::Creep, &[0.1, 30.0]),
        (EffectKind::Mismatch, &[0.05]),
    ];
    model.effects.effects =
        effects.map(|(kind, values)| Effect { kind, frees: vec![0], values: values.to_vec() }).to_vec();
    let words = aligned(&model.image::<f64>().unwrap());
    let image = Image::<f64>::read(bytemuck::cast_slice(&words)).unwrap();
    let Content::Free { splines, .. } = &image.content else { panic!("it is of a FREE") };
    let chain = image.effects.chain();
    let mut memory = vec![0.0; chain.memory()];
    let mut state = model.effects.at_rest(1);
    for pressure in [4e3, 9e3, 6e3] {
        let held = memory.clone();
        let found = splines.evaluate_after(&chain, &mut memory, 2.0, pressure, 0.7, 0.3e6).unwrap();
        let mut answered = [pressure];
        model.effects.deform(&mut state, 2.0, &mut answered);
        let mut expected = model.as_free().unwrap().evaluate(answered[0], 0.7 + 0.02, 0.3e6).unwrap();
        let base = expected.jacobian[0];
        expected.jacobian[0] = found.jacobian[0];
        assert_eq!(found, expected);
        assert_ne!(found.jacobian[0], base);
        let at = |by: f64| {
            splines.evaluate_after(&chain, &mut held.clone(), 2.0, pressure + by, 0.7, 0.3e6).unwrap()
        };
        let (ahead, behind) = (at(1.0), at(-1.0));
        let rate = |of: fn(&evaluator::FreeEvaluation<f64>) -> f64| (of(&ahead) - of(&behind)) / 2.0;
        let rates = [rate(|at| at.axial_stretch), rate(|at| at.expansion), rate(|at| at.twist_per_length)];
        for (rate, slope) in rates.iter().zip(found.jacobian[0]) {
            assert!((rate - slope).abs() <= 1e-6 * slope.abs(), "{rate} {slope}");
        }
    }
}

#[test]
fn bytes_that_are_no_image_are_told_in_words() {
    let bytes = module(EFFECTS).image::<f64>().unwrap();
    let read = |bytes: &[u8]| {
        let words = aligned(bytes);
        let error = Image::<f64>::read(&bytemuck::cast_slice(&words)[..bytes.len()]).map(|_| ()).unwrap_err();
        (error, error.to_string())
    };
    let changed = |place: usize, value: u8| {
        let mut other = bytes.clone();
        other[place] = value;
        read(&other)
    };
    assert_eq!(read(b"FREEmap").0, ImageError::NoImage);
    assert!(changed(0, b'X').1.contains("not a freeact image"));
    assert!(changed(8, 9).1.contains("version 9 is not known here"));
    assert!(changed(12, 4).1.contains("numbers of 4 bytes"));
    assert!(changed(bytes.len() - 3, 0x55).1.contains("checksum"));
    assert_eq!(changed(20, 0).0, ImageError::Length);
    assert_eq!(read(&bytes[..bytes.len() - 8]).0, ImageError::Length);
    let words = aligned(&[&[0; 4], &bytes[..]].concat());
    let shifted = &bytemuck::cast_slice::<u64, u8>(&words)[4..4 + bytes.len()];
    assert_eq!(Image::<f64>::read(shifted), Err(ImageError::Address));
    // Damage under a right checksum.
    let resealed = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut other = bytes.clone();
        change(&mut other);
        let checksum = crc32fast::hash(&other[HEADER..]).to_le_bytes();
        other[16..20].copy_from_slice(&checksum);
        read(&other).0
    };
    assert_eq!(
        resealed(&|bytes| bytes[HEADER] = 7),
        ImageError::Content("it is neither of a FREE nor of a module")
    );
    assert!(matches!(resealed(&|bytes| bytes[HEADER + 4] = 9), ImageError::Content(_)));
    assert!(matches!(resealed(&|bytes| bytes[HEADER + 8] = 200), ImageError::Content(_)));
    let mut seed = 0x2545_f491_4f6c_dd1du64;
    for _ in 0..4000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let (place, value) = ((seed >> 33) as usize % (bytes.len() - HEADER), (seed >> 20) as u8);
        let mut other = bytes.clone();
        other[HEADER + place] = value;
        let checksum = crc32fast::hash(&other[HEADER..]).to_le_bytes();
        other[16..20].copy_from_slice(&checksum);
        let words = aligned(&other);
        let Ok(image) = Image::<f64>::read(&bytemuck::cast_slice(&words)[..other.len()]) else { continue };
        let Content::Module(tip) = &image.content else { continue };
        let chain = image.effects.chain();
        let mut memory = vec![0.0; chain.memory()];
        for pressures in [[10e3, 30e3], [-1.0, f64::NAN], [68e3, 1e3]] {
            if tip.splines.domain().len() == 2 {
                let _ = tip.evaluate(&chain, &mut memory, 0.01, &pressures);
            }
        }
    }
}
