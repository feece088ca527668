use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    output, recordings,
    table::{Table, duration},
};
use actuator::Rig;
use record::{LogHeader, Storage};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Turn recordings of other programs into freeact logs
///
/// Reads CSV files and any ROS 2 bag in MCAP. Names of columns and topics, and units, are mapped in [recordings] of the rig
/// file. What is irregular (gaps, outliers, slips of units) is told and not mended. Several files become RUN.1.mcap,
/// RUN.2.mcap, ...
#[derive(clap::Args)]
#[command(after_help = "Example:\n  freeact import 1-staircase.csv --rig rig.toml --out 1-staircase.mcap")]
pub struct Import {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// The rig they were made on
    #[arg(long, value_name = "RIG.toml")]
    rig: PathBuf,

    /// The log
    #[arg(long, value_name = "RUN.mcap")]
    out: PathBuf,

    /// Pack the log small for keeping: rounded to steps far below sensors' resolution, without an index for viewers
    #[arg(long)]
    archive: bool,
}

impl Import {
    pub fn run(self, json: bool) -> Outcome {
        let rig = Rig::read(&self.rig)?;
        let storage = if self.archive { Storage::archive() } else { Storage::default() };
        let mut table = Table::new(["<recording", "samples", "time", "<log"]);
        let mut told = Vec::new();
        let mut notes = String::new();
        for (i, file) in self.files.iter().enumerate() {
            let read = recordings::read(file, &rig)?;
            let out = if self.files.len() == 1 { self.out.clone() } else { numbered(&self.out, i + 1) };
            let header = LogHeader::of(read.recording.name.clone(), &rig).map_err(Failure::file)?;
            record::write_mcap(&out, &read.recording, &header, &storage).map_err(Failure::file)?;
            let time = &read.recording.time;
            let seconds = time.last().copied().unwrap_or(0.0) - time.first().copied().unwrap_or(0.0);
            table.row([
                file.display().to_string(),
                time.len().to_string(),
                duration(seconds),
                out.display().to_string(),
            ]);
            for line in read.findings.to_string().lines() {
                notes += &format!("  {}: {line}\n", read.recording.name);
            }
            told.push(json!({
                "recording": file, "out": out, "samples": time.len(), "seconds": seconds,
                "findings": read.findings.list.iter().map(|f| json!({ "channel": f.channel, "message": f.message })).collect::<Vec<_>>(),
            }));
        }
        match json {
            true => output::print_json(&json!(told)),
            false => output::print(&(table.text() + if notes.is_empty() { "" } else { "\n" } + &notes)),
        }
        Ok(Exit::Done)
    }
}

/// `RUN.mcap` as `RUN.2.mcap`.
fn numbered(path: &Path, number: usize) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let extension = path.extension().map(|extension| extension.to_string_lossy().into_owned());
    path.with_file_name(format!("{stem}.{number}.{}", extension.unwrap_or_else(|| "mcap".into())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_logs_are_numbered() {
        assert_eq!(numbered(Path::new("a/run.mcap"), 2), Path::new("a/run.2.mcap"));
        assert_eq!(numbered(Path::new("run"), 1), Path::new("run.1.mcap"));
    }
}
