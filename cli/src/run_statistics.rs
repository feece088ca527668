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
    missed: Vec<Stretch>,
    last_was_missed: bool,
}

/// Successive targets that were not reached.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    /// Times of the first and the last, s.
    from: f64,
    to: f64,
    /// Number of targets.
    targets: usize,
    /// Greatest distance and angle from a target, m and rad; NaN where none was measured.
    position: f64,
    rotation: f64,
    /// Bounds that held an answer, each once, and what the solver said of the target farthest off.
    held_by: Vec<String>,
    reason: String,
}

impl Stretch {
    fn add(&mut self, solve: &SolveRecord) {
        self.to = solve.time;
        self.targets += 1;
        // `max` passes over NaN.
        if self.reason.is_empty() || solve.position_residual > self.position {
            self.reason.clone_from(&solve.reason);
        }
        self.position = self.position.max(solve.position_residual);
        self.rotation = self.rotation.max(solve.rotation_residual);
        for bound in &solve.active_bound {
            if !self.held_by.contains(bound) {
                self.held_by.push(bound.clone());
                self.held_by.sort();
            }
        }
    }

    fn json(&self) -> Value {
        let number = |value: f64, unit: f64| value.is_finite().then_some(value / unit);
        json!({
            "from_s": self.from, "to_s": self.to, "targets": self.targets, "held_by": self.held_by, "reason": self.reason,
            "position_error_max_mm": number(self.position, MM), "rotation_error_max_deg": number(self.rotation, DEG),
        })
    }
}

/// Stretches that the table shows; the JSON has them all.
const SHOWN: usize = 8;

impl RunStatistics {
    /// Counts a solve.
    pub fn add(&mut self, solve: &SolveRecord) {
        match solve.status.as_str() {
            "reached" => self.reached += 1,
            "refused" => self.refused += 1,
            _ => self.unreachable += 1,
        }
        let is_missed = solve.status != "reached";
        if is_missed {
            if !self.last_was_missed {
                self.missed.push(Stretch {
                    from: solve.time,
                    to: solve.time,
                    targets: 0,
                    position: f64::NAN,
                    rotation: f64::NAN,
                    held_by: Vec::new(),
                    reason: String::new(),
                });
            }
            if let Some(stretch) = self.missed.last_mut() {
                stretch.add(solve);
            }
        }
        self.last_was_missed = is_missed;
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
        let missed = self.missed_table();
        format!(
            "{text}{missed}\n  pressures never nearer than {} kPa to a limit; {} solves held by a bound\n  time of a solve: median {}, 99 % below {}, worst {}\n",
            short(margin / KPA),
            self.held,
            duration(self.median_time()),
            duration(share(&self.time, 0.99)),
            duration(greatest(&self.time))
        )
    }

    /// When targets were missed, by how much, and what held the pressures there.
    fn missed_table(&self) -> String {
        if self.missed.is_empty() {
            return String::new();
        }
        let turned = !self.rotation.is_empty();
        let mut head = vec!["<not reached (s)", "targets", "off by (mm)"];
        head.extend(turned.then_some("off by (°)"));
        head.push("<held by");
        let mut table = Table::with_head(head.into_iter().map(str::to_owned).collect());
        for stretch in self.missed.iter().take(SHOWN) {
            let mut row = vec![
                if stretch.from == stretch.to {
                    format!("{:.3}", stretch.from)
                } else {
                    format!("{:.3} to {:.3}", stretch.from, stretch.to)
                },
                stretch.targets.to_string(),
                short(stretch.position / MM),
            ];
            row.extend(turned.then(|| short(stretch.rotation / DEG)));
            row.push(if !stretch.held_by.is_empty() {
                stretch.held_by.join(", ")
            } else if stretch.position.is_finite() {
                "the shape of the reachable set".into()
            } else {
                stretch.reason.clone()
            });
            table.row_of(row);
        }
        let mut text = format!("\n{}", table.text());
        if self.missed.len() > SHOWN {
            text += &format!("  and {} more stretches\n", self.missed.len() - SHOWN);
        }
        let held = |part: &str| {
            self.missed.iter().flat_map(|stretch| &stretch.held_by).any(|bound| bound.contains(part))
        };
        if held("_rate_") {
            text += "  _rate_up, _rate_down: the pressure cannot follow faster (limits.pressure_rate_kpa_s); give the waypoints more time there\n";
        }
        if held("_min") || held("_max") {
            text += "  _min, _max: the pressure is at its bound; where nothing but such bounds holds the tip, the path lies outside what it reaches\n";
        }
        text
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
            "not_reached": self.missed.iter().map(Stretch::json).collect::<Vec<_>>(),
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
    fn missed_targets_are_told_by_time_and_bound() {
        let mut statistics = RunStatistics::default();
        let ticks = [
            (0.0, 1e-6, ""),
            (0.1, 1e-3, "p2_rate_up"),
            (0.2, 2e-3, "p1_min"),
            (0.3, 1e-6, "p1_min"),
            (0.4, 3e-3, ""),
        ];
        for (time, error, bound) in ticks {
            let missed = error > 1e-4;
            statistics.add(&SolveRecord {
                time,
                status: if missed { "unreachable" } else { "reached" }.into(),
                reason: if missed { format!("off at {time}") } else { String::new() },
                active_bound: if bound.is_empty() { vec![] } else { vec![bound.into()] },
                position_residual: error,
                rotation_residual: f64::NAN,
                limit_margin: 1e4,
                duration: 1e-4,
                ..SolveRecord::default()
            });
        }
        let json = &statistics.json()["not_reached"];
        assert_eq!(json.as_array().map(Vec::len), Some(2));
        assert_eq!(
            (&json[0]["from_s"], &json[0]["to_s"], &json[0]["targets"]),
            (&json!(0.1), &json!(0.2), &json!(2))
        );
        assert_eq!(
            (&json[0]["held_by"], &json[0]["reason"]),
            (&json!(["p1_min", "p2_rate_up"]), &json!("off at 0.2"))
        );
        assert_eq!(
            (&json[1]["position_error_max_mm"], &json[1]["rotation_error_max_deg"]),
            (&json!(3.0), &Value::Null)
        );
        let table = statistics.table();
        for words in
            ["0.100 to 0.200", "p1_min, p2_rate_up", "pressure_rate_kpa_s", "0.400", "shape of the reachable"]
        {
            assert!(table.contains(words), "{words} is not in\n{table}");
        }
    }

    #[test]
    fn a_share_of_the_values() {
        let values: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!((share(&values, 0.5), share(&values, 0.99), share(&values, 1.0)), (50.0, 99.0, 100.0));
        assert_eq!((share(&[], 0.5), root_mean_square(&[3.0, 4.0])), (0.0, 12.5f64.sqrt()));
    }
}
