//! Tests of rubbers and threads in CSV: any bytes give points or an error.
#![no_main]

#[path = "../../cli/src/exit.rs"]
#[allow(dead_code)]
mod exit;
#[path = "../../cli/src/failure.rs"]
#[allow(dead_code)]
mod failure;
#[path = "../../cli/src/material_csv.rs"]
#[allow(dead_code)]
mod material_csv;

use std::fs;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let file = std::env::temp_dir().join(format!("freeact-fuzz-{}.csv", std::process::id()));
    if fs::write(&file, bytes).is_err() {
        return;
    }
    if let Ok(points) = material_csv::read_tests(&file) {
        assert!(points.iter().all(|point| point.stretch > 0.0 && point.stress.is_finite()));
    }
    if let Ok(pull) = material_csv::read_pull(&file, Some(100.0)) {
        assert!(pull.iter().all(|(strain, force)| strain.is_finite() && force.is_finite()));
    }
});
