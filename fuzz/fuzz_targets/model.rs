//! Model files: any bytes, under a right checksum too, give a model that evaluates without a panic, or an error.
#![no_main]

use actuator::artefact::{self, Kind};
use rom::{Model, ModelContent, PoseModel};
use serde::{Serialize, Serializer, ser::SerializeTuple};
use std::path::Path;

/// A body that becomes a file as it stands.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

fn check(bytes: &[u8]) {
    let Ok(model) = Model::from_bytes(Path::new("x.model"), bytes) else { return };
    match &model.content {
        ModelContent::Module(module) => {
            let mut into = module.workspace();
            for place in [-0.1, 0.0, 0.37, 1.0, f64::NAN] {
                let at: Vec<f64> = module.domain().iter().map(|(a, b)| a + place * (b - a)).collect();
                let _ = module.evaluate(&at, &mut into);
                let _ = module.evaluate_near(&at, 1e3, &mut into);
                let _ = (module.clearance(&at), module.splines().error_bars(&at));
            }
        }
        ModelContent::Free(free) => {
            let (angle, modulus) = (free.winding_angles()[0], free.shear_moduli()[0]);
            for pressure in [-1.0, 0.0, 2e4, f64::INFINITY] {
                let _ = free.evaluate_near(pressure, angle, modulus, 1e3);
                let _ = free.limit_pressure(angle, modulus);
            }
        }
    }
    let again = model.to_bytes().expect("what was read can be written");
    assert!(Model::from_bytes(Path::new("x.model"), &again).is_ok());
    let _ = (model.image::<f64>(), model.image::<f32>());
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    check(bytes);
    // Whole files in the corpus: their body under a right checksum, in both formats.
    let body = if bytes.starts_with(&artefact::MODEL.magic) { bytes.get(44..) } else { Some(bytes) };
    let Some(body) = body else { return };
    for kind in [artefact::MODEL, artefact::MODEL_VERSION_1] {
        let kind: Kind = kind;
        check(&artefact::to_bytes(kind, &Raw(body)).expect("bytes are written as they stand"));
    }
});
