//! P1: the strain of the 20° FREE at 60 kPa, with the mesh.

use super::{
    bench::{Bench, Inflated, mesh_name, steps},
    findings::{Curves, Finding, Findings, Grid, Picture, Titled, Verdict},
    specimen::{TUBE, free},
};
use crate::{
    failure::Failure,
    plot::{Chart, Field, Mark, Patch, Series},
};
use actuator::units::{DEG, KPA, MM};
use fe::{SolidMesh, Specimen, StrainFacet};

/// Strain that the paper says is exceeded.
const CLAIMED: f64 = 0.25;
/// Width of a fibre where it has one, m: the paper gives none, this is the thread of `data/actuators`.
const DIAMETER: f64 = 0.15 * MM;
/// Pressure of the claim.
const KILOPASCALS: f64 = 60.0;
/// The part of the surface that is pictured, m: where the tube leaves its cap.
const PICTURED: [f64; 2] = [0.0, 22.0 * MM];

/// Computes it.
pub fn compute(bench: &Bench) -> Result<Findings, Failure> {
    let mesh = |radial, around, along, under_fibre| SolidMesh {
        radial,
        under_fibre,
        ..SolidMesh::new(around, along)
    };
    let cases = match bench.coarse {
        true => vec![(0.0, mesh(1, 12, 60, 0)), (0.0, mesh(1, 12, 90, 0)), (DIAMETER, mesh(1, 12, 60, 1))],
        false => vec![
            (0.0, mesh(1, 12, 90, 0)),
            (0.0, mesh(1, 24, 180, 0)),
            (0.0, mesh(2, 24, 180, 0)),
            (DIAMETER, mesh(1, 12, 90, 1)),
            (DIAMETER, mesh(2, 24, 180, 1)),
        ],
    };
    let pressures = steps(KILOPASCALS, 6);
    let found = bench.each("P1: strain of the inflated FREE", &cases, |(diameter, mesh)| {
        bench.inflate(&Specimen::from(&free(20.0, *diameter)), *mesh, &pressures)
    })?;

    let mut table = Titled::new(
        format!("Principal logarithmic strains at {KILOPASCALS} kPa, by mesh"),
        [
            "<elements around × along × wall",
            "<fibre",
            "unknowns",
            "mean greatest",
            "mean least",
            "rubber > 25 % (%)",
            "peak, middle",
            "peak, anywhere",
            "extension (%)",
            "twist, middle (°/mm)",
        ],
    );
    let share = |case: &Inflated| case.solver.share_strained_above(&case.last, CLAIMED);
    for ((diameter, mesh), case) in cases.iter().zip(&found) {
        let strains = case.solver.strains(&case.last);
        let deformation = case.solver.deformation(&case.last);
        table.rows.push(vec![
            mesh_name(*mesh),
            if *diameter == 0.0 { "a line".into() } else { format!("{:.2} mm wide", diameter / MM) },
            case.solver.unknowns().to_string(),
            format!("{:.4}", strains.mean_mid[0]),
            format!("{:.4}", strains.mean_mid[2]),
            format!("{:.1}", 100.0 * share(case)),
            format!("{:.4}", strains.greatest_mid.log_strain),
            format!("{:.4}", strains.greatest.log_strain),
            format!("{:.3}", 100.0 * (deformation.stretch_total - 1.0)),
            format!("{:.4}", deformation.twist_mid / DEG * MM),
        ]);
    }
    let lines = cases.iter().filter(|(diameter, _)| *diameter == 0.0).count();
    let finest = &found[lines - 1];
    let means: Vec<f64> = found.iter().map(|case| case.solver.strains(&case.last).mean_mid[0]).collect();
    let spread = means.iter().map(|mean| (mean / means[lines - 1] - 1.0).abs()).fold(0.0, f64::max);
    let strains = finest.solver.strains(&finest.last);
    let share = share(finest);

    let mut findings = Findings {
        setup: vec![
            format!(
                "Simulated by solid finite elements: the paper's FREE at 20° from the hoop (bore 9.52 mm, wall 0.8 mm, length 130 mm, \
                 mu 0.393 MPa, Ogden alpha 1.2), six truss fibres of EA 644 N on the outer surface, rigid caps, one held and one \
                 free, pressure on wall and caps up to {KILOPASCALS} kPa; one of six equal sectors, which has the same symmetric states."
            ),
            "Means are over the rubber between 40 and 60 % of the length. Peaks do not converge: a fibre without width is a line \
             load, under which the exact strain has no bound, as at the edge of a cap; with a width they settle more slowly than the means."
                .into(),
            format!(
                "Largest relative residual {:.0e}; the mean greatest strain differs by {:.2} % between the meshes.",
                found.iter().map(|case| case.residual).fold(0.0, f64::max),
                100.0 * spread
            ),
        ],
        ..Findings::default()
    };
    findings.findings.push(Finding {
        row: "P1",
        claim: "at 20° and 60 kPa the principal logarithmic strains are over 25 %",
        ours: format!(
            "away from the caps {:.1} % on average, above 25 % in {:.0} % of the rubber, up to {:.1} %",
            100.0 * strains.mean_mid[0],
            100.0 * share,
            100.0 * strains.greatest_mid.log_strain
        ),
        verdict: Verdict::of(strains.mean_mid[0] > CLAIMED),
        reason: format!(
            "shear by twist ({:.2}°/mm) adds to swelling and stretching; the mean is the same on all meshes within {:.1} %",
            finest.solver.deformation(&finest.last).twist_mid / DEG * MM,
            100.0 * spread
        ),
    });
    findings.tables.push(table);

    let mut chart =
        Chart::new("20°: greatest principal strain, simulated", "pressure (kPa)", "logarithmic strain");
    let mut rows = vec![];
    for ((diameter, mesh), case) in cases.iter().zip(&found) {
        for (pressure, state) in &case.states {
            let strains = case.solver.strains(state);
            rows.push(vec![
                mesh_name(*mesh).replace(" × ", "x").replace(',', ";"),
                format!("{:.3}", diameter / MM),
                format!("{:.3}", pressure / KPA),
                format!("{:.6}", strains.mean_mid[0]),
                format!("{:.6}", strains.mean_mid[2]),
                format!("{:.6}", strains.greatest_mid.log_strain),
                format!("{:.6}", strains.greatest.log_strain),
            ]);
        }
    }
    let curve = |of: fn(&fe::Strains) -> f64| {
        let rest = std::iter::once((0.0, 0.0));
        let states = finest.states.iter().map(|(p, state)| (p / KPA, of(&finest.solver.strains(state))));
        rest.chain(states).collect::<Vec<_>>()
    };
    chart = chart
        .with(Series::new("mean, middle", Mark::LinePoints, curve(|strains| strains.mean_mid[0])))
        .with(Series::new("peak, middle", Mark::LinePoints, curve(|strains| strains.greatest_mid.log_strain)))
        .with(Series::new("25 %", Mark::Dashed, vec![(0.0, CLAIMED), (KILOPASCALS, CLAIMED)]).coloured(6));
    findings.figures.push((
        "p1-strain",
        Picture::Chart(chart),
        format!("Finest mesh with fibres as lines ({}).", mesh_name(cases[lines - 1].1)),
    ));
    let flat = |facet: &StrainFacet, axes: [usize; 2]| Patch {
        corners: facet.corners.map(|at| (at[axes[0]] / MM, at[axes[1]] / MM)),
        value: facet.log_strain,
    };
    let section = finest.solver.cross_section_strains(&finest.last, 0.5 * TUBE.length, 5);
    let label = "greatest principal log strain";
    findings.figures.push((
        "p1-section",
        Picture::Field(Field {
            patches: section.iter().map(|facet| flat(facet, [0, 1])).collect(),
            ..Field::new(format!("20°, {KILOPASCALS} kPa: mid-length, simulated"), "x (mm)", "y (mm)", label)
        }),
        "Cross-section at mid-length. The six fibres hold the outer surface in valleys.".into(),
    ));
    let surface = finest.solver.surface_strains(&finest.last, PICTURED, 3);
    findings.figures.push((
        "p1-surface",
        Picture::Field(Field {
            patches: seen_from_side(&surface).into_iter().map(|facet| flat(facet, [2, 1])).collect(),
            ..Field::new(
                format!("20°, {KILOPASCALS} kPa: next to the cap, simulated"),
                "z (mm)",
                "y (mm)",
                label,
            )
        }),
        "Outer surface from the held cap on, seen from the side.".into(),
    ));
    let head = vec![
        "mesh",
        "fibre_width_mm",
        "pressure_kpa",
        "mean_greatest_log_strain",
        "mean_least_log_strain",
        "peak_middle",
        "peak_anywhere",
    ];
    findings.curves.push(Curves { stem: "p1".into(), head, rows });
    // One element through the wall keeps the file small.
    let pictured = &found[1.min(lines - 1)];
    let mut rubber = vec![];
    let mut fibres = vec![];
    pictured.solver.write_vtu(&pictured.last, &[], &mut rubber).map_err(Failure::file)?;
    pictured.solver.write_fibres_vtu(&pictured.last, &mut fibres).map_err(Failure::file)?;
    findings.grids.push(Grid { name: "p1-60kpa.vtu".into(), bytes: rubber });
    findings.grids.push(Grid { name: "p1-60kpa-fibres.vtu".into(), bytes: fibres });
    Ok(findings)
}

/// The facets that face a viewer on the x axis, the farthest first.
fn seen_from_side(facets: &[StrainFacet]) -> Vec<&StrainFacet> {
    let faces = |facet: &&StrainFacet| {
        let [a, b, c, d] = facet.corners;
        // x component of the outward normal, by the diagonals.
        (c[1] - a[1]) * (d[2] - b[2]) - (c[2] - a[2]) * (d[1] - b[1]) > 0.0
    };
    let depth = |facet: &StrainFacet| facet.corners.iter().map(|at| at[0]).sum::<f64>();
    let mut seen: Vec<&StrainFacet> = facets.iter().filter(faces).collect();
    seen.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
    seen
}
