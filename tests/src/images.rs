//! Images of models with effects, for what reads them from outside.

use crate::project;
use rom::{
    Model,
    effect::{Effect, EffectKind},
};
use std::path::Path;

/// Effects that a module may have, one of each link and with each kind of memory.
const OF_MODULE: &[(EffectKind, &[f64])] = &[
    (EffectKind::Stiffness, &[0.1]),
    (EffectKind::Payload, &[0.02]),
    (EffectKind::BendingScale, &[0.15]),
    (EffectKind::SupplyLag, &[0.05, 0.08]),
    (EffectKind::PressureBias, &[300.0]),
    (EffectKind::Hysteresis, &[1e3, 0.8]),
    (EffectKind::Creep, &[0.1, 30.0]),
    (EffectKind::Mullins, &[0.1]),
    (EffectKind::Delay, &[0.03]),
    (EffectKind::MarkerFrame, &[0.1, 0.0, 0.2, 0.001, 0.002, 0.003]),
    (EffectKind::BaseFrame, &[0.0, 0.3, 0.1, 0.004, 0.0, -0.002]),
];

/// Effects of a single FREE.
const OF_FREE: &[(EffectKind, &[f64])] = &[
    (EffectKind::WindingAngle, &[0.02]),
    (EffectKind::Creep, &[0.1, 30.0]),
    (EffectKind::Mismatch, &[0.05]),
];

fn with_effects(name: &str, effects: &[(EffectKind, &[f64])]) -> Model {
    let mut model = Model::read(&project().join("tests/data").join(name)).expect("a model");
    let frees: Vec<usize> = (0..model.frees()).collect();
    let effect = |(kind, values): &(EffectKind, &[f64])| Effect {
        kind: *kind,
        frees: frees.clone(),
        values: values.to_vec(),
    };
    model.effects.effects = effects.iter().map(effect).collect();
    model.effects.check(frees.len()).expect("effects that can be");
    model
}

/// A small model of a module of four FREEs, up to 50 kPa, with effects.
pub fn module() -> Model {
    with_effects("version-1-module.model", OF_MODULE)
}

/// A small model of a single FREE, with effects.
pub fn free() -> Model {
    with_effects("version-1-free.model", OF_FREE)
}

/// Bytes where numbers may lie.
pub fn aligned(bytes: &[u8]) -> Vec<u64> {
    let mut words = vec![0u64; bytes.len().div_ceil(8)];
    bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
    words
}

/// The bytes of words.
pub fn bytes(words: &[u64]) -> &[u8] {
    bytemuck::cast_slice(words)
}

/// Writes the images of both in both precisions: `module_f64.img`, `module_f32.img`, `free_f64.img`, `free_f32.img`.
pub fn write(folder: &Path) {
    for (name, model) in [("module", module()), ("free", free())] {
        let images = [("f64", model.image::<f64>()), ("f32", model.image::<f32>())];
        for (precision, image) in images {
            let path = folder.join(format!("{name}_{precision}.img"));
            std::fs::write(path, image.expect("an image")).expect("written");
        }
    }
}

/// The C compiler, `CC` or `cc`, where there is one.
pub fn c_compiler() -> Option<std::ffi::OsString> {
    let compiler = std::env::var_os("CC").unwrap_or_else(|| "cc".into());
    let found = std::process::Command::new(&compiler).arg("--version").output();
    found.is_ok_and(|output| output.status.success()).then_some(compiler)
}
