use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    interrupt, output,
    progress::Progress,
    study::{self, Bench, Done, Findings, Laws},
    sweep,
};
use serde_json::json;
use std::{
    path::{Path, PathBuf},
    time::Instant,
};

/// Compute the paper's studies anew, and judge its claims
///
/// Studies are named by the paper's figures (fig2, fig5, ...) or by rows of the table of its claims (p1, p2, ...). Each claim is
/// printed with what is found here, a verdict (holds, does not hold, cannot be judged) and the reason; a claim that does not
/// hold is a result, not an error. DIR receives index.html, summary.md, figures (SVG, PNG), every curve (CSV) and states (.vtu,
/// for ParaView). Ctrl-C keeps the studies that are finished.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact reproduce fig2 fig6 --out reproduced
  freeact reproduce p10 p12 --solids --out reproduced
  freeact reproduce all --out reproduced")]
pub struct Reproduce {
    /// The studies (default: all that there are)
    #[arg(value_name = "STUDY")]
    studies: Vec<String>,

    /// Directory for the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    /// What computes the states
    #[arg(long, value_enum, default_value = "solid")]
    fidelity: Fidelity,

    /// Modules as solids too, beside the rods (p10, p12): seconds a state, minutes where walls give way
    #[arg(long)]
    solids: bool,

    /// Coarse meshes and few states: for a quick look, not for numbers
    #[arg(long)]
    coarse: bool,

    /// Threads (default: one per processor)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=4096))]
    jobs: Option<u64>,
}

/// What computes the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Fidelity {
    /// Single FREEs as solids with their caps, modules as rods (as solids too with --solids)
    Solid,
}

impl Reproduce {
    pub fn run(self, json: bool) -> Outcome {
        let studies = study::chosen(&self.studies)?;
        output::make_directory(&self.out)?;
        let start = Instant::now();
        let bench = Bench {
            coarse: self.coarse,
            solids: self.solids,
            jobs: self.jobs.map_or_else(sweep::processors, |jobs| jobs as usize),
            progress: Progress::bar("studies"),
            laws: Laws::default(),
        };
        let Fidelity::Solid = self.fidelity;
        let mut done: Vec<Done> = vec![];
        let mut failed: Vec<(&str, Failure)> = vec![];
        for study in studies {
            let Some(compute) = study.compute else { continue };
            let begun = Instant::now();
            match compute(&bench) {
                Ok(findings) => {
                    write(&findings, &self.out)?;
                    done.push(Done { study, findings, seconds: begun.elapsed().as_secs_f64() });
                }
                Err(failure) => failed.push((study.title, failure)),
            }
            if interrupt::is_asked() {
                break;
            }
        }
        drop(bench);
        if done.is_empty()
            && let Some((_, failure)) = failed.pop()
        {
            return Err(failure);
        }
        let seconds = start.elapsed().as_secs_f64();
        study::page(&done, seconds)?.save(&self.out.join("index.html"))?;
        output::save(&self.out.join("summary.md"), study::markdown(&done).as_bytes())?;
        for (title, failure) in &failed {
            eprintln!("not finished: {title}: {}", failure.paragraph());
        }
        if json {
            let mut value = study::json(&done);
            value["out"] = json!(self.out);
            value["coarse"] = json!(self.coarse);
            value["solids"] = json!(self.solids);
            value["seconds"] = json!(seconds);
            let failed =
                failed.iter().map(|(title, failure)| json!({ "title": title, "why": failure.paragraph() }));
            value["failed"] = json!(failed.collect::<Vec<_>>());
            output::print_json(&value);
        } else {
            let page = self.out.join("index.html");
            output::print(&format!("{}\n{}\n", study::table(&done), page.display()));
        }
        Ok(match failed.first() {
            _ if interrupt::is_asked() => Exit::Interrupted,
            Some((_, failure)) => failure.exit,
            None => Exit::Done,
        })
    }
}

/// Writes a study's figures, curves and states.
fn write(findings: &Findings, out: &Path) -> Result<(), Failure> {
    for (stem, picture, _) in &findings.figures {
        picture.write(out, stem)?;
    }
    for curves in &findings.curves {
        output::save(&out.join(format!("{}.csv", curves.stem)), curves.csv().as_bytes())?;
    }
    for grid in &findings.grids {
        output::save(&out.join(&grid.name), &grid.bytes)?;
    }
    Ok(())
}
