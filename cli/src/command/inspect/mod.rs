mod description;
mod map;

use crate::{
    failure::{Failure, Outcome},
    map_file::MapFile,
    output,
};
use actuator::{Rig, artefact};
use std::path::{Path, PathBuf};

/// Tell what is in a map, model, recording or description
///
/// The kind is found out from the content, not from the name. Without a flag a table is printed.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact inspect paper.map
  freeact inspect paper.map --csv --out paper.csv
  freeact inspect data/modules/buffinton-2020-30lr.toml --json")]
pub struct Inspect {
    /// The file
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Print the content as CSV: one row a state or sample
    #[arg(long)]
    csv: bool,

    /// Write the table or CSV to a file instead of printing it
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Write charts, as SVG and PNG, into a directory
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
}

/// What a kind of file has to show.
trait Content {
    /// The table for people.
    fn text(&self, path: &Path) -> String;
    /// The same for programs.
    fn json(&self) -> serde_json::Value;
    /// One row a state or sample, where that makes sense.
    fn csv(&self) -> Option<String>;
    /// Charts, with the stems of their files.
    fn charts(&self) -> Vec<(String, crate::plot::Chart)>;
}

impl Inspect {
    pub fn run(self, json: bool) -> Outcome {
        let content = open(&self.file)?;
        if let Some(directory) = &self.plot {
            let charts = content.charts();
            if charts.is_empty() {
                return Err(Failure::usage(format!(
                    "{}: --plot has nothing to draw here",
                    self.file.display()
                )));
            }
            output::make_directory(directory)?;
            for (stem, chart) in &charts {
                chart.write(directory, stem)?;
            }
        }
        let text = if self.csv {
            content.csv().ok_or_else(|| {
                Failure::usage(format!(
                    "{}: --csv applies to maps and recordings only; leave it out for a table",
                    self.file.display()
                ))
            })?
        } else if json {
            format!("{:#}\n", content.json())
        } else {
            content.text(&self.file)
        };
        output::write(&text, self.out.as_deref())?;
        Ok(crate::exit::Exit::Done)
    }
}

/// Opens a file by what is in it.
fn open(path: &Path) -> Result<Box<dyn Content>, Failure> {
    let bytes = std::fs::read(path).map_err(Failure::at(path))?;
    if bytes.starts_with(&artefact::MAP.magic) {
        return Ok(match MapFile::read(path)? {
            MapFile::Free(map) => Box::new(map),
            MapFile::Module(map) => Box::new(map),
        });
    }
    match String::from_utf8(bytes) {
        Ok(text) if !looks_like_csv(&text) => Ok(Box::new(Rig::parse(path, text)?)),
        _ => Err(Failure::file(format!(
            "{}: neither a map nor a description (TOML); those are what `inspect` can show",
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
