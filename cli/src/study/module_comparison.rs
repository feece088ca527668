//! Figs. 8 to 10: rods beside solids.

use super::{
    findings::{Curves, Titled},
    module_rods::{CasePath, Kind, TipMotion, same_pressure},
};
use actuator::units::{DEG, MM};

/// A case of a module without ties, as rods and as solids.
pub struct Compared<'a> {
    /// Which module.
    pub kind: &'static Kind,
    /// Number of the case from 0.
    pub case: usize,
    /// As rods.
    pub rods: &'a CasePath,
    /// As solids, to the first unstable state.
    pub solids: &'a CasePath,
}

/// How far the rods are from the solids at a pressure.
#[derive(Clone, Copy)]
pub struct Distance {
    /// The tip as rods.
    pub rods: TipMotion,
    /// And as solids.
    pub solids: TipMotion,
    /// Between the tips, mm.
    pub position: f64,
    /// Between their rotations, degrees.
    pub rotation: f64,
}

impl Compared<'_> {
    /// At each pressure that both reach, above none.
    pub fn distances(&self) -> Vec<Distance> {
        let (by_rods, by_solids) = (self.rods.motions(), self.solids.motions());
        let solids = self.solids.states.iter().zip(by_solids).skip(1);
        let each = solids.filter_map(|((pressure, state), solids)| {
            let place = self.rods.states.iter().position(|(other, _)| same_pressure(*other, *pressure))?;
            let poses = [&self.rods.states[place].1, state].map(|state| state.chart.to_pose());
            let position = (poses[0].position - poses[1].position).norm() / MM;
            let rotation = poses[0].rotation_distance(&poses[1]) / DEG;
            Some(Distance { rods: by_rods[place], solids, position, rotation })
        });
        each.collect()
    }
}

/// What the solids do in a case up to the last stable state.
pub fn stable(path: &CasePath) -> Vec<TipMotion> {
    let mut motions = path.motions();
    motions.retain(|motion| !motion.unstable);
    motions
}

/// Why a path of solids goes no further, in words.
pub fn end_in_words(path: &CasePath) -> String {
    match (path.unstable_from(), &path.ended) {
        (Some(kpa), _) => format!(", unstable at {kpa:.0} kPa"),
        (None, Some(_)) => format!(", lost beyond {:.0} kPa", path.last().pressure_kpa),
        (None, None) => String::new(),
    }
}

/// Side by side.
pub fn table(compared: &[Compared<'_>], length_mm: f64) -> Titled {
    let mut table = Titled::new(
        "Without ties, rods | solids: tip against rest",
        [
            "<module",
            "<case",
            "kPa",
            "along (mm)",
            "sideways (mm)",
            "twist (°)",
            "tilt (°)",
            "tips apart (% of length)",
            "rotations apart (°)",
            "<unstable",
        ],
    );
    for of in compared {
        for Distance { rods, solids, position, rotation } in of.distances() {
            let both = |value: fn(&TipMotion) -> f64, digits: usize, sign: bool| {
                let told = [&rods, &solids].map(|motion| match sign {
                    true => format!("{:+.digits$}", value(motion) + 0.0),
                    false => format!("{:.digits$}", value(motion)),
                });
                told.join(" | ")
            };
            let unstable = match (rods.unstable, solids.unstable) {
                (true, true) => "both",
                (true, false) => "rods",
                (false, true) => "solids",
                (false, false) => "–",
            };
            table.rows.push(vec![
                of.kind.name.into(),
                of.rods.case.name.trim_start_matches("case ").into(),
                format!("{:.0}", solids.pressure_kpa),
                both(|motion| motion.rise, 2, true),
                both(TipMotion::distance, 2, false),
                both(|motion| motion.twist, 1, true),
                both(|motion| motion.bend, 1, false),
                format!("{:.2}", 100.0 * position / length_mm),
                format!("{rotation:.2}"),
                unstable.into(),
            ]);
        }
        if let Some(why) = &of.solids.ended {
            let mut row = vec![String::new(); 10];
            let last = of.solids.last().pressure_kpa;
            row[0] = of.kind.name.into();
            row[1] = of.rods.case.name.trim_start_matches("case ").into();
            row[2] = format!("> {last:.0}");
            row[9] = format!("solids: {why}");
            table.rows.push(row);
        }
    }
    table
}

/// States of the solids.
pub fn curves(compared: &[Compared<'_>]) -> Curves {
    let head = vec![
        "module",
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
    for of in compared {
        for motion in of.solids.motions() {
            let [x, y] = motion.sideways;
            let mut row = vec![of.kind.name.into(), (of.case + 1).to_string()];
            let numbers = [motion.pressure_kpa, x, y, motion.rise, motion.twist, motion.bend, motion.gap];
            row.extend(numbers.map(|number| format!("{number:.6}")));
            row.push(u8::from(motion.unstable).to_string());
            rows.push(row);
        }
    }
    Curves { stem: "fig8-cases-solids".into(), head, rows }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::module_rods::KINDS;
    use actuator::{Case, ModuleState, PoseChart};

    fn path(states: &[(f64, f64, f64, u32)]) -> CasePath {
        let state = |(pressure, twist, z, negative_pivots): &(f64, f64, f64, u32)| {
            let chart = PoseChart { twist: *twist, bend: [0.0; 2], position: [0.0, 0.0, *z] };
            let state = ModuleState {
                chart,
                slopes: vec![],
                negative_pivots: *negative_pivots,
                residual: 0.0,
                gap: Some(1.0),
            };
            (*pressure, state)
        };
        let case = Case { name: "case 1: all", inflated: vec![true; 4] };
        CasePath { case, states: states.iter().map(state).collect(), ended: None }
    }

    #[test]
    fn states_are_compared_at_their_own_pressures() {
        let rods =
            path(&[(0.0, 0.0, 0.2, 0), (5e3, 0.1, 0.201, 0), (1e4, 0.2, 0.202, 1), (2e4, 0.3, 0.203, 1)]);
        let solids = path(&[(0.0, 0.0, 0.2, 0), (1e4, 0.23, 0.2035, 0), (2e4 + 1e-9, 0.3, 0.203, 2)]);
        let compared = Compared { kind: &KINDS[0], case: 0, rods: &rods, solids: &solids };
        let found = compared.distances();
        let kilopascals: Vec<f64> = found.iter().map(|found| found.solids.pressure_kpa.round()).collect();
        assert_eq!(kilopascals, [10.0, 20.0]);
        assert!((found[0].position - 1.5).abs() < 1e-9 && (found[0].rotation - 0.03 / DEG).abs() < 1e-6);
        assert!(found[1].position < 1e-9 && found[0].rods.unstable && !found[0].solids.unstable);
        assert_eq!(stable(&solids).len(), 2);
        assert_eq!(end_in_words(&solids), ", unstable at 20 kPa");
        let table = table(&[compared], 200.0);
        assert_eq!(table.rows[0][3], "+2.00 | +3.50");
        assert_eq!(table.rows[0][7], "0.75");
        assert_eq!(table.rows.iter().map(|row| row[9].as_str()).collect::<Vec<_>>(), ["rods", "both"]);
    }
}
