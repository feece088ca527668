//! Recordings of FREE actuators: MCAP (ROS 2 profile) and CSV, reading, checking, resampling.
//!
//! A [`Recording`] is what came out of one run of a rig. It is read from CSV by [`read_csv`] and from MCAP by [`read_mcap`], as
//! the rig's table `[recordings]` says ([`Layout`]). What is irregular about it is listed in [`Findings`] and never mended
//! silently. [`write_mcap`] writes one whole; a [`LogWriter`] grows a log while a rig runs.

mod csv_file;
mod error;
mod examine;
mod findings;
mod import;
mod layout;
mod log_reader;
mod log_recording;
mod log_writer;
mod message;
mod quantity;
mod raw_log;
mod recording;
mod resample;
mod solve_record;
mod storage;

pub use csv_file::{parse_csv, read_csv, write_csv};
pub use error::RecordError;
pub use examine::examine;
pub use findings::{Finding, FindingKind, Findings};
pub use import::{import, read_recording, read_recordings};
pub use layout::{Layout, PoseOrigin, PressureReference};
pub use log_reader::{Log, TimedPose, read_mcap};
pub use log_recording::write_mcap;
pub use log_writer::{FreeSample, LogHeader, LogWriter, Shape, Strand, TipTopic};
pub use quantity::Quantity;
pub use recording::{Channel, Motion, Recording};
pub use resample::resample;
pub use solve_record::SolveRecord;
pub use storage::{Rounding, Storage};

/// A module of `frees` FREEs, 175 mm long, with the given table `[recordings]`.
#[cfg(test)]
pub(crate) fn rig_for_tests(frees: usize, recordings: &str) -> actuator::Rig {
    let mut text =
        "kind = \"module\"\n[defaults]\nlength_mm = 175.0\ninner_diameter_mm = 9.52\nwall_mm = 0.8\n\
                    winding_angle_deg = 30.0\nfibres = 6\nfibre_ea_newton = 644.0\n[defaults.elastomer]\n\
                    model = \"neo-hookean\"\nshear_modulus_mpa = 0.4\n[limits]\npressure_max_kpa = 50.0\n"
            .to_owned();
    for free in 0..frees {
        text += &format!("[[free]]\nposition_mm = [{}.0, 0.0]\n", 20 * free);
    }
    actuator::Rig::parse(std::path::Path::new("rig.toml"), text + recordings).unwrap()
}

/// A single FREE, 86.4 mm long.
#[cfg(test)]
pub(crate) fn free_for_tests(recordings: &str) -> actuator::Rig {
    let text = "kind = \"free\"\nlength_mm = 86.4\ninner_diameter_mm = 9.52\nwall_mm = 0.8\nwinding_angle_deg = 40.0\n\
                fibres = 6\nfibre_ea_newton = 644.0\n[elastomer]\nmodel = \"neo-hookean\"\nshear_modulus_mpa = 0.4\n\
                [limits]\npressure_max_kpa = 100.0\n";
    actuator::Rig::parse(std::path::Path::new("free.toml"), text.to_owned() + recordings).unwrap()
}
