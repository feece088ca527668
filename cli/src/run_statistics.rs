//! How the solves of a run went: errors, limits, times.

use crate::{
    exit::Exit,
    table::{Table, duration, short},
};
use actuator::units::{DEG, KPA, MM};
use record::SolveRecord;
use serde_json::{Value, json};

/// Numbers of a run, gathered solve by solve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunStatistics {
    reached: usize,
    unreachable: usize,
    refused: usize,
    position: Vec<f64>,
    rotation: Vec<f64>,
    margin: Vec<f64>,
    time: Vec<f64>,
    held: usize,
}

impl RunStatistics {
    /// Counts a solve.
    pub fn add(&mut self, solve: &SolveRecord) {
        match solve.status.as_str() {
            "reached" => self.reached += 1,
            "refused" => self.refused += 1,
            _ => self.unreachable += 1,
        }
        self.held += usize::from(!solve.active_bound.is_empty());
        self.time.push(solve.duration);
        for (list, value) in [
            (&mut self.position, solve.position_residual),
            (&mut self.rotation, solve.rotation_residual),
            (&mut self.margin, solve.limit_margin),
        ] {
            if value.is_finite() {
                list.push(value);
            }
        }
    }

    /// Number of solves.
    pub fn solves(&self) -> usize {
        self.time.len()
    }

    /// Greatest distance from a target, m.
    pub fn worst_position(&self) -> f64 {
        greatest(&self.position)
    }

    /// Median time of a solve, s.
    pub fn median_time(&self) -> f64 {
        share(&self.time, 0.5)
    }

    /// The code that the run deserves.
    pub fn exit(&self) -> Exit {
        match (self.refused, self.unreachable) {
            (0, 0) => Exit::Done,
            (0, _) => Exit::Unreachable,
            _ => Exit::Refused,
        }
    }

    /// The run in a sentence.
    pub fn summary(&self) -> String {
        let rest = [(self.unreachable, "out of reach"), (self.refused, "refused")];
        let rest: String =
            rest.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {n} {what}")).collect();
        format!("{} of {} targets reached{rest}", self.reached, self.solves())
    }

    /// The numbers as a table.
    pub fn table(&self) -> String {
        let mut table = Table::new(["<", "rms", "95 % below", "worst"]);
        let row = |list: &[f64], unit: f64| {
            [root_mean_square(list), share(list, 0.95), greatest(list)].map(|v| short(v / unit))
        };
        let mut add = |name: &str, [rms, p95, worst]: [String; 3]| table.row([name.into(), rms, p95, worst]);
        add("distance from the target (mm)", row(&self.position, MM));
        if !self.rotation.is_empty() {
            add("angle from the target (°)", row(&self.rotation, DEG));
        }
        let text = table.text();
        let margin = self.margin.iter().copied().fold(f64::INFINITY, f64::min);
        format!(
            "{text}\n  pressures never nearer than {} kPa to a limit; {} solves held by a bound\n  time of a solve: median {}, 99 % below {}, worst {}\n",
            short(margin / KPA),
            self.held,
            duration(self.median_time()),
            duration(share(&self.time, 0.99)),
            duration(greatest(&self.time))
        )
    }

    /// The numbers for programs.
    pub fn json(&self) -> Value {
        let margin = self.margin.iter().copied().fold(f64::INFINITY, f64::min);
        json!({
            "solves": self.solves(), "reached": self.reached, "unreachable": self.unreachable, "refused": self.refused,
            "position_error_rms_mm": root_mean_square(&self.position) / MM,
            "position_error_max_mm": greatest(&self.position) / MM,
            "rotation_error_rms_deg": (!self.rotation.is_empty()).then(|| root_mean_square(&self.rotation) / DEG),
            "rotation_error_max_deg": (!self.rotation.is_empty()).then(|| greatest(&self.rotation) / DEG),
            "limit_margin_min_kpa": margin.is_finite().then_some(margin / KPA),
            "held_by_a_bound": self.held,
            "time_us": { "median": self.median_time() * 1e6, "p99": share(&self.time, 0.99) * 1e6, "max": greatest(&self.time) * 1e6 },
        })
    }
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// The least value that a share of the values does not exceed.
fn share(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_summed_up() {
        let mut statistics = RunStatistics::default();
        for (status, error) in [("reached", 3e-6), ("reached", 4e-6), ("unreachable", 5e-3)] {
            statistics.add(&SolveRecord {
                status: status.into(),
                position_residual: error,
                rotation_residual: f64::NAN,
                limit_margin: 1e4,
                duration: 1e-4,
                ..SolveRecord::default()
            });
        }
        assert_eq!(statistics.summary(), "2 of 3 targets reached, 1 out of reach");
        assert_eq!(statistics.exit(), Exit::Unreachable);
        assert_eq!(statistics.json()["position_error_max_mm"], 5.0);
        assert!(statistics.json()["rotation_error_max_deg"].is_null());
        assert!(statistics.table().contains("never nearer than 10.00 kPa"), "{}", statistics.table());
    }

    #[test]
    fn a_share_of_the_values() {
        let values: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!((share(&values, 0.5), share(&values, 0.99), share(&values, 1.0)), (50.0, 99.0, 100.0));
        assert_eq!((share(&[], 0.5), root_mean_square(&[3.0, 4.0])), (0.0, 12.5f64.sqrt()));
    }
}
