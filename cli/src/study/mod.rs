//! The paper's studies, each computed anew: claim, ours, verdict. One study a file; the mechanics are in `fe`.

mod bench;
mod blocked_force;
mod extension;
mod findings;
mod future_work;
mod idle_claims;
mod idle_frees;
mod idle_pictures;
mod inflated_strain;
mod module_cases;
mod module_comparison;
mod module_rods;
mod module_solids;
mod module_workspace;
mod report;
mod spacing;
mod specimen;
mod stiffness;
mod tube_expansion;

pub use bench::Bench;
pub use findings::Findings;
pub use module_rods::Laws;
pub use report::{Done, json, markdown, page, table};

use crate::failure::Failure;

/// How a study is computed.
type Compute = fn(&Bench) -> Result<Findings, Failure>;

/// What the paper reports under one or several of its headings, and what computes it here.
pub struct Study {
    /// Names on the command line: rows of the table of claims and figures of the paper.
    pub names: &'static [&'static str],
    /// What is studied.
    pub title: &'static str,
    /// Its computation; `None` where there is none yet.
    pub compute: Option<Compute>,
}

/// All of the paper's studies, in its order.
pub const STUDIES: [Study; 12] = [
    Study {
        names: &["p1"],
        title: "Strain of an inflated 20° FREE",
        compute: Some(inflated_strain::compute),
    },
    Study {
        names: &["fig2", "p2", "p4"],
        title: "Fig. 2: expansion of the bare and the coated tube",
        compute: Some(tube_expansion::compute),
    },
    Study { names: &["p3"], title: "Calibration of rubber and fibre", compute: None },
    Study { names: &["fig3", "p5"], title: "Fig. 3: rotation of 20°, 50° and 70°", compute: None },
    Study { names: &["fig4", "p6"], title: "Fig. 4: deformations from 10° to 80°", compute: None },
    Study {
        names: &["fig6", "p8"],
        title: "Fig. 6: rubber and fibre softer and stiffer",
        compute: Some(stiffness::compute),
    },
    Study {
        names: &["fig5", "p7"],
        title: "Fig. 5: extension without pressure",
        compute: Some(extension::compute),
    },
    Study { names: &["fig7", "p9"], title: "Fig. 7: softer rubber from 20° to 70°", compute: None },
    Study {
        names: &["fig8", "fig9", "fig10", "p10"],
        title: "Figs. 8 to 10: modules",
        compute: Some(module_cases::compute),
    },
    Study {
        names: &["fig11", "fig12", "p11"],
        title: "Figs. 11 and 12: workspace of the 60 LR",
        compute: Some(module_workspace::compute),
    },
    Study { names: &["fig13", "p12"], title: "Fig. 13: idle FREEs", compute: Some(idle_frees::compute) },
    Study { names: &["p13"], title: "The paper's future work", compute: Some(future_work::compute) },
];

/// The studies asked for, each once and in the paper's order; for `all` or no name those that can be computed.
///
/// # Errors
/// A name that the paper does not have, or one whose study is not there yet.
pub fn chosen(names: &[String]) -> Result<Vec<&'static Study>, Failure> {
    let names: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
    if names.is_empty() || names.iter().any(|name| name == "all") {
        if let Some(other) = names.iter().find(|name| *name != "all") {
            return Err(Failure::usage(format!("{other}: name studies, or give `all` alone")));
        }
        return Ok(STUDIES.iter().filter(|study| study.compute.is_some()).collect());
    }
    let known = |computed: bool| {
        let studies = STUDIES.iter().filter(|study| study.compute.is_some() == computed);
        studies.flat_map(|study| study.names).copied().collect::<Vec<_>>().join(", ")
    };
    for name in &names {
        match STUDIES.iter().find(|study| study.names.contains(&name.as_str())) {
            None => {
                return Err(Failure::usage(format!(
                    "{name}: the paper's studies are {}, or all; not there yet: {}",
                    known(true),
                    known(false)
                )));
            }
            Some(study) if study.compute.is_none() => {
                return Err(Failure::refused(format!(
                    "{name} ({}) is not there yet; there are {}",
                    study.title,
                    known(true)
                )));
            }
            Some(_) => {}
        }
    }
    Ok(STUDIES
        .iter()
        .filter(|study| study.names.iter().any(|own| names.iter().any(|name| name == own)))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exit::Exit;

    fn exit(names: &[&str]) -> Exit {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        chosen(&names).map_or_else(|failure| failure.exit, |_| Exit::Done)
    }

    #[test]
    fn every_row_and_figure_has_one_study() {
        let names: Vec<&str> = STUDIES.iter().flat_map(|study| study.names).copied().collect();
        for name in (1..=13).map(|row| format!("p{row}")).chain((2..=13).map(|figure| format!("fig{figure}")))
        {
            assert_eq!(names.iter().filter(|own| **own == name).count(), 1, "{name}");
        }
    }

    #[test]
    fn studies_are_chosen_once_and_refused_in_words() {
        let names = ["fig6", "P1", "p8"].map(str::to_owned);
        let chosen: Vec<_> = chosen(&names).unwrap().iter().map(|study| study.names[0]).collect();
        assert_eq!(chosen, ["p1", "fig6"]);
        assert_eq!(exit(&[]), Exit::Done);
        assert_eq!(exit(&["all"]), Exit::Done);
        assert_eq!(exit(&["all", "p1"]), Exit::Usage);
        assert_eq!(exit(&["fig99"]), Exit::Usage);
        assert_eq!(exit(&["p1", "p9"]), Exit::Refused);
    }
}
