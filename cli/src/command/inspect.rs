use crate::{
    content,
    failure::{Failure, Outcome},
    output,
};
use std::path::PathBuf;

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

    /// The rig of a CSV recording (default: rig.toml beside it)
    #[arg(long, value_name = "RIG.toml")]
    rig: Option<PathBuf>,

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

impl Inspect {
    pub fn run(self, json: bool) -> Outcome {
        let content = content::open(&self.file, self.rig.as_deref())?;
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
