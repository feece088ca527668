//! The commands, one file each.

mod inspect;
mod merge;

use crate::failure::Outcome;

/// What freeact can do.
#[derive(clap::Subcommand)]
pub enum Command {
    Merge(merge::Merge),
    Inspect(inspect::Inspect),
}

impl Command {
    /// Runs the command; `json` asks for results as JSON.
    pub fn run(self, json: bool) -> Outcome {
        match self {
            Command::Merge(merge) => merge.run(json),
            Command::Inspect(inspect) => inspect.run(json),
        }
    }
}
