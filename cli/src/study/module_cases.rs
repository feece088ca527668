//! Figs. 8 to 10: four modules in five cases of pressure.

use super::{
    bench::{Bench, steps},
    findings::{Curves, Finding, Findings, Titled, Verdict},
    module_comparison::{self, Compared, end_in_words, stable},
    module_rods::{CasePath, GREATEST_KPA, KINDS, Kind, LENGTH_MM, SPACING_MM, TIED, TipMotion, follow},
};
use crate::{
    failure::Failure,
    plot::{Chart, Mark, Series},
};
use actuator::Case;
use fe::RodSettings;

/// A module with or without ties, in all cases.
struct Followed {
    kind: &'static Kind,
    spacers: u32,
    paths: Vec<CasePath>,
}

/// What a case of an LR module is said to be, and whether a motion is that.
struct Said {
    claims: [&'static str; 3],
    case: usize,
    holds: fn(&[TipMotion]) -> bool,
    reason: fn(&TipMotion) -> &'static str,
}

/// What counts as none: mm, degrees.
const NONE: (f64, f64) = (0.5, 0.5);

const SAID: [Said; 3] = [
    Said {
        claims: [
            "30 LR, case 1: pure elongation",
            "60 LR, case 1: pure elongation",
            "40 LR, case 1: pure elongation",
        ],
        case: 0,
        holds: |motions| {
            motions.iter().all(|m| m.distance() < NONE.0 && m.twist.abs() < NONE.1 && m.bend < NONE.1)
                && motions.last().is_some_and(|m| m.rise > NONE.0)
        },
        reason: |last| match last.rise > 0.0 {
            true => "tied, opposite hands cancel the twist",
            false => {
                "tied, it is pure but shortens: where opposite hands hold each other's twist, a FREE contracts from 35.3° from the hoop (54.7° from the axis) \
                 on"
            }
        },
    },
    Said {
        claims: [
            "30 LR, case 2: rotation without bending",
            "60 LR, case 2: rotation without bending",
            "40 LR, case 2: rotation without bending",
        ],
        case: 1,
        holds: |motions| {
            motions.iter().all(|m| m.distance() < NONE.0 && m.bend < NONE.1)
                && motions.last().is_some_and(|m| m.twist.abs() > 10.0)
        },
        reason: |_| "tied, a diagonal pair has one hand and pulls in the middle",
    },
    Said {
        claims: ["30 LR, case 4: pure bending", "60 LR, case 4: pure bending", "40 LR, case 4: pure bending"],
        case: 3,
        holds: |motions| {
            motions.iter().all(|m| m.twist.abs() < NONE.1)
                && motions.last().is_some_and(|m| m.bend > 5.0 && m.distance() > 5.0)
        },
        reason: |_| "tied, neighbours have opposite hands, whose twists cancel",
    },
];

/// Computes it.
pub fn compute(bench: &Bench) -> Result<Findings, Failure> {
    let pressures = steps(GREATEST_KPA, if bench.coarse { 5 } else { 20 });
    let kinds: &[Kind] = if bench.coarse { &KINDS[..2] } else { &KINDS };
    // Laws first, with all threads each.
    for kind in kinds {
        bench.rod_law(kind.angle_deg)?;
    }
    let setups: Vec<(&'static Kind, u32)> =
        KINDS[..kinds.len()].iter().flat_map(|kind| [(kind, TIED), (kind, 0)]).collect();
    let followed = bench.each("Figs. 8 to 10: modules", &setups, |(kind, spacers)| {
        let module = kind.module(SPACING_MM, *spacers);
        let mut rods = bench.rods(&module, RodSettings::default())?;
        let cases = Case::all(&module);
        let paths = cases.iter().map(|case| follow(&mut rods, case, &pressures, true));
        let paths = paths.collect::<Result<_, _>>()?;
        Ok(Followed { kind, spacers: *spacers, paths })
    })?;
    let by_solids = match bench.solids {
        true => bench.solid_cases(&KINDS[..kinds.len()], &steps(GREATEST_KPA, 5))?,
        false => vec![],
    };
    let mut findings = Findings { setup: setup(bench), ..Findings::default() };
    let of = |name: &str, spacers: u32| {
        followed.iter().find(|followed| followed.kind.name == name && followed.spacers == spacers)
    };
    for said in &SAID {
        for claim in said.claims {
            let name = claim.split(',').next().unwrap_or_default();
            let (Some(tied), Some(loose)) = (of(name, TIED), of(name, 0)) else { continue };
            let (tied, loose) = (&tied.paths[said.case], &loose.paths[said.case]);
            let solids = by_solids.iter().find(|(kind, case, _)| kind.name == name && *case == said.case);
            let unstable = loose.unstable_from();
            let left = match unstable {
                Some(from) => format!(
                    ". Without ties this equilibrium is unstable from {from:.1} kPa: FREEs buckle, and the module goes elsewhere"
                ),
                None => String::new(),
            };
            let ended = loose.ended.as_ref().map_or_else(String::new, |_| {
                format!(". Without ties the path ends at {:.1} kPa", loose.last().pressure_kpa)
            });
            let by_rods = (said.holds)(&tied.motions());
            let mut ours = format!("tied: {}; without ties: {}", tied.last().told(), loose.last().told());
            let (mut verdict, mut solids_say) = (Verdict::of(by_rods), String::new());
            if let Some((.., path)) = solids {
                let motions = stable(path);
                let last = motions.last().copied().unwrap_or_else(|| path.last());
                ours += &format!(", as solids {}{}", last.told(), end_in_words(path));
                let by_solids = (said.holds)(&motions);
                // The paper says nothing of ties, and solids have none.
                verdict = if by_rods == by_solids { verdict } else { Verdict::CannotBeJudged };
                solids_say = match (by_rods, by_solids) {
                    (true, true) => ". Solids without ties do so too, as far as they are stable",
                    (false, false) => ". Nor do solids without ties",
                    (true, false) => {
                        ". Solids without ties do not: it hangs on ties, which the paper does not tell of"
                    }
                    (false, true) => {
                        ". Solids without ties do: it hangs on ties, which the paper does not tell of"
                    }
                }
                .into();
            }
            let reason = format!("{}{left}{ended}{solids_say}", (said.reason)(&tied.last()));
            findings.findings.push(Finding { row: "P10", claim, ours, verdict, reason });
        }
    }
    findings.tables.push(table(&followed));
    findings.curves.push(curves(&followed));
    let compared: Vec<Compared<'_>> = by_solids
        .iter()
        .filter_map(|(kind, case, solids)| {
            let rods = &of(kind.name, 0)?.paths[*case];
            Some(Compared { kind, case: *case, rods, solids })
        })
        .collect();
    if !compared.is_empty() {
        findings.tables.push(module_comparison::table(&compared, LENGTH_MM));
        findings.curves.push(module_comparison::curves(&compared));
    }
    for pair in followed.chunks(2) {
        if let [tied, loose] = pair {
            figures(tied, loose, &mut findings);
        }
    }
    Ok(findings)
}

fn setup(bench: &Bench) -> Vec<String> {
    let bending = match bench.coarse {
        true => "as bare tubes (coarse)",
        false => "by laws from solids under pressure, axial force and torque",
    };
    vec![
        format!(
            "Simulated by rods with section laws from finite elements, bending {bending}: four FREEs of 175 mm whose axes are {SPACING_MM} mm \
             apart, from 0 to {GREATEST_KPA} kPa (7.25 psi), hanging. Winding angles are read from the hoop. Each module is computed tied by {TIED} \
             spacers, and without any, every FREE going its own way: the paper gives neither the distance nor ties."
        ),
        "Cases: 1 all FREEs, 2 a diagonal pair, 3 one, 4 two neighbours, 5 three; the others are idle, without pressure. A FREE of 60° \
         has its limit pressure near 52 kPa, just above."
            .into(),
        "The path that comes from rest is followed through instability, as a perfect module would go; where a real one leaves it, states are called \
         unstable (a pivot of the tangent is negative) and ringed in figures. FREEs that touch are not kept apart: a negative gap in the table tells \
         where they would."
            .into(),
        match (bench.solids, bench.coarse) {
            (false, _) => "--solids computes the cases without ties by solids too, every FREE a whole tube of finite elements.".into(),
            (true, coarse) => format!(
                "Solids: every FREE a whole tube of finite elements{} with threads 0.15 mm wide (those of the rods' sections are spread over the surface), joined by the plate, \
                 without ties, which they cannot have; each case is followed by 10 kPa to its first unstable state. A claim holds where tied rods and solids say so, \
                 and cannot be judged where they differ.",
                if coarse { " (coarse)" } else { "" }
            ),
        },
    ]
}

fn table(followed: &[Followed]) -> Titled {
    let mut table = Titled::new(
        "Tip at the end of each case, against rest",
        [
            "<module",
            "<spacers",
            "<case",
            "kPa",
            "along (mm)",
            "sideways (mm)",
            "twist (°)",
            "tilt (°)",
            "least gap (mm)",
            "unstable from (kPa)",
        ],
    );
    for Followed { kind, spacers, paths } in followed {
        for path in paths {
            let last = path.last();
            table.rows.push(vec![
                kind.name.into(),
                spacers.to_string(),
                path.case.name.trim_start_matches("case ").into(),
                format!("{:.1}{}", last.pressure_kpa, if path.ended.is_some() { ", path ends" } else { "" }),
                format!("{:+.2}", last.rise),
                format!("{:.2}", last.distance()),
                format!("{:+.1}", last.twist + 0.0),
                format!("{:.1}", last.bend),
                format!("{:.2}", path.least_gap()),
                path.unstable_from().map_or_else(|| "–".into(), |kpa| format!("{kpa:.1}")),
            ]);
        }
    }
    table
}

fn curves(followed: &[Followed]) -> Curves {
    let head = vec![
        "module",
        "spacers",
        "case",
        "pressure_kpa",
        "x_mm",
        "y_mm",
        "rise_mm",
        "twist_deg",
        "tilt_deg",
        "gap_mm",
        "unstable",
    ];
    let mut rows = vec![];
    for Followed { kind, spacers, paths } in followed {
        for (number, path) in paths.iter().enumerate() {
            for motion in path.motions() {
                let [x, y] = motion.sideways;
                let mut row = vec![kind.name.into(), spacers.to_string(), (number + 1).to_string()];
                let numbers = [motion.pressure_kpa, x, y, motion.rise, motion.twist, motion.bend, motion.gap];
                row.extend(numbers.map(|number| format!("{number:.6}")));
                row.push(u8::from(motion.unstable).to_string());
                rows.push(row);
            }
        }
    }
    Curves { stem: "fig8-cases".into(), head, rows }
}

/// What a figure shows of a motion.
type Quantity = fn(&TipMotion) -> f64;

/// Stems of a module's three figures.
const STEMS: [[&str; 3]; 4] = [
    ["fig8-30lr-along", "fig8-30lr-sideways", "fig8-30lr-twist"],
    ["fig9-60lr-along", "fig9-60lr-sideways", "fig9-60lr-twist"],
    ["fig10-40lr-along", "fig10-40lr-sideways", "fig10-40lr-twist"],
    ["fig10-40r-along", "fig10-40r-sideways", "fig10-40r-twist"],
];

fn figures(tied: &Followed, loose: &Followed, findings: &mut Findings) {
    let Some(place) = KINDS.iter().position(|kind| kind.name == tied.kind.name) else { return };
    let quantities: [(&str, Quantity); 3] = [
        ("tip along the axis (mm)", |motion| motion.rise),
        ("tip sideways (mm)", TipMotion::distance),
        ("twist of the tip (°)", |motion| motion.twist),
    ];
    for (stem, (label, value)) in STEMS[place].into_iter().zip(quantities) {
        let mut chart = Chart {
            subtitle: format!("lines: {TIED} spacers, dashed: none, rings: unstable"),
            ..Chart::new(format!("{}, simulated", tied.kind.name), "pressure (kPa)", label)
        };
        for (colour, (tied, loose)) in tied.paths.iter().zip(&loose.paths).enumerate() {
            let points = |motions: &[TipMotion]| {
                motions.iter().map(|motion| (motion.pressure_kpa, value(motion))).collect::<Vec<_>>()
            };
            let mut unstable = loose.motions();
            unstable.retain(|motion| motion.unstable);
            chart = chart
                .with(Series::new(tied.case.name, Mark::Line, points(&tied.motions())).coloured(colour))
                .with(Series::new("", Mark::Dashed, points(&loose.motions())).coloured(colour))
                .with(Series::new("", Mark::Rings, points(&unstable)).coloured(colour));
        }
        let caption = "Cases of pressure; FREEs that are not inflated have none.".to_owned();
        findings.figures.push((stem, chart.into(), caption));
    }
}
