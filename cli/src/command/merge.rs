use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    map_file::MapFile,
    output,
};
use serde_json::json;
use std::path::PathBuf;

/// Join the parts of a map that several machines computed
///
/// The parts are made by `freeact map --shard 1/n` to `--shard n/n`. They must come from the same description, axes and
/// settings; a node that two parts have must be the same in both.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  freeact merge module.1.map module.2.map module.3.map --out module.map")]
pub struct Merge {
    /// The parts
    #[arg(required = true, value_name = "M.map")]
    parts: Vec<PathBuf>,

    /// The joined map
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl Merge {
    pub fn run(self, json: bool) -> Outcome {
        // At least one, by the parser's word.
        let Some((first, others)) = self.parts.split_first() else {
            return Err(Failure::usage("give the maps to join"));
        };
        let mut whole = MapFile::read(first)?;
        for path in others {
            let part = MapFile::read(path)?;
            if let Some(what) = whole.difference(&part) {
                return Err(Failure::refused(format!(
                    "{} and {} are not parts of one sweep: {what} differ; join only what one `freeact map` command \
                     made, with --shard alone changed",
                    first.display(),
                    path.display()
                )));
            }
            whole.absorb(part).map_err(|what| {
                Failure::refused(format!(
                    "{} does not fit the parts before it: {what}; make it again with the same version of freeact",
                    path.display()
                ))
            })?;
        }
        whole.write(&self.out)?;
        let (computed, nodes) = whole.computed();
        if json {
            let missing = nodes - computed;
            output::print_json(
                &json!({ "out": self.out, "nodes": nodes, "computed": computed, "missing": missing }),
            );
        } else {
            let advice = match computed == nodes {
                true => "complete",
                false => {
                    "the rest is in a part that was not given, or can be computed by `freeact map --resume`"
                }
            };
            output::print(&format!("{}: {computed} of {nodes} nodes; {advice}\n", self.out.display()));
        }
        Ok(if computed == nodes { Exit::Done } else { Exit::NotConverged })
    }
}
