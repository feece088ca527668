//! Map files: any bytes, under a right checksum too, give a map that can be fitted or an error.
#![no_main]

#[path = "../../cli/src/exit.rs"]
#[allow(dead_code)]
mod exit;
#[path = "../../cli/src/failure.rs"]
#[allow(dead_code)]
mod failure;
#[path = "../../cli/src/map_file.rs"]
#[allow(dead_code)]
mod map_file;

use actuator::artefact;
use map_file::MapFile;
use serde::{Serialize, Serializer, ser::SerializeTuple};
use std::fs;

/// A body that becomes a file as it stands.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = std::env::temp_dir().join(format!("freeact-fuzz-{}.map", std::process::id()));
    let body = if bytes.starts_with(&artefact::MAP.magic) { bytes.get(44..) } else { Some(bytes) };
    let Some(body) = body else { return };
    let kinds = [artefact::MAP, artefact::MAP_VERSION_1, artefact::MAP_VERSION_2, artefact::MAP_VERSION_3];
    for kind in kinds {
        let sealed = artefact::to_bytes(kind, &Raw(body)).expect("bytes are written as they stand");
        if fs::write(&path, sealed).is_err() {
            return;
        }
        let Ok(map) = MapFile::read(&path) else { continue };
        let _ = (map.computed(), map.worst_residual());
        match map {
            MapFile::Free(map) => drop(rom::FreeModel::fit(&map)),
            MapFile::Module(map) => drop(rom::ModuleModel::fit(&map)),
        }
    }
});
