//! The commands, one file each.

mod blocked;
mod demo;
mod export;
pub mod fit;
mod identify;
mod import;
mod inspect;
mod map;
mod material;
mod merge;
mod predict;
mod replay;
mod reproduce;
mod solve;
mod track;
mod workspace;

use crate::failure::Outcome;

/// What freeact can do.
#[derive(clap::Subcommand)]
pub enum Command {
    Demo(demo::Demo),
    Map(map::Map),
    Merge(merge::Merge),
    Inspect(inspect::Inspect),
    Blocked(blocked::Blocked),
    Fit(fit::Fit),
    Export(export::Export),
    Predict(predict::Predict),
    Solve(solve::Solve),
    Track(track::Track),
    Replay(replay::Replay),
    Import(import::Import),
    Identify(identify::Identify),
    Material(material::Material),
    Reproduce(reproduce::Reproduce),
    Workspace(workspace::Workspace),
}

impl Command {
    /// Runs the command; `json` asks for results as JSON.
    pub fn run(self, json: bool) -> Outcome {
        match self {
            Command::Demo(demo) => demo.run(json),
            Command::Map(map) => map.run(json),
            Command::Merge(merge) => merge.run(json),
            Command::Inspect(inspect) => inspect.run(json),
            Command::Blocked(blocked) => blocked.run(json),
            Command::Fit(fit) => fit.run(json),
            Command::Export(export) => export.run(json),
            Command::Predict(predict) => predict.run(json),
            Command::Solve(solve) => solve.run(json),
            Command::Track(track) => track.run(json),
            Command::Replay(replay) => replay.run(json),
            Command::Import(import) => import.run(json),
            Command::Identify(identify) => identify.run(json),
            Command::Material(material) => material.run(json),
            Command::Reproduce(reproduce) => reproduce.run(json),
            Command::Workspace(workspace) => workspace.run(json),
        }
    }
}
