//! Descriptions of actuators: any text gives a description or an error.
#![no_main]

use actuator::Rig;
use std::path::Path;

libfuzzer_sys::fuzz_target!(|text: String| {
    match Rig::parse(Path::new("x.toml"), text) {
        Ok(rig) => assert!(!rig.frees().is_empty()),
        Err(error) => assert!(error.to_string().contains("x.toml")),
    }
});
