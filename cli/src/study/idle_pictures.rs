//! Fig. 13: how far idle FREEs bow, what idle pressure does to it, and how walls give way.

use super::{
    findings::Findings,
    idle_frees::{Studied, StudiedSolids, stem},
};
use crate::plot::{Chart, Field, Mark, Patch, Series};
use actuator::units::{DEG, KPA, MM};
use fe::{Bulge, IdlePressure};

/// Stems of a reading's files.
fn stems(studied: &Studied) -> [&'static str; 3] {
    match stem(studied.kind) {
        "hoop" => ["fig13-hoop-bow", "fig13-hoop-idle", "fig13-hoop-mode"],
        _ => ["fig13-axis-bow", "fig13-axis-idle", "fig13-axis-mode"],
    }
}

/// Adds the pictures of a reading.
pub fn figures(studied: &Studied, findings: &mut Findings) {
    let stems = stems(studied);
    let name = studied.kind.name;
    let mut chart = Chart {
        subtitle: "case 2, no ties".into(),
        legend: "in the idle FREEs".into(),
        ..Chart::new(
            format!("{name}: bow of idle FREEs, simulated"),
            "pressure of the diagonal pair (kPa)",
            "bow (mm)",
        )
    };
    let mut idles: Vec<f64> = studied.nodes.iter().map(|node| node.idle_kpa).collect();
    idles.dedup();
    for idle in &idles {
        let own = studied.nodes.iter().filter(|node| node.idle_kpa == *idle);
        let points =
            own.map(|node| (node.case_kpa, node.found.map_or(f64::NAN, |shape| shape.bow))).collect();
        chart = chart.with(Series::new(format!("{idle:.1} kPa"), Mark::Line, points));
    }
    if let Some(solids) = &studied.solids {
        let points = solids.bare().map(|(kpa, shape)| (kpa, shape.bow)).collect();
        chart = chart.with(Series::new("0.0 kPa, solids", Mark::Points, points).coloured(0));
    }
    findings.figures.push((
        stems[0],
        chart.into(),
        "Greatest distance of an idle FREE from the line between its ends.".into(),
    ));
    let step = |values: &[f64]| {
        values.windows(2).map(|pair| pair[1] - pair[0]).find(|step| *step > 0.0).unwrap_or(1.0)
    };
    let cases: Vec<f64> =
        studied.nodes.iter().filter(|node| node.idle_kpa == idles[0]).map(|node| node.case_kpa).collect();
    let (wide, high) = (0.5 * step(&cases), 0.5 * step(&idles));
    let patches = studied.nodes.iter().filter_map(|node| {
        let (x, y, shape) = (node.case_kpa, node.idle_kpa, node.found?);
        Some(Patch {
            corners: [(x - wide, y - high), (x + wide, y - high), (x + wide, y + high), (x - wide, y + high)],
            value: shape.bow,
        })
    });
    let unstable = studied.nodes.iter().filter(|node| node.found.is_some_and(|shape| shape.unstable));
    let unstable = unstable.map(|node| (node.case_kpa, node.idle_kpa)).collect();
    let mut lines = vec![Series::new("", Mark::Rings, unstable)];
    if let Some(solids) = &studied.solids {
        lines.push(Series::new("", Mark::Line, boundary(solids)));
    }
    let below = if studied.solids.is_some() { "; below the line walls give way (solids)" } else { "" };
    let field = Field {
        subtitle: format!("rings: unstable; empty: no equilibrium found{below}"),
        patches: patches.collect(),
        lines,
        equal_axes: false,
        ..Field::new(
            format!("{name}: bow over both pressures, simulated"),
            "pressure of the diagonal pair (kPa)",
            "pressure of the idle pair (kPa)",
            "bow (mm)",
        )
    };
    findings.figures.push((
        stems[1],
        field.into(),
        "Each block is one computed state, followed along its row from the left.".into(),
    ));
    if let Some(solids) = &studied.solids {
        mode(studied, solids, stems[2], findings);
    }
}

/// Least idle pressures over the case's, kPa: from where none is needed.
fn boundary(solids: &StudiedSolids) -> Vec<(f64, f64)> {
    let start = solids.critical_kpa().map(|[below, _]| (below, 0.0));
    let needed = solids.least.iter().filter_map(|(kpa, least)| match least {
        IdlePressure::Least(idle) => Some((*kpa, idle / KPA)),
        _ => None,
    });
    start.into_iter().chain(needed).collect()
}

/// The surface of the FREE that a mode moves most, unrolled.
fn mode(studied: &Studied, solids: &StudiedSolids, stem: &'static str, findings: &mut Findings) {
    let most = |lines: &Vec<Vec<Bulge>>| {
        lines.iter().flatten().map(|bulge| bulge.outwards.abs()).fold(0.0, f64::max)
    };
    let frees = solids.rise.bulges.iter().enumerate();
    let Some((free, lines)) = frees.max_by(|(_, a), (_, b)| most(a).total_cmp(&most(b))) else { return };
    let Some([below, by]) = solids.critical_kpa() else { return };
    let mut patches = vec![];
    for (j, line) in lines.iter().enumerate() {
        let beside = &lines[(j + 1) % lines.len()];
        for (pair, other) in line.windows(2).zip(beside.windows(2)) {
            let corners = [pair[0], pair[1], other[1], other[0]];
            // Next to each other, wherever the lines began, and within the first turn.
            let near = |angle: f64, to: f64| angle - 360.0 * ((angle - to) / 360.0).round();
            let first = (corners[0].around / DEG).rem_euclid(360.0);
            let place = |bulge: Bulge| (bulge.along / MM, near(bulge.around / DEG, first));
            let value = 0.25 * corners.iter().map(|bulge| bulge.outwards).sum::<f64>();
            patches.push(Patch { corners: corners.map(place), value });
        }
    }
    let field = Field {
        subtitle: format!("FREE {}, idle; case 2, no ties, {below:.1} to {by:.1} kPa", free + 1),
        patches,
        equal_axes: false,
        ..Field::new(
            format!("{}: how the wall gives way, simulated", studied.kind.name),
            "along the tube (mm)",
            "around it (°)",
            "motion outwards, greatest motion 1",
        )
    };
    let caption =
        "The buckling mode of the solids on the outer surface of the FREE that it moves most, unrolled.";
    findings.figures.push((stem, field.into(), caption.into()));
}
