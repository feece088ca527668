//! Fig. 13: do the idle FREEs of a diagonal pair under pressure buckle, and what prevents it?

use super::{
    bench::{Bench, steps},
    findings::{Curves, Finding, Findings, Titled, Verdict},
    module_rods::{GREATEST_KPA, Kind, READINGS, SPACING_MM},
};
use crate::{
    case::{Case, cases},
    exit::Exit,
    failure::Failure,
    interrupt,
    plot::{Chart, Field, Mark, Patch, Series},
};
use actuator::units::{DEG, KPA, MM};
use fe::{Buckling, Equilibrium, IdlePressure, RodError, RodModule, RodSettings};
use nalgebra::Vector3;

/// To which a pressure of buckling is found, Pa.
const TOLERANCE: f64 = 20.0;
/// Greatest idle pressure that is tried, as a share of the case's.
const MOST_IDLE: f64 = 0.3;

/// A module's state with pressure in the diagonal pair and in the idle FREEs.
struct Node {
    case_kpa: f64,
    idle_kpa: f64,
    found: Option<Shape>,
}

/// How it stands.
#[derive(Clone, Copy)]
struct Shape {
    /// Greatest distance of an idle FREE's centreline from the line between its ends, mm.
    bow: f64,
    twist: f64,
    rise: f64,
    gap: f64,
    unstable: bool,
}

/// A module without ties in case 2.
struct Studied {
    kind: &'static Kind,
    buckling: Option<Buckling>,
    /// Why the path ended before the greatest pressure.
    ended: Option<String>,
    /// Least idle pressure (kPa) by the case's.
    least: Vec<(f64, String)>,
    nodes: Vec<Node>,
}

impl Studied {
    /// States without idle pressure.
    fn bare(&self) -> impl Iterator<Item = (f64, Shape)> + '_ {
        self.nodes
            .iter()
            .filter(|node| node.idle_kpa == 0.0)
            .filter_map(|node| Some((node.case_kpa, node.found?)))
    }
}

fn lost(error: RodError) -> Failure {
    Failure::new(Exit::NotConverged, error)
}

/// Of the idle FREEs of a case.
fn shape(rods: &RodModule, case: &Case, rest_height: f64, found: &Equilibrium) -> Shape {
    let lines = found.configuration.centrelines(rods);
    let bow = |line: &Vec<[f64; 3]>| -> f64 {
        let line: Vec<Vector3<f64>> = line.iter().copied().map(Vector3::from).collect();
        let (Some(first), Some(last)) = (line.first(), line.last()) else { return 0.0 };
        let along = last - first;
        let off = |at: &Vector3<f64>| (at - first).cross(&along).norm() / along.norm();
        line.iter().map(off).fold(0.0, f64::max)
    };
    let idle = lines.iter().zip(&case.inflated).filter(|(_, inflated)| !**inflated);
    Shape {
        bow: idle.map(|(line, _)| bow(line)).fold(0.0, f64::max) / MM,
        twist: found.state.chart.twist / DEG,
        rise: (found.state.chart.position[2] - rest_height) / MM,
        gap: found.state.gap.map_or(f64::NAN, |gap| gap / MM),
        unstable: found.state.negative_pivots > 0,
    }
}

/// Pressures of the case with some in its idle FREEs, Pa.
fn with_idle(case: &Case, pressure: f64, idle: f64) -> Vec<f64> {
    case.pressures(&[idle; 4], &[pressure; 4], 1.0)
}

fn study(bench: &Bench, kind: &'static Kind) -> Result<Studied, Failure> {
    let module = kind.module(SPACING_MM, 0);
    let rods = bench.rods(&module, RodSettings::default())?;
    let case = cases(&module).swap_remove(1);
    let rest = rods.rest().map_err(lost)?;
    let height = rest.state.chart.position[2];
    let greatest = GREATEST_KPA * KPA;
    let (buckling, ended) = match rods.first_buckling(&rest, &with_idle(&case, greatest, 0.0), TOLERANCE) {
        Ok(buckling) => (buckling, None),
        Err(error) => (None, Some(error.to_string())),
    };
    let pressures = steps(GREATEST_KPA, if bench.coarse { 4 } else { 20 });
    let idles: Vec<f64> = (0..if bench.coarse { 3 } else { 7 }).map(f64::from).collect();
    let share = |index: f64| index / (idles.len() - 1) as f64;
    let columns = bench.each(&format!("Fig. 13: {}", kind.name), &idles, |index| {
        // The same idle pressure all along, from rest.
        let idle = share(*index) * MOST_IDLE * greatest;
        let mut last = rods.solve(&[idle; 4]).map_err(lost)?;
        let mut nodes = vec![];
        for pressure in &pressures {
            if interrupt::is_asked() {
                return Err(Failure::interrupted());
            }
            let goal = with_idle(&case, *pressure, idle);
            let found = match rods.solve_from(&last, &goal) {
                Ok(found) => {
                    last = found;
                    Some(shape(&rods, &case, height, &last))
                }
                Err(_) => None,
            };
            nodes.push(Node { case_kpa: pressure / KPA, idle_kpa: idle / KPA, found });
        }
        Ok(nodes)
    })?;
    let tried = steps(GREATEST_KPA, if bench.coarse { 2 } else { 5 });
    let least = bench.each("least idle pressure", &tried, |pressure| {
        let found = rods.least_idle_pressure(&with_idle(&case, *pressure, 0.0), MOST_IDLE * pressure, 50.0);
        Ok((
            pressure / KPA,
            match found {
                Ok(IdlePressure::NotNeeded) => "stable without".to_owned(),
                Ok(IdlePressure::Least(idle)) => format!("{:.2}", idle / KPA),
                Ok(IdlePressure::NeverEnough) => format!("unstable up to {:.1}", MOST_IDLE * pressure / KPA),
                Err(_) => "no equilibrium from rest".to_owned(),
            },
        ))
    })?;
    Ok(Studied { kind, buckling, ended, least, nodes: columns.into_iter().flatten().collect() })
}

/// Computes it.
pub fn compute(bench: &Bench) -> Result<Findings, Failure> {
    for kind in &READINGS {
        bench.rod_law(kind.angle_deg)?;
    }
    let studied = READINGS.iter().map(|kind| study(bench, kind)).collect::<Result<Vec<_>, _>>()?;
    let mut findings = Findings { setup: setup(), ..Findings::default() };
    judge(&studied, &mut findings);
    let mut table = Titled::new(
        "Case 2 without ties and without idle pressure: idle FREEs",
        ["<reading", "kPa", "bow (mm)", "twist (°)", "along (mm)", "least gap (mm)", "<equilibrium"],
    );
    let mut idle = Titled::new(
        "Least pressure in the idle FREEs that keeps the module stable",
        ["<reading", "case (kPa)", "idle (kPa)"],
    );
    let mut rows = vec![];
    for studied in &studied {
        let every = studied.bare().count().div_ceil(5).max(1);
        for (place, (pressure, shape)) in studied.bare().enumerate() {
            if (place + 1) % every == 0 {
                table.rows.push(vec![
                    studied.kind.name.into(),
                    format!("{pressure:.1}"),
                    format!("{:.2}", shape.bow),
                    format!("{:+.1}", shape.twist),
                    format!("{:+.2}", shape.rise),
                    format!("{:.2}", shape.gap),
                    if shape.unstable { "unstable" } else { "stable" }.into(),
                ]);
            }
        }
        let each = studied.least.iter();
        idle.rows.extend(
            each.map(|(kpa, told)| vec![studied.kind.name.into(), format!("{kpa:.1}"), told.clone()]),
        );
        for node in &studied.nodes {
            let mut row: Vec<String> = vec![studied.kind.angle_deg.to_string()];
            row.extend([node.case_kpa, node.idle_kpa].map(|kpa| format!("{kpa:.4}")));
            row.extend(node.found.map_or_else(
                || vec![String::new(); 5],
                |shape| {
                    let numbers =
                        [shape.bow, shape.twist, shape.rise, shape.gap].map(|number| format!("{number:.6}"));
                    numbers.into_iter().chain([u8::from(shape.unstable).to_string()]).collect()
                },
            ));
            rows.push(row);
        }
        figures(studied, &mut findings);
    }
    findings.tables.extend([table, idle]);
    let head = vec![
        "angle_from_hoop_deg",
        "case_kpa",
        "idle_kpa",
        "bow_mm",
        "twist_deg",
        "rise_mm",
        "gap_mm",
        "unstable",
    ];
    findings.curves.push(Curves { stem: "fig13-idle".into(), head, rows });
    Ok(findings)
}

fn setup() -> Vec<String> {
    vec![
        format!(
            "Simulated by rods without ties, {SPACING_MM} mm apart: case 2, a diagonal pair under pressure to {GREATEST_KPA} kPa, with 0 to {:.0} % of that \
             in the idle pair. Buckling is the first change of sign of the tangent's inertia on the way from rest, to {TOLERANCE} Pa. Bow is the greatest \
             distance of an idle FREE's centreline from the line between its ends.",
            100.0 * MOST_IDLE
        ),
        "Rods know neither contact between FREEs (a negative gap tells where it would be) nor changes of a section's shape: a tube that flattens or \
         wrinkles under twist is not seen. That is for the solid module, which has not checked these states yet."
            .into(),
    ]
}

/// Which FREEs a mode moves, by its shifts of the inflated and the idle ones.
fn mode_in_words(buckling: &Buckling) -> String {
    let shifts: Vec<String> = buckling.mode.shifts().iter().map(|shift| format!("{shift:.2}")).collect();
    let [x, y, _] = buckling.mode.tip_shift;
    format!("shifts of FREEs 1 to 4 {}, of the tip {:.2}", shifts.join(", "), x.hypot(y))
}

fn judge(studied: &[Studied], findings: &mut Findings) {
    let each = |told: &dyn Fn(&Studied) -> String| {
        studied
            .iter()
            .map(|studied| format!("{}: {}", studied.kind.name, told(studied)))
            .collect::<Vec<_>>()
            .join("; ")
    };
    let bowed = |studied: &Studied| match studied.bare().last() {
        None => String::new(),
        Some((kpa, shape)) => {
            let touch = studied.bare().find(|(_, shape)| shape.gap < 0.0);
            let touch = touch.map_or_else(String::new, |(kpa, shape)| {
                format!(", FREEs in each other's way from {kpa:.1} kPa ({:+.0}° of twist)", shape.twist)
            });
            format!("bow {:.1} mm at {kpa:.0} kPa{touch}", shape.bow)
        }
    };
    let any = studied.iter().any(|studied| studied.buckling.is_some());
    findings.findings.push(Finding {
        row: "P12",
        claim: "case 2 of the 60 LR: the two idle FREEs buckle",
        ours: each(&|studied: &Studied| {
            let buckled = match (&studied.buckling, &studied.ended) {
                (Some(buckling), _) => {
                    let pressures = &buckling.above.pressures;
                    let at = pressures.iter().fold(0.0f64, |most, pressure| most.max(*pressure));
                    format!("buckles at {:.2} kPa ({})", at / KPA, mode_in_words(buckling))
                }
                (None, Some(error)) => format!("no buckling before the path ends ({error})"),
                (None, None) => "no buckling to 50 kPa".into(),
            };
            format!("{buckled}, {}", bowed(studied))
        }),
        verdict: if any { Verdict::Holds } else { Verdict::CannotBeJudged },
        reason: match any {
            true => "the tangent loses its stability on the way".into(),
            false => "as rods they do not: the plate's turn inclines them, so that they bow from the start, in the one equilibrium there is, and run into \
                      the others. What the paper saw may be that bow, contact, or a tube that collapses under twist, which rods do not know"
                .into(),
        },
    });
    let smaller = |studied: &Studied| {
        let most = studied.nodes.iter().map(|node| node.case_kpa).fold(0.0, f64::max);
        let told = studied
            .nodes
            .iter()
            .filter(|node| node.case_kpa == most)
            .filter_map(|node| Some(format!("{:.1} mm with {:.1} kPa", node.found?.bow, node.idle_kpa)));
        format!("bow at {most:.0} kPa {}", told.collect::<Vec<_>>().join(", "))
    };
    findings.findings.push(Finding {
        row: "P12",
        claim: "a small pressure in them prevents it",
        ours: each(&smaller),
        verdict: if any { Verdict::of(studied.iter().all(prevented)) } else { Verdict::CannotBeJudged },
        reason: match any {
            true => "least idle pressures are in the table".into(),
            false if studied.iter().all(grows) => {
                "there is no buckling to prevent in rods, and idle pressure does not lessen the bow but adds to it: the idle FREEs turn and stretch by their own \
                 pressure, against the plates"
                    .into()
            }
            false => "there is no buckling to prevent in rods; how idle pressure changes the bow is the map".into(),
        },
    });
}

/// Whether the bow under the greatest pressure grows with the idle pressure.
fn grows(studied: &Studied) -> bool {
    let most = studied.nodes.iter().map(|node| node.case_kpa).fold(0.0, f64::max);
    let last =
        studied.nodes.iter().filter(|node| node.case_kpa == most).filter_map(|node| Some(node.found?.bow));
    last.collect::<Vec<_>>().windows(2).all(|pair| pair[1] >= pair[0])
}

/// Whether idle pressure keeps a module stable wherever it would not be.
fn prevented(studied: &Studied) -> bool {
    studied.least.iter().all(|(_, told)| told == "stable without" || told.parse::<f64>().is_ok())
}

fn figures(studied: &Studied, findings: &mut Findings) {
    let stems = match studied.kind.angle_deg > 45.0 {
        true => ["fig13-hoop-bow", "fig13-hoop-idle"],
        false => ["fig13-axis-bow", "fig13-axis-idle"],
    };
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
    let field = Field {
        subtitle: "rings: unstable; empty: no equilibrium found".into(),
        patches: patches.collect(),
        lines: vec![Series::new("", Mark::Rings, unstable)],
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
}
