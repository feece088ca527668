//! Recordings of a rig as files of any kind that freeact reads.

use crate::failure::Failure;
use actuator::Rig;
use record::{Findings, Recording};
use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

/// A recording and what is irregular about it.
pub struct Loaded {
    pub recording: Recording,
    pub findings: Findings,
}

/// Whether a file is an MCAP log: by its first bytes, or by its name where it is too damaged to begin as one.
pub fn is_mcap(path: &Path) -> Result<bool, Failure> {
    let mut first = Vec::new();
    File::open(path).and_then(|file| file.take(5).read_to_end(&mut first)).map_err(Failure::at(path))?;
    Ok(first == b"\x89MCAP" || path.extension().is_some_and(|extension| extension == "mcap"))
}

/// The rig of a recording that carries none: the one given, or `rig.toml` beside the recording.
pub fn rig_for(recording: &Path, given: Option<&Path>) -> Result<Rig, Failure> {
    let beside: PathBuf = recording.with_file_name("rig.toml");
    match given {
        Some(path) => Ok(Rig::read(path)?),
        None if beside.exists() => Ok(Rig::read(&beside)?),
        None => Err(Failure::usage(format!(
            "{}: a CSV recording does not say what it is a recording of; give --rig RIG.toml",
            recording.display()
        ))),
    }
}

/// Reads a recording of a rig from CSV or MCAP.
pub fn read(path: &Path, rig: &Rig) -> Result<Loaded, Failure> {
    if is_mcap(path)? {
        let log = record::read_mcap(path, Some(rig)).map_err(Failure::file)?;
        return Ok(Loaded { recording: log.recording, findings: log.findings });
    }
    let (recording, findings) = record::read_csv(path, rig).map_err(Failure::file)?;
    Ok(Loaded { recording, findings })
}
