//! How far apart the FREEs of the 60 LR are and what its angle is measured from: what would explain the paper's sideways motions.

use super::{
    bench::{Bench, steps},
    findings::{Curves, Finding, Findings, Titled, Verdict},
    module_rods::{CasePath, GREATEST_KPA, Kind, TIED, TipMotion, crookedness, follow},
};
use crate::failure::Failure;
use actuator::Case;
use fe::RodSettings;

/// Distances of neighbouring axes, mm: touching, between, and that of the other studies.
const SPACINGS_MM: [f64; 3] = [11.12, 13.12, 15.0];
/// The paper's 60° read from the hoop, and read from the axis.
const READINGS: [(&str, f64); 2] = [("hoop", 60.0), ("axis", 30.0)];
/// Sideways motions that the paper reports of cases 3, 4 and 5, mm.
const REPORTED_MM: [f64; 3] = [25.0, 36.0, 25.0];
/// A way that departs from its chord by less than this share of it is straight.
const STRAIGHT: f64 = 0.05;

/// One reading of the paper.
struct Reading {
    from: &'static str,
    angle_deg: f64,
    spacing_mm: f64,
    spacers: u32,
    /// Cases 1, 3, 4 and 5.
    paths: Vec<CasePath>,
}

/// Where case 4 goes as far as reported.
struct AsCase4 {
    pressure_kpa: f64,
    /// Cases 3 and 5, mm.
    sideways: [f64; 2],
    unstable: bool,
}

impl AsCase4 {
    /// Greatest departure of cases 3 and 5 from what is reported, as a share.
    fn misfit(&self) -> f64 {
        let [three, five] = self.sideways;
        (three / REPORTED_MM[0] - 1.0).abs().max((five / REPORTED_MM[2] - 1.0).abs())
    }
}

impl Reading {
    fn sideways(&self) -> [f64; 3] {
        std::array::from_fn(|place| self.paths[place + 1].last().distance())
    }

    /// Greatest departure from the reported motions, as a share of each.
    fn misfit(&self) -> f64 {
        let off =
            self.sideways().into_iter().zip(REPORTED_MM).map(|(ours, paper)| (ours / paper - 1.0).abs());
        off.fold(0.0, f64::max)
    }

    /// The pressure (kPa) at which case 4 comes to what is reported of it, and there cases 3 and 5 (mm).
    fn as_case_4(&self) -> Option<AsCase4> {
        let (three, four, five) = (self.paths[1].motions(), self.paths[2].motions(), self.paths[3].motions());
        let (place, pair) =
            four.windows(2).enumerate().find(|(_, pair)| pair[1].distance() >= REPORTED_MM[1])?;
        let part = (REPORTED_MM[1] - pair[0].distance()) / (pair[1].distance() - pair[0].distance());
        let between = |low: f64, high: f64| low + part * (high - low);
        let there = |motions: &[TipMotion]| {
            Some(between(motions.get(place)?.distance(), motions.get(place + 1)?.distance()))
        };
        Some(AsCase4 {
            pressure_kpa: between(pair[0].pressure_kpa, pair[1].pressure_kpa),
            sideways: [there(&three)?, there(&five)?],
            unstable: [&three, &four, &five]
                .iter()
                .any(|motions| motions[..=place + 1].iter().any(|m| m.unstable)),
        })
    }

    fn told(&self) -> String {
        let ties = if self.spacers > 0 { "tied" } else { "without ties" };
        format!("{:.0}° from the {}, {} mm apart, {ties}", READINGS[0].1, self.from, self.spacing_mm)
    }
}

/// Adds the table of readings and what it says.
pub fn judge(bench: &Bench, findings: &mut Findings) -> Result<(), Failure> {
    let pressures = steps(GREATEST_KPA, if bench.coarse { 5 } else { 20 });
    let mut setups = vec![];
    for (from, angle_deg) in READINGS {
        bench.rod_law(angle_deg)?;
        for spacing_mm in SPACINGS_MM {
            setups.extend([TIED, 0].map(|spacers| (from, angle_deg, spacing_mm, spacers)));
        }
    }
    let readings =
        bench.each("spacing and winding angle", &setups, |(from, angle_deg, spacing_mm, spacers)| {
            let kind = Kind { name: "", angle_deg: *angle_deg, alternate: true };
            let module = kind.module(*spacing_mm, *spacers);
            let mut rods = bench.rods(&module, RodSettings::default())?;
            let wanted = Case::all(&module).into_iter().enumerate().filter(|(place, _)| *place != 1);
            let paths = wanted
                .map(|(_, case)| follow(&mut rods, &case, &pressures, true))
                .collect::<Result<_, _>>()?;
            Ok(Reading { from, angle_deg: *angle_deg, spacing_mm: *spacing_mm, spacers: *spacers, paths })
        })?;
    findings.tables.push(table(&readings));
    findings.curves.push(curves(&readings));
    let best = |from: &str| {
        readings
            .iter()
            .filter(|reading| reading.from == from)
            .min_by(|a, b| a.misfit().total_cmp(&b.misfit()))
    };
    let claims = [
        (
            "hoop",
            "60 LR, angle from the hoop, at 50 kPa: case 4 about 36 mm sideways in a straight line, cases 3 and 5 about 25 mm on curves",
        ),
        ("axis", "the same, angle from the axis (30° from the hoop): 36 mm straight, 25 mm on curves"),
    ];
    for (from, claim) in claims {
        let Some(found) = best(from) else { continue };
        let [three, four, five] = found.sideways();
        let bent = [1, 2, 3].map(|place| crookedness(&found.paths[place].motions()));
        let straight = bent[1] < STRAIGHT;
        let curved = bent[0] > STRAIGHT && bent[2] > STRAIGHT;
        let fits = found.misfit() < 0.15 && straight && curved;
        let along = found.paths[0].last();
        let all = readings.iter().filter(|reading| reading.from == from);
        let (low, high) = all.fold((f64::INFINITY, 0.0f64), |(low, high), reading| {
            let four = reading.sideways()[1];
            (low.min(four), high.max(four))
        });
        findings.findings.push(Finding {
            row: "P11",
            claim,
            ours: format!(
                "nearest: {}: case 4 {four:.1} mm {}, case 3 {three:.1} mm, case 5 {five:.1} mm, on ways that leave their chord by {:.0} and {:.0} %; \
                 case 1 {:+.1} mm along",
                found.told(),
                if straight { "straight" } else { "on a curve" },
                100.0 * bent[0],
                100.0 * bent[2],
                along.rise
            ),
            verdict: Verdict::of(fits),
            reason: format!(
                "over all distances and ties case 4 goes {low:.0} to {high:.0} mm; the worst of the three numbers is {:.0} % off at best{}",
                100.0 * found.misfit(),
                if along.rise < 0.0 { ". It also shortens in case 1, where the paper's modules elongate" } else { "" }
            ),
        });
    }
    let mut whatever: Vec<(&Reading, AsCase4)> =
        readings.iter().filter_map(|reading| Some((reading, reading.as_case_4()?))).collect();
    whatever.sort_by(|(_, a), (_, b)| a.misfit().total_cmp(&b.misfit()));
    if let Some((reading, found)) = whatever.iter().find(|(_, found)| !found.unstable) {
        let others = whatever.iter().filter(|(other, found)| other.from != reading.from && !found.unstable);
        let other = others.map(|(other, found)| {
            let [three, five] = found.sideways;
            format!("{}: {three:.1} and {five:.1} mm at {:.1} kPa", other.told(), found.pressure_kpa)
        });
        let other = other.take(1).collect::<Vec<_>>().join("");
        let best = whatever
            .iter()
            .filter(|(other, found)| other.from == reading.from && found.misfit() < 0.1 && !found.unstable);
        let pressures =
            best.map(|(other, found)| format!("{:.1} kPa ({})", found.pressure_kpa, other.told()));
        let [three, five] = found.sideways;
        findings.findings.push(Finding {
            row: "P11",
            claim: "the three sideways motions together, at whatever pressure",
            ours: format!(
                "{}: where case 4 comes to 36 mm, at {:.1} kPa, case 3 is at {three:.1} and case 5 at {five:.1} mm",
                reading.told(),
                found.pressure_kpa
            ),
            verdict: Verdict::of(found.misfit() < 0.1),
            reason: format!(
                "their proportions tell the readings apart. Within 10 %: {}. Best of the other reading: {}. So \
                 the numbers agree with 60° from the {} at about half the stated pressure, or with rubber and coat that are about twice as stiff",
                pressures.collect::<Vec<_>>().join(", "),
                if other.is_empty() { "never comes to 36 mm in a stable equilibrium" } else { &other },
                reading.from
            ),
        });
    }
    Ok(())
}

fn table(readings: &[Reading]) -> Titled {
    let mut table = Titled::new(
        "Spacing, ties and what the angle is measured from: the 60 LR at the last equilibrium up to 50 kPa (of the 30 LR the two readings change places). \
         Paper: 25, 36 and 25 mm. Way: departure from its chord",
        [
            "<60° from the",
            "apart (mm)",
            "spacers",
            "case 1 along (mm)",
            "case 3 (mm)",
            "way (%)",
            "case 4 (mm)",
            "way (%)",
            "case 5 (mm)",
            "way (%)",
            "worst (%)",
            "case 4 at 36 mm (kPa)",
            "case 3 there (mm)",
            "case 5 there (mm)",
            "<remarks",
        ],
    );
    for reading in readings {
        let mut row = vec![
            format!("{} ({:.0}° from the hoop)", reading.from, reading.angle_deg),
            format!("{:.2}", reading.spacing_mm),
            reading.spacers.to_string(),
            format!("{:+.1}", reading.paths[0].last().rise),
        ];
        let mut remarks = vec![];
        for (path, number) in reading.paths.iter().zip([1, 3, 4, 5]) {
            let motions = path.motions();
            if number > 1 {
                row.push(format!("{:.1}", path.last().distance()));
                row.push(format!("{:.0}", 100.0 * crookedness(&motions)));
            }
            if path.ended.is_some() {
                remarks.push(format!("case {number} ends at {:.1} kPa", path.last().pressure_kpa));
            }
            if let Some(kpa) = path.unstable_from() {
                remarks.push(format!("case {number} unstable from {kpa:.1} kPa"));
            }
            let gap = path.least_gap();
            if gap < -0.5 {
                remarks.push(format!("case {number}: FREEs overlap by {:.1} mm", -gap));
            }
        }
        row.push(format!("{:.0}", 100.0 * reading.misfit()));
        row.extend(reading.as_case_4().map_or_else(
            || ["–", "–", "–"].map(str::to_owned),
            |there| {
                let [three, five] = there.sideways;
                let mark = if there.unstable { ", unstable" } else { "" };
                [format!("{:.1}{mark}", there.pressure_kpa), format!("{three:.1}"), format!("{five:.1}")]
            },
        ));
        row.push(remarks.join("; "));
        table.rows.push(row);
    }
    table
}

fn curves(readings: &[Reading]) -> Curves {
    let head = vec![
        "angle_from_hoop_deg",
        "spacing_mm",
        "spacers",
        "case",
        "pressure_kpa",
        "x_mm",
        "y_mm",
        "rise_mm",
        "gap_mm",
        "unstable",
    ];
    let mut rows = vec![];
    for reading in readings {
        for (path, number) in reading.paths.iter().zip([1, 3, 4, 5]) {
            for motion in path.motions() {
                let mut row = vec![
                    reading.angle_deg.to_string(),
                    reading.spacing_mm.to_string(),
                    reading.spacers.to_string(),
                    number.to_string(),
                ];
                let [x, y] = motion.sideways;
                row.extend(
                    [motion.pressure_kpa, x, y, motion.rise, motion.gap].map(|number| format!("{number:.6}")),
                );
                row.push(u8::from(motion.unstable).to_string());
                rows.push(row);
            }
        }
    }
    Curves { stem: "fig11-spacing".into(), head, rows }
}
