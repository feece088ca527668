//! What there is to show of a file: a table, JSON, CSV, charts.

mod description;
mod free_charts;
mod free_map;
mod free_table;
mod map;
mod model;
mod module_map;
mod recording;

pub use model::link;

use crate::{columns::Columns, failure::Failure, map_file::MapFile, plot::Picture, recordings};
use actuator::{Rig, artefact};
use std::path::Path;

/// What a kind of file has to show.
pub trait Content {
    /// The table for people.
    fn text(&self, path: &Path) -> String;
    /// The same for programs.
    fn json(&self) -> serde_json::Value;
    /// One row a state or sample, where that makes sense.
    fn columns(&self) -> Option<Columns>;
    /// Charts, with the stems of their files.
    fn charts(&self) -> Vec<(String, Picture)>;
    /// The map, if it is one.
    fn map(&self) -> Option<&MapFile> {
        None
    }
}

/// Opens a file by what is in it.
pub fn open(path: &Path, rig: Option<&Path>) -> Result<Box<dyn Content>, Failure> {
    let bytes = std::fs::read(path).map_err(Failure::at(path))?;
    if bytes.starts_with(&artefact::MAP.magic) {
        return Ok(Box::new(MapFile::read(path)?));
    }
    if bytes.starts_with(&artefact::MODEL.magic) {
        return Ok(Box::new(rom::Model::from_bytes(path, &bytes)?));
    }
    if recordings::is_mcap(path)? {
        let given = rig.map(Rig::read).transpose()?;
        let log = record::read_mcap(path, given.as_ref()).map_err(Failure::file)?;
        return Ok(Box::new(recording::Inspected::from(log)));
    }
    match String::from_utf8(bytes) {
        Ok(text) if looks_like_csv(&text) => {
            let recordings::Loaded { recording, findings } =
                recordings::read(path, &recordings::rig_for(path, rig)?)?;
            Ok(Box::new(recording::Inspected { recording, findings, besides: Vec::new() }))
        }
        Ok(text) => Ok(Box::new(Rig::parse(path, text)?)),
        Err(_) => Err(Failure::file(format!(
            "{}: neither a map, a model, a recording (CSV, MCAP) nor a description (TOML); those are what `inspect` can show",
            path.display()
        ))),
    }
}

/// Whether the first line that says something is a row of names between commas.
fn looks_like_csv(text: &str) -> bool {
    let first =
        text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    first.contains(',') && !first.contains('=')
}
