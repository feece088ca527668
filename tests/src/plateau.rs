//! Settled states of a recording that goes through combinations of pressures in steps: of the University of Michigan module.

use crate::Table;
use std::path::Path;

/// A settled state at one combination of pressures.
#[derive(Clone, Debug, PartialEq)]
pub struct Plateau {
    /// Commanded gauge pressures, kPa.
    pub command_kpa: [f64; 3],
    /// What the regulators' monitors say, kPa: medians.
    pub monitor_kpa: [f64; 3],
    /// Shift along z since the start of the recording, mm: median.
    pub z_mm: f64,
    /// Rotation about z since the start of the recording, rad: median.
    pub rz_rad: f64,
    /// Shifts along x and y, mm, which a guide should not have: medians.
    pub aside_mm: [f64; 2],
    /// Half the range of z (mm) and of the rotation (rad) over the samples: what has not settled, and noise.
    pub spread: [f64; 2],
    /// Samples that it rests on.
    pub samples: usize,
}

/// Last samples of a step that are looked at: two seconds of five.
const LAST: usize = 20;
/// Fewest of them that make a plateau.
const FEWEST: usize = 10;
/// A marker that is farther than this (mm) from where the recording began was taken for another: the guided plate moves 4 mm.
const FARTHEST_MM: f64 = 10.0;

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    match (values.len(), values.len() / 2) {
        (0, _) => f64::NAN,
        (count, middle) if count % 2 == 0 => 0.5 * (values[middle - 1] + values[middle]),
        (_, middle) => values[middle],
    }
}

/// The plateaus of a recording (CSV) in the order of time, and how many steps have none because too many samples are missing or spikes.
#[track_caller]
pub fn plateaus(recording: &Path) -> (Vec<Plateau>, usize) {
    let table = Table::read(recording);
    let numbers = |row: &Vec<String>, names: [&str; 3]| names.map(|name| table.number(row, name));
    let rows: Vec<([f64; 3], [f64; 3], [f64; 4])> = table
        .rows
        .iter()
        .map(|row| {
            let [x, y, z] = numbers(row, ["x_mm", "y_mm", "z_mm"]);
            let command = numbers(row, ["p1_command_kpa", "p2_command_kpa", "p3_command_kpa"]);
            (command, numbers(row, ["p1_kpa", "p2_kpa", "p3_kpa"]), [x, y, z, table.number(row, "rz_rad")])
        })
        .collect();
    let mut found = Vec::new();
    let mut lost = 0;
    for step in rows.chunk_by(|a, b| a.0 == b.0) {
        let last = &step[step.len().saturating_sub(LAST)..];
        let seen: Vec<_> = last
            .iter()
            .filter(|(_, monitor, pose)| {
                let finite = monitor.iter().chain(pose).all(|value| value.is_finite());
                finite && pose[..3].iter().all(|shift| shift.abs() < FARTHEST_MM)
            })
            .collect();
        if seen.len() < FEWEST {
            lost += 1;
            continue;
        }
        let half_range = |k: usize| {
            let values = || seen.iter().map(|(.., pose)| pose[k]);
            0.5 * (values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min))
        };
        found.push(Plateau {
            command_kpa: step[0].0,
            monitor_kpa: [0, 1, 2].map(|i| median(seen.iter().map(|(_, monitor, _)| monitor[i]))),
            z_mm: median(seen.iter().map(|(.., pose)| pose[2])),
            rz_rad: median(seen.iter().map(|(.., pose)| pose[3])),
            aside_mm: [0, 1].map(|k| median(seen.iter().map(|(.., pose)| pose[k]))),
            spread: [half_range(2), half_range(3)],
            samples: seen.len(),
        });
    }
    (found, lost)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_spikes_do_not_count() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("grid.csv");
        let mut text = String::from(
            "t_s,p1_command_kpa,p2_command_kpa,p3_command_kpa,p1_kpa,p2_kpa,p3_kpa,x_mm,y_mm,z_mm,rz_rad\n",
        );
        for i in 0..90 {
            let command = if i < 50 { 10 } else { 20 };
            // The first step settles at -1 and has a spike and a gap; the second is mostly missing.
            let pose = match i {
                0..20 => "0,0,0,0".to_owned(),
                35 => "61,19,-68,1.9".to_owned(),
                36 => ",,,".to_owned(),
                20..50 => format!("0,0,{},0.5", -1.0 + 0.01 * f64::from(i % 2)),
                i if i % 4 == 0 => "0,0,-2,1".to_owned(),
                _ => ",,,".to_owned(),
            };
            text += &format!("{},{command},0,0,{},4,4,{pose}\n", 0.1 * f64::from(i), command + 3);
        }
        std::fs::write(&path, text).expect("written");
        let (found, lost) = plateaus(&path);
        assert_eq!((found.len(), lost), (1, 1));
        let only = &found[0];
        assert_eq!((only.command_kpa, only.monitor_kpa), ([10.0, 0.0, 0.0], [13.0, 4.0, 4.0]));
        assert!((only.z_mm + 0.995).abs() < 1e-12 && only.rz_rad == 0.5 && only.samples == 18, "{only:?}");
        assert!(only.spread[0] < 0.006 && only.spread[1] == 0.0);
    }
}
