//! Other tables in CSV: waypoints, pressures for `predict`, tests of materials. Any bytes give rows or an error.
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
#[path = "../../cli/src/pressures_csv.rs"]
#[allow(dead_code)]
mod pressures_csv;

use pressures_csv::{Columns, Wanted};
use std::{fs, path::Path};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("x.csv");
    if let Ok(waypoints) = control::waypoints_from(path, bytes) {
        assert!(!waypoints.is_empty());
    }
    let wanted = [
        Wanted { names: &["t_s"], optional: true },
        Wanted { names: &["p1_kpa", "p1_command_kpa"], optional: false },
        Wanted { names: &["p2_kpa"], optional: false },
    ];
    if let Ok(columns) = Columns::parse(path, bytes, &wanted, 2) {
        assert!(columns.rows.iter().all(|row| row.len() == columns.names.len()));
    }
    let file = std::env::temp_dir().join(format!("freeact-fuzz-{}.csv", std::process::id()));
    if fs::write(&file, bytes).is_ok() {
        if let Ok(points) = material_csv::read_tests(&file) {
            assert!(points.iter().all(|point| point.stretch > 0.0 && point.stress.is_finite()));
        }
        if let Ok(pull) = material_csv::read_pull(&file, Some(100.0)) {
            assert!(pull.iter().all(|(strain, force)| strain.is_finite() && force.is_finite()));
        }
    }
});
