//! Fig. 13: the paper's claims on idle FREEs, judged by rods and by solids.

use super::{
    findings::{Finding, Findings, Verdict},
    idle_frees::{Studied, StudiedSolids},
    module_solids::waves,
};
use actuator::units::KPA;
use fe::{Buckling, IdlePressure};

/// Which FREEs a mode moves, by its shifts of the inflated and the idle ones.
fn mode_in_words(buckling: &Buckling) -> String {
    let shifts: Vec<String> = buckling.mode.shifts().iter().map(|shift| format!("{shift:.2}")).collect();
    let [x, y, _] = buckling.mode.tip_shift;
    format!("shifts of FREEs 1 to 4 {}, of the tip {:.2}", shifts.join(", "), x.hypot(y))
}

/// How walls of solids give way.
fn walls_in_words(solids: &StudiedSolids) -> String {
    let (Some(buckling), Some([below, by])) = (&solids.rise.buckling, solids.critical_kpa()) else {
        let last = solids.bare().last().map_or(0.0, |(kpa, _)| kpa);
        return format!("stable to {last:.0} kPa");
    };
    let found = solids.bare().last().map_or_else(String::new, |(_, shape)| {
        format!(", turned by {:+.0}°, bow {:.1} mm, gap {:.2} mm", shape.twist, shape.bow, shape.gap)
    });
    let touch = solids.bare().find(|(_, shape)| shape.gap < 0.0);
    let touch = touch.map_or_else(String::new, |(kpa, _)| format!("; FREEs touch from {kpa:.1} kPa on"));
    let Some(mode) = &buckling.mode else {
        return format!("stable up to {below:.1} kPa{found}, where the path is lost{touch}");
    };
    let shifts = mode.shifts();
    let shifts_told: Vec<String> = shifts.iter().map(|shift| format!("{shift:.2}")).collect();
    let most = (0..shifts.len()).max_by(|a, b| shifts[*a].total_cmp(&shifts[*b])).unwrap_or(0);
    let (around, height) = solids.rise.bulges.get(most).map_or((0, 0.0), |lines| waves(lines));
    let [x, y, _] = mode.tip_shift;
    format!(
        "stable up to {below:.1} kPa, walls give way by {by:.1} kPa{found} (mode: shifts of FREEs 1 to 4 {}, of the tip {:.2}, {around} waves around, greatest at \
         {height:.0} mm){touch}",
        shifts_told.join(", "),
        x.hypot(y)
    )
}

/// Least idle pressures of solids where some are needed.
fn needed_in_words(solids: &StudiedSolids) -> String {
    let each = solids.least.iter().filter_map(|(kpa, least)| match least {
        IdlePressure::NotNeeded => None,
        IdlePressure::Least(idle) => Some(format!("{:.1} kPa at {kpa:.0} kPa", idle / KPA)),
        IdlePressure::NeverEnough => Some(format!("not found at {kpa:.0} kPa")),
    });
    let each: Vec<String> = each.collect();
    if each.is_empty() { "none needed".into() } else { each.join(", ") }
}

/// Adds what becomes of the claims.
pub fn judge(studied: &[Studied], findings: &mut Findings) {
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
    let by_rods = studied.iter().any(|studied| studied.buckling.is_some());
    let solids = || studied.iter().filter_map(|studied| studied.solids.as_ref());
    let by_solids = solids().any(|solids| solids.rise.buckling.is_some());
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
            let walls = studied.solids.as_ref();
            let walls = walls.map_or_else(String::new, |solids| format!("; as solids {}", walls_in_words(solids)));
            format!("as rods {buckled}, {}{walls}", bowed(studied))
        }),
        verdict: if by_rods || by_solids { Verdict::Holds } else { Verdict::CannotBeJudged },
        reason: match (by_rods, by_solids) {
            (true, _) => "the tangent loses its stability on the way".into(),
            (false, true) => "the walls of the idle FREEs, turned against their threads by the plate, give way. Rods have no walls: in them the plate's turn inclines the \
                              idle FREEs, so that they bow from the start, in the one equilibrium there is. Neither knows contact, which comes at about the same \
                              pressure where a gap is told as negative"
                .into(),
            (false, false) => "as rods they do not: the plate's turn inclines them, so that they bow from the start, in the one equilibrium there is, and run into \
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
        let walls = studied.solids.as_ref();
        let walls = walls.map_or_else(String::new, |solids| {
            format!("; as solids least idle pressure {}", needed_in_words(solids))
        });
        format!("as rods bow at {most:.0} kPa {}{walls}", told.collect::<Vec<_>>().join(", "))
    };
    findings.findings.push(Finding {
        row: "P12",
        claim: "a small pressure in them prevents it",
        ours: each(&smaller),
        verdict: match by_rods || by_solids {
            true => Verdict::of(studied.iter().all(prevented)),
            false => Verdict::CannotBeJudged,
        },
        reason: match (by_rods, by_solids) {
            (true, _) => "least idle pressures are in the table".into(),
            (false, true) => format!(
                "it keeps the walls of the idle FREEs round{}: the table has it by the case's pressure. There is no buckling to \
                 prevent in rods",
                greatest_share(studied).map_or_else(String::new, |share| format!(", at most {:.0} % of the case's pressure", 100.0 * share))
            ),
            (false, false) if studied.iter().all(grows) => {
                "there is no buckling to prevent in rods, and idle pressure does not lessen the bow but adds to it: the idle FREEs turn and stretch by their own \
                 pressure, against the plates"
                    .into()
            }
            (false, false) => "there is no buckling to prevent in rods; how idle pressure changes the bow is the map".into(),
        },
    });
}

/// Greatest of the least idle pressures of solids as a share of the case's.
fn greatest_share(studied: &[Studied]) -> Option<f64> {
    let all = studied.iter().filter_map(|studied| studied.solids.as_ref()).flat_map(|solids| &solids.least);
    let shares = all.filter_map(|(kpa, least)| match least {
        IdlePressure::Least(idle) => Some(idle / KPA / kpa),
        IdlePressure::NotNeeded | IdlePressure::NeverEnough => None,
    });
    shares.reduce(f64::max)
}

/// Whether the bow under the greatest pressure grows with the idle pressure.
fn grows(studied: &Studied) -> bool {
    let most = studied.nodes.iter().map(|node| node.case_kpa).fold(0.0, f64::max);
    let last =
        studied.nodes.iter().filter(|node| node.case_kpa == most).filter_map(|node| Some(node.found?.bow));
    last.collect::<Vec<_>>().windows(2).all(|pair| pair[1] >= pair[0])
}

/// Whether idle pressure keeps a module stable wherever it would not be, as rods and as solids.
fn prevented(studied: &Studied) -> bool {
    let enough = |least: &IdlePressure| *least != IdlePressure::NeverEnough;
    let rods = studied.least.iter().all(|(_, least)| least.as_ref().is_some_and(enough));
    let solids = studied.solids.iter().flat_map(|solids| &solids.least);
    rods && solids.map(|(_, least)| least).all(enough)
}
