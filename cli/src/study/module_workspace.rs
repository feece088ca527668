//! Figs. 11 and 12: what the tip of the 60 LR reaches.

use super::{
    bench::Bench,
    findings::{Finding, Findings, Titled, Verdict},
    module_rods::{GREATEST_KPA, Kind, READINGS, SPACING_MM, TIED, sweep},
    spacing,
};
use crate::{
    exit::Exit,
    failure::Failure,
    interrupt,
    workspace_report::{CUBE, Track, areas, failure, pictures, tracks},
};
use actuator::{
    Limits,
    units::{KPA, MM},
};
use control::{Bounds, ReachRun, ReachSettings, ReachableSet, scattered_pressures};
use fe::{Run, Shard};
use rom::{ModuleModel, PoseModel, recommended_pressure_nodes};

/// Pairs of reached points whose middles are looked for.
const PAIRS: usize = 5000;

/// The reachable set of one reading of the module.
struct Reached {
    kind: &'static Kind,
    bounds: Bounds,
    /// Steps of a pressure, cells of the lattice, volume (m^3), each finer than the one before.
    levels: Vec<(usize, usize, f64)>,
    set: ReachableSet,
    tracks: Vec<Track>,
    /// Of the middles between reached points, how many are not reached.
    hollow: usize,
    /// Worst error of the spline on states that it never saw, m.
    model_error: f64,
    buckled: u64,
}

/// Computes it.
pub fn compute(bench: &Bench) -> Result<Findings, Failure> {
    let mut findings = Findings { setup: setup(bench), ..Findings::default() };
    spacing::judge(bench, &mut findings)?;
    let mut table = Titled::new(
        "Reachable set from all pressures to 50 kPa, tied",
        [
            "<reading",
            "steps, cells",
            "volume (cm³)",
            "x, y (mm)",
            "z (mm)",
            "greatest sideways reach (mm)",
            "boundary from singular pressures (%)",
        ],
    );
    let mut reached = vec![];
    for kind in READINGS.iter().take(if bench.coarse { 1 } else { 2 }) {
        let found = reach(bench, kind)?;
        for (steps, cells, volume) in &found.levels {
            let last = *steps == found.levels.last().map_or(0, |level| level.0);
            let ends = |axis: usize| {
                let (low, high) = found.set.extent[axis];
                format!("{:.1} to {:.1}", low / MM, high / MM)
            };
            let told = |text: String| if last { text } else { String::new() };
            table.rows.push(vec![
                found.kind.name.into(),
                format!("{steps}, {cells}"),
                format!("{:.3}", volume / CUBE / 1e3),
                told(ends(0)),
                told(ends(2)),
                told(format!("{:.1}", greatest_reach(&found.set) / MM)),
                told(format!("{:.0}", 100.0 * singular_share(&found.set))),
            ]);
        }
        reached.push(found);
    }
    findings.tables.push(table);
    judge(&reached, &mut findings);
    for (place, found) in reached.iter().enumerate() {
        for (stem, (_, picture)) in
            STEMS[place].into_iter().zip(pictures(&found.set, &found.tracks, found.kind.name))
        {
            let caption = "Outline of the reachable set, a cut through it, and the paper's cases.".to_owned();
            findings.figures.push((stem, picture, caption));
        }
    }
    Ok(findings)
}

/// Stems of the figures.
const STEMS: [[&str; 3]; 2] = [
    ["fig11-hoop-xy", "fig12-hoop-xz", "fig12-hoop-yz"],
    ["fig11-axis-xy", "fig12-axis-xz", "fig12-axis-yz"],
];

fn setup(bench: &Bench) -> Vec<String> {
    let bending = if bench.coarse { ", bending as bare tubes (coarse)" } else { "" };
    vec![
        format!(
            "Simulated: a map of rods over the four pressures from 0 to {GREATEST_KPA} kPa{bending}, FREEs {SPACING_MM} mm apart and tied by {TIED} \
             spacers, a spline through it, and the set of all positions that it reaches, its boundary among them."
        ),
        "The paper does not give the distance of the FREEs nor ties, and its 60° may be measured from the axis: the table of spacings computes \
         each reading, without ties, too, by following the cases."
            .into(),
    ]
}

fn outside(error: rom::OutOfDomain) -> Failure {
    Failure::new(Exit::NotConverged, error)
}

/// Map, spline and reachable set.
fn reach(bench: &Bench, kind: &'static Kind) -> Result<Reached, Failure> {
    let module = kind.module(SPACING_MM, TIED);
    let frees = module.frees.len();
    let sweep = sweep(bench);
    bench.progress.say(&format!("map of the {}", kind.name));
    let nodes = recommended_pressure_nodes(GREATEST_KPA * KPA, None, if bench.coarse { 4 } else { 7 });
    let limits = Limits {
        pressure_max: vec![GREATEST_KPA * KPA; frees],
        pressure_rate: 200.0 * KPA,
        idle_pressure: 0.0,
    };
    let failed = |error| Failure::new(Exit::NotConverged, error);
    let mut map = sweep
        .empty_map(module, limits.clone(), vec![nodes; frees], (kind.name.into(), String::new()))
        .map_err(failed)?;
    let told = |done, total| bench.progress.at(done, total);
    let run = Run { jobs: bench.jobs, progress: &told, stop: interrupt::flag() };
    sweep.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).map_err(failed)?;
    if interrupt::is_asked() {
        return Err(Failure::interrupted());
    }
    let model = ModuleModel::fit(&map).map_err(|error| Failure::new(Exit::NotConverged, error))?;
    let bounds = Bounds::new(model.domain(), &limits, model.limit_pressures(), 0.0)
        .map_err(|error| Failure::refused(error.to_string()))?;
    bench.progress.say(&format!("reachable set of the {}", kind.name));
    let (mut levels, mut last) = (vec![], None);
    for (steps, cells) in if bench.coarse { [(2, 12), (4, 24)] } else { [(8, 32), (16, 64)] } {
        let run = ReachRun { progress: &told, is_stopped: &interrupt::is_asked };
        let settings = ReachSettings { steps, cells, jobs: bench.jobs };
        let set = ReachableSet::compute(&|| &model, &bounds, settings, &run).map_err(failure)?;
        levels.push((steps, cells, set.volume()));
        last = Some(set);
    }
    let set = last.ok_or_else(Failure::interrupted)?;
    let points = control::positions(&model, &scattered_pressures(&bounds, 2 * PAIRS)).map_err(outside)?;
    let middles: Vec<[f64; 3]> = points
        .chunks_exact(2)
        .map(|pair| std::array::from_fn(|axis| 0.5 * (pair[0][axis] + pair[1][axis])))
        .collect();
    Ok(Reached {
        kind,
        hollow: set.count_missed(middles.iter()),
        model_error: model.errors().position.worst,
        buckled: model.unstable_nodes(),
        tracks: tracks(&map.module, &model, &bounds).map_err(outside)?,
        bounds,
        levels,
        set,
    })
}

fn greatest_reach(set: &ReachableSet) -> f64 {
    set.sideways.reaches().filter_map(|(_, reach)| reach).map(|(reach, _)| reach).fold(0.0, f64::max)
}

/// Share of the boundary's area that comes from pressures between their limits.
fn singular_share(set: &ReachableSet) -> f64 {
    let areas = areas(&set.surface(), 4);
    let sum =
        |least: usize| -> f64 { areas.iter().filter(|(free, _)| *free >= least).map(|(_, area)| area).sum() };
    sum(3) / sum(0)
}

fn judge(reached: &[Reached], findings: &mut Findings) {
    let each = |told: &dyn Fn(&Reached) -> String| {
        reached
            .iter()
            .map(|found| format!("{}: {}", found.kind.name, told(found)))
            .collect::<Vec<_>>()
            .join("; ")
    };
    let volume = |found: &Reached| {
        let [.., (_, _, coarse), (_, _, fine)] = &found.levels[..] else { return String::new() };
        format!(
            "{:.2} ± {:.2} cm³ to {:.1} kPa",
            fine / CUBE / 1e3,
            (fine - coarse).abs() / CUBE / 1e3,
            found.bounds.upper[0] / KPA
        )
    };
    findings.findings.push(Finding {
        row: "P11",
        claim: "the reachable set is concave",
        ours: each(&|found: &Reached| {
            format!("{:.1} % of the middles between two reached points are not reached", 100.0 * found.hollow as f64 / PAIRS as f64)
        }),
        verdict: Verdict::of(reached.first().is_some_and(|found| found.hollow as f64 > 0.01 * PAIRS as f64)),
        reason: "a convex set holds the middle between any two of its points; counted are middles more than a cell of the lattice outside. Judged is the first reading".into(),
    });
    findings.findings.push(Finding {
        row: "P11",
        claim: "a boundary interpolated between the cases bounds the set",
        ours: each(&|found: &Reached| {
            format!("volume {}, {:.0} % of the boundary from pressures between their limits", volume(found), 100.0 * singular_share(&found.set))
        }),
        verdict: Verdict::CannotBeJudged,
        reason: format!(
            "the paper's boundary is not available as numbers. Ours is computed from all pressures; the spline is within {} of rods at states \
             that it never saw, {} nodes are buckled",
            reached.iter().map(|found| format!("{:.2} mm", found.model_error / MM)).collect::<Vec<_>>().join(" and "),
            reached.iter().map(|found| found.buckled.to_string()).collect::<Vec<_>>().join(" and ")
        ),
    });
}
