//! Studies as a table, a page, Markdown and JSON.

use super::{Findings, STUDIES, Study};
use crate::{
    failure::Failure,
    report::Page,
    table::{Table, duration},
};
use serde_json::json;

/// A study and what it came to.
pub struct Done {
    /// Which.
    pub study: &'static Study,
    /// Its results.
    pub findings: Findings,
    /// Time, s.
    pub seconds: f64,
}

/// What is said wherever results are shown.
const SIMULATED: &str = "All numbers are simulated. The paper's measured points are not available as numbers: claims are judged by its \
                         text.";

fn missing() -> String {
    let missing = STUDIES.iter().filter(|study| study.compute.is_none());
    missing.map(|study| study.names.join(", ")).collect::<Vec<_>>().join("; ")
}

fn rows(done: &[Done]) -> impl Iterator<Item = Vec<String>> + '_ {
    done.iter().flat_map(|done| &done.findings.findings).map(|finding| {
        vec![
            finding.row.into(),
            finding.claim.into(),
            finding.ours.clone(),
            finding.verdict.to_string(),
            finding.reason.clone(),
        ]
    })
}

/// For a terminal: each claim in a few lines, then the tables.
pub fn table(done: &[Done]) -> String {
    let mut text = String::new();
    for done in done {
        text += &format!("{} ({})\n\n", done.study.title, duration(done.seconds));
        let mut table = Table::new(["<row", "<", "<"]);
        for finding in &done.findings.findings {
            let verdict = finding.verdict.to_string();
            for (row, name, words) in [
                (finding.row, "claim", finding.claim),
                ("", "ours", finding.ours.as_str()),
                ("", "verdict", verdict.as_str()),
                ("", "reason", finding.reason.as_str()),
            ] {
                table.row([row.to_owned(), name.to_owned(), words.to_owned()]);
            }
        }
        text += &table.text();
        for table in &done.findings.tables {
            text += &format!("\n{}\n\n{}", table.title, table.text());
        }
        text += "\n";
    }
    text + &format!("{SIMULATED}\nNot there yet: {}\n", missing())
}

/// For a repository's page.
pub fn markdown(done: &[Done]) -> String {
    let cell = |text: &str| text.replace('|', "\\|");
    let line = |cells: &[String]| {
        format!("| {} |\n", cells.iter().map(|text| cell(text)).collect::<Vec<_>>().join(" | "))
    };
    let mut text = format!("# The paper's claims\n\n{SIMULATED}\n\n");
    text += "| row | claim | ours | verdict | reason |\n|---|---|---|---|---|\n";
    text.extend(rows(done).map(|row| line(&row)));
    for done in done {
        text += &format!("\n## {}\n\n", done.study.title);
        done.findings.setup.iter().for_each(|words| text += &format!("{words}\n\n"));
        for table in &done.findings.tables {
            let head: Vec<String> =
                table.head.iter().map(|head| head.trim_start_matches('<').to_owned()).collect();
            text += &format!("{}\n\n{}|{}\n", table.title, line(&head), "---|".repeat(head.len()));
            text.extend(table.rows.iter().map(|row| line(row)));
            text += "\n";
        }
        let files = done.findings.figures.iter().map(|(stem, ..)| format!("{stem}.svg, {stem}.png"));
        let files = files.chain(done.findings.curves.iter().map(|curves| format!("{}.csv", curves.stem)));
        let files = files.chain(done.findings.grids.iter().map(|grid| grid.name.clone()));
        text += &format!("Files: {}\n", files.collect::<Vec<_>>().join(", "));
    }
    text + &format!("\nNot there yet: {}\n", missing())
}

/// For a browser.
pub fn page(done: &[Done], seconds: f64) -> Result<Page, Failure> {
    let mut page = Page::new(
        "The paper's studies, computed anew",
        &format!(
            "Buffinton et al. 2020, \"Investigating the Mechanics of Human-Centered Soft Robotic Actuators with Finite Element \
             Analysis\"; {}",
            duration(seconds)
        ),
    );
    let all: Vec<Vec<String>> = rows(done).collect();
    let count = |verdict: &str| all.iter().filter(|row| row[3] == verdict).count();
    page.lead(&format!(
        "Of {} claims {} hold, {} do not, {} cannot be judged. {SIMULATED}",
        all.len(),
        count("holds"),
        count("does not hold"),
        count("cannot be judged")
    ));
    page.section("Claims");
    page.table(&["<row", "<claim", "<ours", "<verdict", "<reason"], &all);
    for done in done {
        page.section(done.study.title);
        done.findings.setup.iter().for_each(|words| page.paragraph(words));
        for table in &done.findings.tables {
            page.paragraph(&format!("{}:", table.title));
            page.table(&table.head.iter().map(String::as_str).collect::<Vec<_>>(), &table.rows);
        }
        let drawn = done
            .findings
            .figures
            .iter()
            .map(|(_, picture, caption)| Ok((picture.title(), picture.inline_svg()?, caption.as_str())));
        page.drawings(&drawn.collect::<Result<Vec<_>, Failure>>()?);
        let files = done.findings.curves.iter().map(|curves| format!("{}.csv", curves.stem));
        let files = files.chain(done.findings.grids.iter().map(|grid| grid.name.clone()));
        page.paragraph(&format!("Numbers and states: {}.", files.collect::<Vec<_>>().join(", ")));
    }
    page.section("Not there yet");
    page.paragraph(&format!("{}.", missing()));
    Ok(page)
}

/// For programs.
pub fn json(done: &[Done]) -> serde_json::Value {
    let study = |done: &Done| {
        let findings = done.findings.findings.iter().map(|finding| {
            json!({
                "row": finding.row, "claim": finding.claim, "ours": finding.ours,
                "verdict": finding.verdict.to_string(), "reason": finding.reason,
            })
        });
        let tables = done.findings.tables.iter().map(|table| {
            let head: Vec<&str> = table.head.iter().map(|head| head.trim_start_matches('<')).collect();
            json!({ "title": table.title, "head": head, "rows": table.rows })
        });
        json!({
            "names": done.study.names, "title": done.study.title, "seconds": done.seconds, "setup": done.findings.setup,
            "claims": findings.collect::<Vec<_>>(), "tables": tables.collect::<Vec<_>>(),
        })
    };
    let missing = STUDIES.iter().filter(|study| study.compute.is_none()).flat_map(|study| study.names);
    json!({
        "simulated": true, "studies": done.iter().map(study).collect::<Vec<_>>(),
        "not_there_yet": missing.collect::<Vec<_>>(),
    })
}
