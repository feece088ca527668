//! Fig. 5: the tube pulled by 2 mm without pressure, with fibres that are trusses or beams.

use super::{
    bench::{Bench, failure, mesh_name},
    findings::{Curves, Finding, Findings, Grid, Picture, Titled, Verdict},
    specimen::free,
};
use crate::{
    failure::Failure,
    interrupt,
    plot::{Chart, Mark, Series},
};
use actuator::units::MM;
use fe::{CriticalPoint, FibreModel, SolidLoad, SolidMesh, SolidPath, SolidSolver, SolidState, Specimen};

/// Extension of the claim, mm.
const GREATEST_MM: f64 = 2.0;
/// To which a critical extension is found, mm.
const TOLERANCE_MM: f64 = 0.02;
/// Diameter of a fibre as a beam, m: the paper gives none.
const DIAMETER: f64 = 0.3 * MM;

struct Case {
    angle_deg: f64,
    model: FibreModel,
    mesh: SolidMesh,
}

/// What an extension came to.
struct Pulled {
    solver: SolidSolver,
    /// Extension (mm), negative eigenvalues, eigenvalue next to zero.
    path: Vec<(f64, usize, f64)>,
    critical: Option<CriticalPoint>,
}

impl Case {
    fn fibre(&self) -> &'static str {
        if self.model == FibreModel::Beam { "beam, 0.3 mm" } else { "truss" }
    }

    /// Pulls the caps apart, which cannot turn, until an eigenvalue of the tangent has changed its sign.
    fn pull(&self) -> Result<Pulled, Failure> {
        let diameter = if self.model == FibreModel::Beam { DIAMETER } else { 0.0 };
        let specimen =
            Specimen { fibre_model: self.model, ..Specimen::from(&free(self.angle_deg, diameter)) };
        // The whole tube: a mode need not be the same in each sector.
        let mut solver = SolidSolver::new(&specimen, self.mesh).map_err(failure)?;
        let load_at = |mm: f64| SolidLoad {
            displacement: [0.0, 0.0, mm * MM].into(),
            held: [true; 6],
            ..SolidLoad::default()
        };
        let path = SolidPath::Load(&load_at);
        let (mut at, mut state): (f64, SolidState) = (0.0, solver.rest());
        let mut found = vec![];
        for stop in [0.5 * GREATEST_MM, GREATEST_MM] {
            if interrupt::is_asked() {
                return Err(Failure::interrupted());
            }
            let mut reached = None;
            let critical = solver
                .survey(&path, (at, &state), &[stop], 2, TOLERANCE_MM, false, &mut |at, state, stability| {
                    let nearest = stability.modes.first().map_or(f64::NAN, |mode| mode.value);
                    reached = Some((at, state.clone(), stability.negative, nearest));
                    true
                })
                .map_err(failure)?;
            if let Some((stop, next, negative, nearest)) = reached {
                found.push((stop, negative, nearest));
                (at, state) = (stop, next);
            }
            if let Some(critical) = critical.into_iter().next() {
                return Ok(Pulled { solver, path: found, critical: Some(critical) });
            }
        }
        Ok(Pulled { solver, path: found, critical: None })
    }
}

/// Computes it.
pub fn compute(bench: &Bench) -> Result<Findings, Failure> {
    use FibreModel::{Beam, Truss};
    let case = |angle_deg, model, radial, along| Case {
        angle_deg,
        model,
        mesh: SolidMesh { radial, ..SolidMesh::new(12, along) },
    };
    let cases = match bench.coarse {
        true => vec![case(60.0, Truss, 1, 40), case(60.0, Beam, 1, 40)],
        // The longest first.
        false => vec![
            case(60.0, Beam, 2, 60),
            case(60.0, Truss, 2, 60),
            case(20.0, Beam, 1, 90),
            case(20.0, Truss, 1, 90),
            case(45.0, Truss, 1, 60),
            case(60.0, Truss, 1, 60),
            case(60.0, Beam, 1, 60),
            case(75.0, Truss, 1, 60),
        ],
    };
    let found = bench.each("Fig. 5: extension", &cases, Case::pull)?;
    let all = || cases.iter().zip(&found);
    let told = |case: &Case, pulled: &Pulled| match &pulled.critical {
        Some(critical) => {
            format!("{:.0}° on {} at {:.2} mm", case.angle_deg, mesh_name(case.mesh), critical.at)
        }
        None => format!("{:.0}° on {} not", case.angle_deg, mesh_name(case.mesh)),
    };
    let of = |model: FibreModel| {
        let each = all().filter(|(case, _)| case.model == model).map(|(case, pulled)| told(case, pulled));
        each.collect::<Vec<_>>().join("; ")
    };
    let mut findings = Findings {
        setup: vec![
            format!(
                "Simulated by solid finite elements of the whole tube, 130 mm, no pressure: one cap held, the other moved by up to \
                 {GREATEST_MM} mm along the axis without turning. Buckling is a change of sign of an eigenvalue of the tangent, counted by \
                 its factorisation and located to {TOLERANCE_MM} mm; where none changes, buckling of the path is excluded."
            ),
            "The row of the paper's claims gives neither the winding angle nor the fibres' diameter. As beams they are round, \
             0.3 mm, clamped to the caps, of the same EA 644 N."
                .into(),
            "The critical extension is not converged: compare one and two elements through the wall in the table. Trusses without \
             width are line loads, whose effect drifts as the mesh around is refined."
                .into(),
        ],
        ..Findings::default()
    };
    let buckled = |model: FibreModel, angle: f64| {
        let same = all().filter(|(case, _)| case.model == model && case.angle_deg == angle);
        // On the mesh with most elements through the wall.
        same.max_by_key(|(case, _)| case.mesh.radial).is_some_and(|(_, pulled)| pulled.critical.is_some())
    };
    let angles = |wanted: bool| {
        let mut angles: Vec<f64> = cases.iter().map(|case| case.angle_deg).collect();
        angles.retain(|angle| buckled(Truss, *angle) == wanted);
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        let told: Vec<String> = angles.iter().map(|angle| format!("{angle:.0}°")).collect();
        if told.is_empty() { "no angle here".to_owned() } else { told.join(", ") }
    };
    findings.findings.push(Finding {
        row: "P7",
        claim: "with truss fibres the tube buckles when extended by 2 mm",
        ours: of(Truss),
        verdict: Verdict::CannotBeJudged,
        reason: format!(
            "the angle is not given and decides: buckling at {}, none at {}. Where it buckles, fibres that cannot turn the cap are \
             pulled and squeeze the tube flat",
            angles(true),
            angles(false)
        ),
    });
    let beams = buckled(Beam, 60.0);
    findings.findings.push(Finding {
        row: "P7",
        claim: "with beam fibres it does not",
        ours: of(Beam),
        verdict: Verdict::CannotBeJudged,
        reason: format!(
            "the fibres' diameter is not given; beams delay the buckling, and at 60° those of 0.3 mm {} on the finest mesh here",
            if beams { "do not prevent it" } else { "prevent it" }
        ),
    });
    let mut table = Titled::new(
        "Extension by 2 mm, caps that do not turn",
        [
            "angle (°)",
            "<fibres",
            "<elements around × along × wall",
            "negative at the end",
            "critical (mm)",
            "<kind",
        ],
    );
    let mut rows = vec![];
    for (case, pulled) in all() {
        let critical = pulled.critical.as_ref();
        table.rows.push(vec![
            format!("{:.0}", case.angle_deg),
            case.fibre().into(),
            mesh_name(case.mesh),
            pulled.path.last().map_or_else(String::new, |(_, negative, _)| negative.to_string()),
            critical.map_or_else(|| "none to 2".into(), |critical| format!("{:.2}", critical.at)),
            critical.map_or_else(String::new, |critical| format!("{:?}", critical.kind).to_lowercase()),
        ]);
        for (mm, negative, value) in &pulled.path {
            rows.push(vec![
                format!("{:.0}", case.angle_deg),
                if case.model == Beam { "beam".into() } else { "truss".into() },
                mesh_name(case.mesh).replace(" × ", "x"),
                format!("{mm:.4}"),
                negative.to_string(),
                format!("{value:.6e}"),
                critical.map_or_else(String::new, |critical| format!("{:.4}", critical.at)),
            ]);
        }
    }
    findings.tables.push(table);
    let head = vec![
        "angle_deg",
        "fibre",
        "mesh",
        "extension_mm",
        "negative_eigenvalues",
        "eigenvalue_next_to_zero",
        "critical_extension_mm",
    ];
    findings.curves.push(Curves { stem: "fig5".into(), head, rows });
    let shown = all()
        .filter(|(case, _)| case.model == Truss && case.angle_deg == 60.0)
        .max_by_key(|(case, _)| case.mesh.radial);
    if let Some((_, pulled)) = shown
        && let Some(critical) = &pulled.critical
        && let Some(mode) = critical.modes.first()
    {
        let still = pulled.solver.outer_lines(&critical.state, None);
        let moved = pulled.solver.outer_lines(&critical.state, Some((mode, 1.5 * MM)));
        let shift = |k: usize| -> f64 {
            let apart = |(a, b): (&Vec<[f64; 3]>, &Vec<[f64; 3]>)| {
                (a[k][0] - b[k][0]).powi(2) + (a[k][1] - b[k][1]).powi(2)
            };
            still.iter().zip(&moved).map(apart).sum()
        };
        let planes = still.first().map_or(0, Vec::len);
        let most = (0..planes).max_by(|a, b| shift(*a).total_cmp(&shift(*b))).unwrap_or(0);
        let ring = |lines: &[Vec<[f64; 3]>]| {
            let points =
                lines.iter().chain(lines.first()).map(|line| (line[most][0] / MM, line[most][1] / MM));
            points.collect::<Vec<_>>()
        };
        let chart = Chart {
            equal_axes: true,
            ..Chart::new("60°, trusses: cross-section that moves most, simulated", "x (mm)", "y (mm)")
        };
        let chart = chart
            .with(Series::new("critical state", Mark::Dashed, ring(&still)).coloured(6))
            .with(Series::new("mode", Mark::Line, ring(&moved)).coloured(1));
        let caption = "The buckling mode, at an amplitude chosen for the picture.".to_owned();
        findings.figures.push(("fig5-section", Picture::Chart(chart), caption));
        let mut chart = Chart {
            equal_axes: true,
            ..Chart::new("60°, trusses: buckling mode from the side, simulated", "z (mm)", "y (mm)")
        };
        // The fibres: one line of the mesh in as many as lie between them.
        let every = (moved.len() / 6).max(1);
        for line in moved.iter().step_by(every) {
            let points = line.iter().map(|at| (at[2] / MM, at[1] / MM)).collect();
            chart = chart.with(Series::new("", Mark::Line, points).coloured(1));
        }
        let caption = "The six fibres, moved along the mode.".to_owned();
        findings.figures.push(("fig5-mode", Picture::Chart(chart), caption));
        let mut bytes = vec![];
        let fields: [(&str, &[[f64; 3]]); 1] = [("buckling_mode", &mode.displacements)];
        pulled.solver.write_vtu(&critical.state, &fields, &mut bytes).map_err(Failure::file)?;
        findings.grids.push(Grid { name: "fig5-mode.vtu".into(), bytes });
    }
    Ok(findings)
}
