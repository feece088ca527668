//! Fig. 6: a 20° FREE with rubber and fibres of half and double stiffness.

use super::{
    bench::{Bench, Inflated, mesh_name, steps},
    findings::{Curves, Finding, Findings, Picture, Titled, Verdict},
    specimen::{FIBRE_STIFFNESS, SHEAR_MODULUS, free, latex},
};
use crate::{
    failure::Failure,
    plot::{Chart, Mark, Series},
    table::short,
};
use actuator::units::{DEG, KPA, MM};
use fe::{Deformation, SolidMesh, Specimen};

/// The FREE with half the modulus has its limit pressure near 47 kPa: the comparison ends before.
const GREATEST_KPA: f64 = 40.0;

/// Name, factors on the rubber's modulus and on the fibres' stiffness.
const VARIANTS: [(&str, f64, f64); 5] = [
    ("as described", 1.0, 1.0),
    ("rubber × ½", 0.5, 1.0),
    ("rubber × 2", 2.0, 1.0),
    ("fibre × ½", 1.0, 0.5),
    ("fibre × 2", 1.0, 2.0),
];

/// Names and values of the three deformations: zero without pressure.
type Quantity = (&'static str, &'static str, fn(&Deformation) -> f64);
const QUANTITIES: [Quantity; 3] = [
    ("extension", "extension (%)", |d| 100.0 * (d.stretch_total - 1.0)),
    ("expansion", "expansion (%)", |d| 100.0 * (d.expansion_mid - 1.0)),
    ("twist", "twist per length (°/mm)", |d| d.twist_total / DEG * MM),
];

/// Computes it.
pub fn compute(bench: &Bench) -> Result<Findings, Failure> {
    let (mesh, finer) = match bench.coarse {
        true => (SolidMesh::new(12, 60), SolidMesh::new(12, 90)),
        false => (SolidMesh::new(12, 90), SolidMesh::new(24, 180)),
    };
    let pressures = steps(GREATEST_KPA, if bench.coarse { 4 } else { 16 });
    let variant = |rubber: f64, fibre: f64| {
        let mut free = free(20.0, 0.0);
        free.elastomer = latex().with_shear_modulus(rubber * SHEAR_MODULUS);
        free.winding.fibre.axial_stiffness = fibre * FIBRE_STIFFNESS;
        Specimen::from(&free)
    };
    let mut cases: Vec<(Specimen, SolidMesh)> = vec![];
    // The finer two check the mesh.
    for (mesh, variants) in [(mesh, &VARIANTS[..]), (finer, &VARIANTS[..2])] {
        cases.extend(variants.iter().map(|&(_, rubber, fibre)| (variant(rubber, fibre), mesh)));
    }
    let found = bench
        .each("Fig. 6: stiffness", &cases, |(specimen, mesh)| bench.inflate(specimen, *mesh, &pressures))?;
    let (found, fine) = found.split_at(VARIANTS.len());

    let ratio = |case: &Inflated, base: &Inflated, stop: usize, of: fn(&Deformation) -> f64| {
        of(&case.path[stop].1) / of(&base.path[stop].1)
    };
    // Over all stops, least and greatest ratio to the FREE as described.
    let range = |index: usize, of: fn(&Deformation) -> f64| {
        let ratios = (0..pressures.len()).map(|stop| ratio(&found[index], &found[0], stop, of));
        ratios.fold([f64::INFINITY, 0.0f64], |[low, high], ratio| [low.min(ratio), high.max(ratio)])
    };
    let told = |index: usize| {
        let each = QUANTITIES.map(|(name, _, of)| {
            let [low, high] = range(index, of);
            format!("{name} {low:.3} to {high:.3}")
        });
        each.join(", ")
    };
    let halved = QUANTITIES.map(|(_, _, of)| range(1, of)[0]);
    let fibres = QUANTITIES.map(|(_, _, of)| {
        [3, 4].map(|index| range(index, of).map(|ratio| (ratio - 1.0).abs()).into_iter().fold(0.0, f64::max))
    });
    let most = fibres.as_flattened().iter().copied().fold(0.0, f64::max);
    let mesh_error = QUANTITIES
        .map(|(_, _, of)| {
            let last = pressures.len() - 1;
            (ratio(&found[1], &found[0], last, of) / ratio(&fine[1], &fine[0], last, of) - 1.0).abs()
        })
        .into_iter()
        .fold(0.0, f64::max);

    let mut findings = Findings {
        setup: vec![
            format!(
                "Simulated by solid finite elements: the paper's FREE at 20° from the hoop, 130 mm long, six truss fibres without \
                 width, rigid caps, the tip free; rubber and fibres of half, single and double stiffness (mu {} MPa, EA {} N), 0 to \
                 {GREATEST_KPA} kPa. Above that the soft one nears its limit pressure (about 47 kPa).",
                SHEAR_MODULUS / 1e6,
                FIBRE_STIFFNESS
            ),
            format!(
                "Mesh {} (around × along × through the wall); on {} the ratios at {GREATEST_KPA} kPa differ by {:.2} %.",
                mesh_name(mesh),
                mesh_name(finer),
                100.0 * mesh_error
            ),
        ],
        ..Findings::default()
    };
    findings.findings = vec![
        Finding {
            row: "P8",
            claim: "halving the rubber's stiffness more than doubles extension, expansion and twist",
            ours: format!("times (over 0 to {GREATEST_KPA} kPa) {}", told(1)),
            verdict: Verdict::of(halved.iter().all(|ratio| *ratio > 2.0)),
            reason: "fibres that hardly give leave p/mu as the only parameter, so that half the modulus is double the pressure: twice \
                     at small pressures, more as the wall thins"
                .into(),
        },
        Finding {
            row: "P8",
            claim: "the fibres' stiffness hardly matters",
            ours: format!("halved or doubled it changes them by {:.2} % at most", 100.0 * most),
            verdict: Verdict::of(most < 0.03),
            reason: format!(
                "EA/(mu R t) is about {}: the fibres are all but inextensible already (judged: below 3 %)",
                short(FIBRE_STIFFNESS / (SHEAR_MODULUS * 5.16e-3 * 0.8e-3))
            ),
        },
    ];
    for stop in [pressures.len() / 4, pressures.len() / 2, pressures.len()].map(|stop| stop - 1) {
        let title = format!("At {:.1} kPa, and over the FREE as described", pressures[stop] / KPA);
        let mut table = Titled::new(
            title,
            ["<variant", "extension (%)", "ratio", "expansion (%)", "ratio", "twist (°/mm)", "ratio"],
        );
        for ((name, ..), case) in VARIANTS.iter().zip(found) {
            let cells = QUANTITIES.iter().flat_map(|(_, _, of)| {
                [
                    format!("{:.4}", of(&case.path[stop].1)),
                    format!("{:.4}", ratio(case, &found[0], stop, *of)),
                ]
            });
            table.rows.push(std::iter::once((*name).to_owned()).chain(cells).collect());
        }
        findings.tables.push(table);
    }
    for ((name, label, of), stem) in QUANTITIES.iter().zip(["fig6-extension", "fig6-expansion", "fig6-twist"])
    {
        let mut chart = Chart::new(format!("20°: {name}, simulated"), "pressure (kPa)", *label);
        for (index, ((variant, ..), case)) in VARIANTS.iter().zip(found).enumerate() {
            let points = case.path.iter().map(|(pressure, deformation)| (pressure / KPA, of(deformation)));
            let points = std::iter::once((0.0, 0.0)).chain(points).collect();
            let mark = if index < 3 { Mark::Line } else { Mark::Points };
            chart = chart.with(Series::new(*variant, mark, points));
        }
        let caption = format!("{name}, cap to cap for extension and twist, at mid-length for expansion.");
        findings.figures.push((stem, Picture::Chart(chart), caption));
    }
    let mut chart =
        Chart::new("20°: half the rubber's stiffness", "pressure (kPa)", "times the FREE as described");
    for (name, _, of) in QUANTITIES {
        let points =
            (0..pressures.len()).map(|stop| (pressures[stop] / KPA, ratio(&found[1], &found[0], stop, of)));
        chart = chart.with(Series::new(name, Mark::LinePoints, points.collect()));
    }
    let two = vec![(0.0, 2.0), (GREATEST_KPA, 2.0)];
    chart = chart.with(Series::new("twice", Mark::Dashed, two).coloured(6));
    let caption = "The paper's \"more than doubles\": from two at no pressure upwards.".to_owned();
    findings.figures.push(("fig6-ratio", Picture::Chart(chart), caption));

    let mut rows = vec![];
    for ((_, rubber, fibre), case) in VARIANTS.iter().zip(found) {
        for (pressure, deformation) in &case.path {
            let mut row = vec![rubber.to_string(), fibre.to_string(), format!("{:.4}", pressure / KPA)];
            row.extend(QUANTITIES.iter().map(|(_, _, of)| format!("{:.6}", of(deformation))));
            rows.push(row);
        }
    }
    let head = vec![
        "rubber_factor",
        "fibre_factor",
        "pressure_kpa",
        "extension_percent",
        "expansion_percent",
        "twist_deg_per_mm",
    ];
    findings.curves.push(Curves { stem: "fig6".into(), head, rows });
    Ok(findings)
}
