//! What an identification came to, as a table and as a page with plots.

use crate::{
    content::link,
    failure::Failure,
    plot::{Chart, Mark, Series, thin},
    report::Page,
    table::{Table, duration, short},
};
use actuator::units::{DEG, KPA, MM};
use identify::{Errors, Estimated, Finding, Outcome, Stages, Verdict};

/// Points that a curve of the report is drawn with.
const POINTS: usize = 1200;

/// Up to so many points are drawn as marks.
const FEW: usize = 150;

/// The verdict in a sentence.
pub fn sentence(verdict: &Verdict) -> String {
    let names: Vec<&str> = verdict.effects.iter().map(|effect| effect.name.as_str()).collect();
    let names = names.join(", ").replace('_', " ");
    match (verdict.verdict, names.is_empty()) {
        (Finding::NothingMissing, _) => {
            "Nothing is missing: the calibrated model leaves only noise and its own error.".into()
        }
        (Finding::Explained, _) => format!("Explained: the model lacked {names}."),
        (Finding::Unexplained, true) => {
            "Unexplained: something is missing that no known effect accounts for.".into()
        }
        (Finding::Unexplained, false) => {
            format!(
                "Unexplained: with {names} the model is better, but something is left that no known effect accounts for."
            )
        }
    }
}

/// The verdict with its numbers, for a terminal.
pub fn text(verdict: &Verdict) -> String {
    let mut text = sentence(verdict) + "\n";
    for (title, (head, rows)) in [
        ("Effects found", effects(verdict)),
        ("The model's own numbers, fitted", calibration(verdict)),
        ("Errors on recordings that took no part in the fit", errors(verdict)),
    ] {
        if !rows.is_empty() {
            let mut table = Table::with_head(head);
            rows.into_iter().for_each(|row| table.row_of(row));
            text += &format!("\n{title}\n\n{}", table.text());
        }
    }
    text += &format!("\nLeft over: {}\n", verdict.residual_after.structure);
    if !verdict.next_experiment.is_empty() {
        text += &format!("Next experiment: {}\n", verdict.next_experiment);
    }
    for finding in &verdict.findings {
        text += &format!("Note: {finding}\n");
    }
    text
}

/// The report.
pub fn page(rig: &str, outcome: &Outcome) -> Result<Page, Failure> {
    let verdict = &outcome.verdict;
    let subtitle = format!("what the model of rig \"{rig}\" lacks; {}", duration(verdict.seconds));
    let mut page = Page::new(&format!("Identification of {rig}"), &subtitle);
    page.lead(&sentence(verdict));
    let table =
        |page: &mut Page, title: &str, (head, rows): (Vec<String>, Vec<Vec<String>>), nothing: &str| {
            page.section(title);
            match rows.is_empty() {
                true => page.paragraph(nothing),
                false => page.table(&head.iter().map(String::as_str).collect::<Vec<_>>(), &rows),
            }
        };
    table(&mut page, "Effects found", effects(verdict), "None earned its place.");
    table(&mut page, "The model's own numbers", calibration(verdict), "None was fitted.");
    let bars = intervals(verdict);
    if !bars.series.is_empty() {
        page.figures(&[(bars, "95 % intervals, as a share of each estimate. One that reaches −100 % cannot be told from nothing.".into())])?;
    }
    table(
        &mut page,
        "Errors on recordings that took no part in the fit",
        errors(verdict),
        "Nothing was held out.",
    );
    page.paragraph(
        "Before: the model from the description alone. Calibrated: with its own free numbers fitted. After: with the effects \
         found. Noise: what a perfect model would leave.",
    );
    page.section("Residual: predicted minus measured");
    page.paragraph(&verdict.residual_after.structure);
    page.figures(&residuals(outcome))?;
    if !verdict.next_experiment.is_empty() {
        page.section("Next experiment");
        page.paragraph(&verdict.next_experiment);
    }
    page.section("How it was found");
    for line in verdict.findings.iter().chain(&outcome.log) {
        page.paragraph(line);
    }
    Ok(page)
}

type Rows = (Vec<String>, Vec<Vec<String>>);

fn head<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).to_vec()
}

fn with_interval(name: &str, estimated: &Estimated) -> String {
    let [low, high] = estimated.ci95;
    format!("{name} = {} ({} to {})", short(estimated.value), short(low), short(high))
}

fn effects(verdict: &Verdict) -> Rows {
    let row = |effect: &identify::FoundEffect| {
        let parameters: Vec<String> =
            effect.parameters.iter().map(|(name, estimated)| with_interval(name, estimated)).collect();
        let frees: Vec<String> = effect.frees.iter().map(ToString::to_string).collect();
        vec![
            effect.name.clone(),
            link(effect.link).to_owned(),
            if frees.is_empty() { "all".into() } else { frees.join(", ") },
            parameters.join("; "),
            format!("{:.0} %", 100.0 * effect.gain_held_out),
            if effect.indistinguishable_from.is_empty() {
                "–".into()
            } else {
                effect.indistinguishable_from.join(", ")
            },
        ]
    };
    let head = head([
        "<effect",
        "<acts on",
        "<FREEs",
        "<parameters (95 % interval)",
        "held-out loss removed",
        "<not to be told from",
    ]);
    (head, verdict.effects.iter().map(row).collect())
}

fn calibration(verdict: &Verdict) -> Rows {
    let row = |(name, estimated): (&String, &Estimated)| {
        let [low, high] = estimated.ci95;
        vec![name.clone(), short(estimated.value), format!("{} to {}", short(low), short(high))]
    };
    (head(["<number", "value", "95 % interval"]), verdict.calibration.iter().map(row).collect())
}

/// Head of a column and the error in it.
type ErrorColumn = (&'static str, fn(&Errors) -> Option<f64>);

/// Errors that a kind of actuator has, with their heads.
const ERRORS: [ErrorColumn; 5] = [
    ("position rms (mm)", |errors| errors.position_rms_mm),
    ("rotation rms (°)", |errors| errors.rotation_rms_deg),
    ("twist rms (rad)", |errors| errors.twist_rms_rad),
    ("extension rms (mm)", |errors| errors.extension_rms_mm),
    ("expansion rms", |errors| errors.expansion_rms),
];

fn errors(verdict: &Verdict) -> Rows {
    let drives =
        [("the measured pressure", &verdict.held_out), ("the command", &verdict.held_out_from_command)];
    let stages: Vec<(&str, &Stages)> =
        drives.iter().filter_map(|(name, s)| Some((*name, s.as_ref()?))).collect();
    let shown = |value: fn(&Errors) -> Option<f64>| {
        stages
            .iter()
            .any(|(_, s)| [s.before, s.calibrated, s.after].iter().any(|errors| value(errors).is_some()))
    };
    let columns: Vec<_> = ERRORS.iter().filter(|(_, value)| shown(*value)).collect();
    let mut names = head(["<model driven by", "<stage"]);
    names.extend(columns.iter().map(|(name, _)| (*name).to_owned()));
    let mut rows = Vec::new();
    for (drive, stages) in &stages {
        for (stage, errors) in [
            ("before", stages.before),
            ("calibrated", stages.calibrated),
            ("after", stages.after),
            ("noise", stages.noise),
        ] {
            let mut row = vec![(*drive).to_owned(), stage.to_owned()];
            row.extend(columns.iter().map(|(_, value)| value(&errors).map_or("–".into(), short)));
            rows.push(row);
        }
    }
    (names, rows)
}

/// How well each number is known.
fn intervals(verdict: &Verdict) -> Chart {
    let found = verdict.effects.iter().flat_map(|effect| {
        effect.parameters.iter().map(move |(name, estimated)| (format!("{} {name}", effect.name), estimated))
    });
    let all = found.chain(verdict.calibration.iter().map(|(name, estimated)| (name.clone(), estimated)));
    let mut chart = Chart::new("How well the numbers are known", "deviation from the estimate (%)", "");
    for (i, (name, estimated)) in all.filter(|(_, estimated)| estimated.value != 0.0).enumerate() {
        let share = |end: f64| 100.0 * (end - estimated.value) / estimated.value.abs();
        let at = |x: f64| (x, -(i as f64));
        let points = vec![at(share(estimated.ci95[0])), at(0.0), at(share(estimated.ci95[1]))];
        chart = chart.with(Series::new(name, Mark::LinePoints, points));
    }
    chart
}

/// A residual as it is drawn: name, unit's name, and its value at a sample.
struct Drawn {
    name: &'static str,
    label: &'static str,
    value: fn(&[Vec<f64>], usize) -> f64,
}

fn length(channels: &[Vec<f64>], from: usize, sample: usize) -> f64 {
    (from..from + 3).map(|i| channels[i][sample].powi(2)).sum::<f64>().sqrt()
}

const OF_A_MODULE: [Drawn; 2] = [
    Drawn { name: "Position", label: "distance (mm)", value: |c, k| length(c, 0, k) / MM },
    Drawn { name: "Rotation", label: "angle (°)", value: |c, k| length(c, 3, k) / DEG },
];
const OF_A_FREE: [Drawn; 3] = [
    Drawn { name: "Twist", label: "twist residual (rad)", value: |c, k| c[0][k] },
    Drawn { name: "Extension", label: "extension residual (mm)", value: |c, k| c[1][k] / MM },
    Drawn { name: "Diameter", label: "diameter residual (mm)", value: |c, k| c[2][k] / MM },
];

fn residuals(outcome: &Outcome) -> Vec<(Chart, String)> {
    let held_out: Vec<&identify::Series> =
        outcome.series.iter().filter(|series| series.is_held_out).collect();
    let is_module = held_out.first().is_some_and(|series| series.before.len() >= 6);
    let drawn: &[Drawn] = if is_module { &OF_A_MODULE } else { &OF_A_FREE };
    let mut charts = Vec::new();
    for Drawn { name, label, value } in drawn {
        let measured = held_out.iter().any(|s| (0..s.time.len()).any(|k| value(&s.before, k).is_finite()));
        if !measured {
            continue;
        }
        for series in &held_out {
            let curve = |channels: &[Vec<f64>]| {
                let points = series.time.iter().enumerate().map(|(k, time)| (*time, value(channels, k)));
                thin(points.collect(), POINTS)
            };
            let chart = Chart::new(format!("{name}, {}", series.name), "time (s)", *label)
                .with(scattered("calibrated", curve(&series.before)).coloured(1))
                .with(scattered("with effects", curve(&series.after)).coloured(0));
            charts.push((chart, format!("Held-out recording \"{}\" against time.", series.name)));
        }
        let strongest = |channels: &[Vec<f64>], k: usize| {
            channels
                .iter()
                .map(|channel| channel[k])
                .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
        };
        let against = |x: &dyn Fn(&identify::Series, usize) -> f64, after: bool| {
            let all = held_out.iter().flat_map(|series| {
                let channels = if after { &series.after } else { &series.before };
                (0..series.time.len()).map(move |k| (x(series, k), value(channels, k)))
            });
            sparse(all.collect(), POINTS)
        };
        let pressure = |series: &identify::Series, k: usize| strongest(&series.pressures, k) / KPA;
        let rate = |series: &identify::Series, k: usize| strongest(&series.rates, k) / KPA;
        let of_which = if is_module { "the greatest of the FREEs'" } else { "the FREE's" };
        for (title, axis, x) in [
            ("pressure", "pressure (kPa)", &pressure as &dyn Fn(&identify::Series, usize) -> f64),
            ("pressure rate", "pressure rate (kPa/s)", &rate),
        ] {
            let chart = Chart::new(format!("{name} against {title}"), axis, *label)
                .with(scattered("calibrated", against(x, false)).coloured(1))
                .with(scattered("with effects", against(x, true)).coloured(0));
            charts.push((chart, format!("All held-out recordings; {title} is {of_which}.")));
        }
    }
    charts
}

/// Points under a name: marks that tell series apart where there are few, dots where there are many.
fn scattered(name: &str, points: Vec<(f64, f64)>) -> Series {
    let mark = if points.len() <= FEW { Mark::Points } else { Mark::Dots };
    Series::new(name, mark, points)
}

/// At most about `most` of the points, evenly picked.
fn sparse(points: Vec<(f64, f64)>, most: usize) -> Vec<(f64, f64)> {
    let stride = points.len().div_ceil(most.max(1)).max(1);
    points.into_iter().step_by(stride).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::check_tags;
    use identify::{FoundEffect, Residual};
    use rom::effect::{Chain, Link};

    fn outcome(channels: usize) -> Outcome {
        let errors = Errors { position_rms_mm: Some(1.0), rotation_rms_deg: Some(2.0), ..Errors::default() };
        let stages = Stages { before: errors, calibrated: errors, after: errors, noise: errors };
        let effect = FoundEffect {
            name: "supply_lag".into(),
            link: Link::Supply,
            frees: vec![1, 2],
            parameters: [("time_constant_s".to_owned(), Estimated { value: 0.3, ci95: [0.2, 0.4] })].into(),
            indistinguishable_from: vec!["delay".into()],
            gain_held_out: 0.9,
        };
        let verdict = Verdict {
            verdict: Finding::Explained,
            effects: vec![effect],
            calibration: [("stiffness_scale".to_owned(), Estimated { value: 1.0, ci95: [0.99, 1.01] })]
                .into(),
            held_out: None,
            held_out_from_command: Some(stages),
            residual_after: Residual { white: true, structure: "noise".into() },
            next_experiment: "none".into(),
            findings: vec![],
            seconds: 1.0,
        };
        let series = identify::Series {
            name: "smooth".into(),
            is_held_out: true,
            time: vec![0.0, 1.0],
            pressures: vec![vec![0.0, 1e3], vec![2e3, 0.0]],
            rates: vec![vec![0.0, -5e3], vec![1e3, 0.0]],
            before: vec![vec![1e-3, f64::NAN]; channels],
            after: vec![vec![1e-4, 2e-4]; channels],
        };
        Outcome {
            verdict,
            chain: Chain::default(),
            series: vec![series],
            log: vec!["tried lag < delay".into()],
        }
    }

    #[test]
    fn a_verdict_is_told_with_intervals_and_confusions() {
        let text = text(&outcome(6).verdict);
        for words in [
            "the model lacked supply lag",
            "time_constant_s = 0.3000 (0.2000 to 0.4000)",
            "90 %",
            "delay",
            "the command",
        ] {
            assert!(text.contains(words), "{words} is not in\n{text}");
        }
        // What was not recorded is not told.
        assert!(!text.contains("the measured pressure") && !text.contains("twist rms"));
    }

    #[test]
    fn the_report_is_whole_for_modules_and_frees() {
        for (channels, charts, axis) in [(6, 1 + 2 * 3, "angle (°)"), (3, 1 + 3 * 3, "twist residual (rad)")]
        {
            let html = page("rig", &outcome(channels)).unwrap().html();
            check_tags(&html);
            assert_eq!(html.matches("<svg ").count(), charts);
            assert!(html.contains(axis) && html.contains("tried lag &lt; delay"));
        }
    }
}
