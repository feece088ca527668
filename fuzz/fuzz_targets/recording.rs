//! Recordings in CSV, with a description of their columns before the first line of `===`: any bytes give a recording or an error.
#![no_main]

use actuator::Rig;
use std::path::Path;

const RIG: &str = include_str!("../../data/modules/buffinton-2020-30lr.toml");

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let cut = bytes.windows(5).position(|window| window == b"\n===\n");
    let (columns, csv) = cut.map_or((&bytes[..0], bytes), |at| (&bytes[..at], &bytes[at + 5..]));
    let Ok(columns) = std::str::from_utf8(columns) else { return };
    let Ok(rig) = Rig::parse(Path::new("rig.toml"), format!("{RIG}\n{columns}")) else { return };
    match record::parse_csv(Path::new("x.csv"), csv, &rig) {
        Ok((recording, findings)) => {
            let _ = findings.to_string();
            assert!(recording.time.windows(2).all(|pair| pair[0] <= pair[1]));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
