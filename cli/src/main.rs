//! From the drawing of a FREE actuator to its controller: the binary `freeact`.

mod axis;
mod base_model;
mod blocked_report;
mod choice;
mod columns;
mod command;
mod content;
mod elements;
mod exit;
mod failure;
mod goal;
mod identify_report;
mod interrupt;
mod lasting;
mod map_columns;
mod map_csv;
mod map_file;
mod material_csv;
mod material_report;
mod output;
mod parquet;
mod part;
mod path_sweep;
mod plan;
mod plot;
mod point_key;
mod points;
mod pressures_csv;
mod progress;
mod recordings;
mod refinement;
mod report;
mod run_statistics;
mod shape;
mod simulated_rig;
mod solid_states;
mod solution;
mod solve_log;
mod study;
mod sweep;
mod table;
mod tip_model;
mod values;
mod workspace_report;

use clap::{CommandFactory, FromArgMatches, Parser};
use exit::Exit;
use std::process::ExitCode;

/// From the drawing of a FREE actuator to its controller.
///
/// A FREE (Fiber Reinforced Elastomeric Enclosure) is a rubber tube wound with thread: inflated, it stretches, swells and
/// turns. freeact computes how much by finite elements (`map`), makes that fast (`fit`, `predict`), finds the pressures
/// for a wanted pose (`solve`, `track`, `replay`) and what can be reached at all (`workspace`), and finds out from recordings
/// what the model lacks (`import`, `identify`). Begin with `freeact demo`.
///
/// Winding angles are measured from the hoop (circumferential) direction: 0 = rings, 90 = along the tube. Pressures are gauge.
#[derive(Parser)]
#[command(name = "freeact", version, max_term_width = 110)]
struct Program {
    #[command(subcommand)]
    command: command::Command,

    /// Print results, and errors, as JSON
    #[arg(long, global = true)]
    json: bool,
}

fn main() -> ExitCode {
    let json_wanted = std::env::args_os().any(|argument| argument == "--json");
    let parsed = Program::command().after_long_help(Exit::table()).try_get_matches();
    let program = match parsed.and_then(|matches| Program::from_arg_matches(&matches)) {
        Ok(program) => program,
        Err(error) if error.use_stderr() && json_wanted => {
            let usage = failure::Failure::usage(error.to_string());
            eprintln!("{}", usage.json());
            return Exit::Usage.into();
        }
        Err(error) => {
            drop(error.print());
            return if error.use_stderr() { Exit::Usage.into() } else { Exit::Done.into() };
        }
    };
    interrupt::listen();
    match program.command.run(program.json) {
        Ok(exit) => exit.into(),
        Err(failure) => {
            match program.json {
                true => eprintln!("{}", failure.json()),
                false => eprintln!("error: {}", failure.paragraph()),
            }
            failure.exit.into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_consistent_and_every_command_has_an_example() {
        let mut program = Program::command();
        program.clone().debug_assert();
        program.build();
        for command in program.get_subcommands().filter(|command| command.get_name() != "help") {
            let help = command.clone().render_long_help().to_string();
            let example = format!("freeact {} ", command.get_name());
            assert!(help.contains("Example") && help.contains(&example), "{}:\n{help}", command.get_name());
        }
    }
}
