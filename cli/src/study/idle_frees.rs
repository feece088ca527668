//! Fig. 13: do the idle FREEs of a diagonal pair under pressure buckle, and what prevents it?

use super::{
    bench::{Bench, steps},
    findings::{Curves, Findings, Grid, Titled},
    idle_claims::judge,
    idle_pictures::figures,
    module_rods::{GREATEST_KPA, Kind, READINGS, SPACING_MM},
    module_solids::{SolidRise, least_idle, rise, with_idle},
};
use crate::{exit::Exit, failure::Failure, interrupt};
use actuator::{
    Case, ModuleState,
    units::{DEG, KPA, MM},
};
use fe::{Buckling, IdlePressure, RodError, RodSettings};
use nalgebra::Vector3;

/// To which a pressure of buckling is found, Pa.
const TOLERANCE: f64 = 20.0;
/// Greatest idle pressure that is tried, as a share of the case's.
const MOST_IDLE: f64 = 0.3;

/// A module's state with pressure in the diagonal pair and in the idle FREEs.
pub struct Node {
    pub case_kpa: f64,
    pub idle_kpa: f64,
    pub found: Option<Shape>,
}

/// How it stands.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Greatest distance of an idle FREE's centreline from the line between its ends, mm.
    pub bow: f64,
    pub twist: f64,
    pub rise: f64,
    pub gap: f64,
    pub unstable: bool,
}

/// A module without ties in case 2.
pub struct Studied {
    pub kind: &'static Kind,
    pub buckling: Option<Buckling>,
    /// Why the path ended before the greatest pressure.
    pub ended: Option<String>,
    /// Least idle pressure by the case's (kPa); `None` where there is no equilibrium from rest.
    pub least: Vec<(f64, Option<IdlePressure>)>,
    pub nodes: Vec<Node>,
    /// The same as solids.
    pub solids: Option<StudiedSolids>,
}

/// A module of solids without ties in case 2.
pub struct StudiedSolids {
    pub rise: SolidRise,
    /// Least idle pressure by the case's (kPa).
    pub least: Vec<(f64, IdlePressure)>,
}

impl Studied {
    /// States without idle pressure.
    pub fn bare(&self) -> impl Iterator<Item = (f64, Shape)> + '_ {
        self.nodes
            .iter()
            .filter(|node| node.idle_kpa == 0.0)
            .filter_map(|node| Some((node.case_kpa, node.found?)))
    }
}

impl StudiedSolids {
    /// Stable states without idle pressure.
    pub fn bare(&self) -> impl Iterator<Item = (f64, Shape)> + '_ {
        let case = case();
        let states = self.rise.states.iter();
        states.map(move |found| {
            let shape = shape(&found.centrelines, &case, self.rise.rest_height, &found.state);
            (found.pressure_kpa, shape)
        })
    }

    /// Pressures (kPa) up to which it is stable and by which it is not.
    pub fn critical_kpa(&self) -> Option<[f64; 2]> {
        let buckling = self.rise.buckling.as_ref()?;
        let most = |pressures: &[f64]| pressures.iter().copied().fold(0.0, f64::max) / KPA;
        Some([most(buckling.below.shape.pressures()), most(&buckling.by)])
    }
}

/// The diagonal pair: the same FREEs whatever their angle and spacing.
fn case() -> Case {
    Case::all(&READINGS[0].module(SPACING_MM, 0)).swap_remove(1)
}

fn lost(error: RodError) -> Failure {
    Failure::new(Exit::NotConverged, error)
}

/// Of the idle FREEs of a case, by the centrelines (m) of all.
fn shape(lines: &[Vec<[f64; 3]>], case: &Case, rest_height: f64, state: &ModuleState) -> Shape {
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
        twist: state.chart.twist / DEG,
        rise: (state.chart.position[2] - rest_height) / MM,
        gap: state.gap.map_or(f64::NAN, |gap| gap / MM),
        unstable: state.is_buckled(),
    }
}

fn study(bench: &Bench, kind: &'static Kind) -> Result<Studied, Failure> {
    let module = kind.module(SPACING_MM, 0);
    let rods = bench.rods(&module, RodSettings::default())?;
    let case = case();
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
                    Some(shape(&last.configuration.centrelines(&rods), &case, height, &last.state))
                }
                Err(_) => None,
            };
            nodes.push(Node { case_kpa: pressure / KPA, idle_kpa: idle / KPA, found });
        }
        Ok(nodes)
    })?;
    let least = bench.each("least idle pressure", &tried(bench), |pressure| {
        let found = rods.least_idle_pressure(&with_idle(&case, *pressure, 0.0), MOST_IDLE * pressure, 50.0);
        Ok((pressure / KPA, found.ok()))
    })?;
    let nodes = columns.into_iter().flatten().collect();
    Ok(Studied { kind, buckling, ended, least, nodes, solids: None })
}

/// Pressures (Pa) of the case for which the least idle pressure is sought.
fn tried(bench: &Bench) -> Vec<f64> {
    steps(GREATEST_KPA, if bench.coarse { 2 } else { 5 })
}

/// Adds the same by solids.
fn add_solids(bench: &Bench, studied: &mut [Studied]) -> Result<(), Failure> {
    let tolerance = if bench.coarse { 1e3 } else { 100.0 };
    let rises = rise(bench, &READINGS, tolerance)?;
    for (studied, rise) in studied.iter_mut().zip(rises) {
        studied.solids = Some(StudiedSolids { rise, least: vec![] });
    }
    // Below where it buckles none is needed.
    let needs = |studied: &Studied, pressure: f64| {
        let critical = studied.solids.as_ref().and_then(StudiedSolids::critical_kpa);
        critical.is_some_and(|[below, _]| pressure > below * KPA)
    };
    let all: Vec<(usize, f64)> =
        (0..studied.len()).flat_map(|place| tried(bench).into_iter().map(move |p| (place, p))).collect();
    let wanted: Vec<(usize, f64)> =
        all.iter().copied().filter(|(place, pressure)| needs(&studied[*place], *pressure)).collect();
    let asked: Vec<(&'static Kind, f64)> =
        wanted.iter().map(|(place, pressure)| (studied[*place].kind, *pressure)).collect();
    let found = least_idle(bench, &asked, MOST_IDLE)?;
    for (place, pressure) in all {
        let known = wanted.iter().zip(&found).find(|(wanted, _)| **wanted == (place, pressure));
        let least = known.map_or(IdlePressure::NotNeeded, |(_, least)| *least);
        if let Some(solids) = &mut studied[place].solids {
            solids.least.push((pressure / KPA, least));
        }
    }
    Ok(())
}

/// An idle pressure in words, kPa.
fn in_words(least: Option<IdlePressure>, case_kpa: f64) -> String {
    match least {
        Some(IdlePressure::NotNeeded) => "stable without".to_owned(),
        Some(IdlePressure::Least(idle)) => format!("{:.2}", idle / KPA),
        Some(IdlePressure::NeverEnough) => format!("unstable up to {:.1}", MOST_IDLE * case_kpa),
        None => "no equilibrium from rest".to_owned(),
    }
}

/// Computes it.
pub fn compute(bench: &Bench) -> Result<Findings, Failure> {
    for kind in &READINGS {
        bench.rod_law(kind.angle_deg)?;
    }
    let mut studied = READINGS.iter().map(|kind| study(bench, kind)).collect::<Result<Vec<_>, _>>()?;
    if bench.solids {
        add_solids(bench, &mut studied)?;
    }
    let mut findings = Findings { setup: setup(bench), ..Findings::default() };
    judge(&studied, &mut findings);
    findings.tables.extend([bows(&studied), least(&studied)]);
    for studied in &mut studied {
        figures(studied, &mut findings);
        if let Some(solids) = &mut studied.solids
            && !solids.rise.grid.is_empty()
        {
            let name = format!("fig13-{}-buckling.vtu", stem(studied.kind));
            findings.grids.push(Grid { name, bytes: std::mem::take(&mut solids.rise.grid) });
        }
    }
    findings.curves.push(curves(&studied));
    Ok(findings)
}

/// What files of a reading are called by.
pub fn stem(kind: &Kind) -> &'static str {
    if kind.angle_deg > 45.0 { "hoop" } else { "axis" }
}

fn bows(studied: &[Studied]) -> Titled {
    let mut table = Titled::new(
        "Case 2 without ties and without idle pressure: idle FREEs",
        ["<reading", "<as", "kPa", "bow (mm)", "twist (°)", "along (mm)", "least gap (mm)", "<equilibrium"],
    );
    for studied in studied {
        let row = |model: &str, (pressure, shape): (f64, Shape)| {
            vec![
                studied.kind.name.into(),
                model.into(),
                format!("{pressure:.1}"),
                format!("{:.2}", shape.bow),
                format!("{:+.1}", shape.twist),
                format!("{:+.2}", shape.rise),
                format!("{:.2}", shape.gap),
                if shape.unstable { "unstable" } else { "stable" }.into(),
            ]
        };
        let every = studied.bare().count().div_ceil(5).max(1);
        let shown = |place: usize| (place + 1).is_multiple_of(every);
        let rods: Vec<_> =
            studied.bare().enumerate().filter(|(place, _)| shown(*place)).map(|(_, state)| state).collect();
        table.rows.extend(rods.iter().map(|state| row("rods", *state)));
        let Some(solids) = &studied.solids else { continue };
        let last = solids.bare().count().saturating_sub(1);
        let alike = |kpa: f64| rods.iter().any(|(other, _)| (other - kpa).abs() < 1e-6);
        let solids = solids.bare().enumerate().filter(|(place, (kpa, _))| *place == last || alike(*kpa));
        table.rows.extend(solids.map(|(_, state)| row("solids", state)));
    }
    table
}

fn least(studied: &[Studied]) -> Titled {
    let mut table = Titled::new(
        "Least pressure in the idle FREEs that keeps the module stable",
        ["<reading", "case (kPa)", "rods: idle (kPa)", "solids: idle (kPa)"],
    );
    for studied in studied {
        for (place, (kpa, by_rods)) in studied.least.iter().enumerate() {
            let solids = studied.solids.as_ref().and_then(|solids| solids.least.get(place));
            table.rows.push(vec![
                studied.kind.name.into(),
                format!("{kpa:.1}"),
                in_words(*by_rods, *kpa),
                solids
                    .map_or_else(|| "not computed".into(), |(_, by_solids)| in_words(Some(*by_solids), *kpa)),
            ]);
        }
    }
    table
}

fn curves(studied: &[Studied]) -> Curves {
    let head = vec![
        "angle_from_hoop_deg",
        "model",
        "case_kpa",
        "idle_kpa",
        "bow_mm",
        "twist_deg",
        "rise_mm",
        "gap_mm",
        "unstable",
    ];
    let mut rows = vec![];
    for studied in studied {
        let mut add = |model: &str, case_kpa: f64, idle_kpa: f64, found: Option<Shape>| {
            let mut row: Vec<String> = vec![studied.kind.angle_deg.to_string(), model.into()];
            row.extend([case_kpa, idle_kpa].map(|kpa| format!("{kpa:.4}")));
            row.extend(found.map_or_else(
                || vec![String::new(); 5],
                |shape| {
                    let numbers =
                        [shape.bow, shape.twist, shape.rise, shape.gap].map(|number| format!("{number:.6}"));
                    numbers.into_iter().chain([u8::from(shape.unstable).to_string()]).collect()
                },
            ));
            rows.push(row);
        };
        for node in &studied.nodes {
            add("rods", node.case_kpa, node.idle_kpa, node.found);
        }
        for (kpa, shape) in studied.solids.iter().flat_map(StudiedSolids::bare) {
            add("solids", kpa, 0.0, Some(shape));
        }
    }
    Curves { stem: "fig13-idle".into(), head, rows }
}

fn setup(bench: &Bench) -> Vec<String> {
    let rods = format!(
        "Simulated by rods without ties, {SPACING_MM} mm apart: case 2, a diagonal pair under pressure to {GREATEST_KPA} kPa, with 0 to {:.0} % of that \
         in the idle pair. Buckling is the first change of sign of the tangent's inertia on the way from rest, to {TOLERANCE} Pa. Bow is the greatest \
         distance of an idle FREE's centreline from the line between its ends.",
        100.0 * MOST_IDLE
    );
    let limits = "Rods know neither contact between FREEs (a negative gap tells where it would be) nor changes of a section's shape: a tube that flattens or \
                  wrinkles under twist is not seen.";
    if !bench.solids {
        return vec![
            rods,
            format!("{limits} Solids see the walls: --solids computes these states with them too."),
        ];
    }
    let solids = "Solids see the walls: every FREE a whole tube of finite elements with threads 0.15 mm wide, the plate with all its freedom. Buckling is where the first \
                  eigenvalue of the whole passes zero, or where walls snap and the pose jumps, found to 0.1 kPa; the least idle pressure is where that happens \
                  as the idle pressure falls from 30 % of the case's. Solids do not touch each other either.";
    vec![
        rods,
        limits.into(),
        if bench.coarse { format!("{solids} Coarse: to 1 kPa.") } else { solids.into() },
    ]
}
