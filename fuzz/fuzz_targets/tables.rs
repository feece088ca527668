//! Other tables in CSV: waypoints, pressures for `predict`. Any bytes give rows or an error.
#![no_main]

#[path = "../../cli/src/exit.rs"]
#[allow(dead_code)]
mod exit;
#[path = "../../cli/src/failure.rs"]
#[allow(dead_code)]
mod failure;
#[path = "../../cli/src/pressures_csv.rs"]
#[allow(dead_code)]
mod pressures_csv;

use pressures_csv::{Columns, Wanted};
use std::path::Path;

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
});
