use super::Content;
use crate::{
    columns::{Cell, Columns},
    plot::{Chart, Mark, Picture, Series, thin},
    table::{Table, duration, short},
};
use actuator::units::MM;
use record::{Findings, Log, Quantity, Recording};
use serde_json::json;
use std::path::Path;

/// Points that a curve of a recording is drawn with.
const POINTS: usize = 1500;

/// A recording and what is irregular about it.
pub struct Inspected {
    pub recording: Recording,
    pub findings: Findings,
    /// What the file holds besides, in words.
    pub besides: Vec<String>,
}

impl From<Log> for Inspected {
    fn from(log: Log) -> Self {
        let topics = log.message_counts.iter().map(|(topic, count)| format!("{count} messages on {topic}"));
        let attached = [(log.rig_text.is_some(), "a rig"), (log.model.is_some(), "a model")];
        let attached = attached.iter().filter(|(is, _)| *is).map(|(_, what)| format!("{what} is attached"));
        let besides = topics.chain(attached).collect();
        Inspected { recording: log.recording, findings: log.findings, besides }
    }
}

impl Inspected {
    fn measured(&self) -> Vec<(Quantity, &[f64])> {
        let measured = |quantity: Quantity| Some((quantity, self.recording.channel(quantity)?.as_slice()));
        let columns = self.recording.quantities().into_iter().filter_map(measured);
        columns.filter(|(_, channel)| channel.iter().any(|value| value.is_finite())).collect()
    }

    fn seconds(&self) -> f64 {
        match (self.recording.time.first(), self.recording.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    fn against_time(&self, title: &str, label: &str, wanted: impl Fn(Quantity) -> bool) -> Option<Chart> {
        let mut chart = Chart::new(format!("{}: {title}", self.recording.name), "time (s)", label);
        for (quantity, channel) in self.measured().into_iter().filter(|(quantity, _)| wanted(*quantity)) {
            let points = self.recording.time.iter().zip(channel);
            let points = points.map(|(time, value)| (*time, value / quantity.unit())).collect();
            chart = chart.with(Series::new(quantity.stem(), Mark::Line, thin(points, POINTS)));
        }
        (!chart.series.is_empty()).then_some(chart)
    }
}

/// Least, mean and greatest of what was measured, and how many samples were not.
fn statistics(channel: &[f64], unit: f64) -> (f64, f64, f64, usize) {
    let finite: Vec<f64> =
        channel.iter().filter(|value| value.is_finite()).map(|value| value / unit).collect();
    let (low, high) =
        finite.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    (low, finite.iter().sum::<f64>() / finite.len() as f64, high, channel.len() - finite.len())
}

impl Content for Inspected {
    fn text(&self, path: &Path) -> String {
        let samples = self.recording.time.len();
        let rate = (samples.max(1) - 1) as f64 / self.seconds();
        let mut text = format!(
            "{}: recording \"{}\", {samples} samples over {} ({} a second)\n\n",
            path.display(),
            self.recording.name,
            duration(self.seconds()),
            short(rate)
        );
        let mut table = Table::new(["<column", "least", "mean", "greatest", "not measured"]);
        for (quantity, channel) in self.measured() {
            let (low, mean, high, missing) = statistics(channel, quantity.unit());
            table.row([quantity.column(), short(low), short(mean), short(high), missing.to_string()]);
        }
        text += &table.text();
        for line in &self.besides {
            text += &format!("\n  {line}");
        }
        if !self.besides.is_empty() {
            text += "\n";
        }
        match self.findings.is_empty() {
            true => text += "\n  nothing irregular found\n",
            false => text += &format!("\n  {}\n", self.findings.to_string().replace('\n', "\n  ")),
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let column = |(quantity, channel): (Quantity, &[f64])| {
            let (low, mean, high, missing) = statistics(channel, quantity.unit());
            json!({ "name": quantity.column(), "least": low, "mean": mean, "greatest": high, "not_measured": missing })
        };
        json!({
            "content": "recording", "name": self.recording.name, "samples": self.recording.time.len(),
            "seconds": self.seconds(), "columns": self.measured().into_iter().map(column).collect::<Vec<_>>(),
            "findings": self.findings.list.iter().map(|f| json!({
                "kind": format!("{:?}", f.kind), "channel": f.channel, "count": f.count, "message": f.message,
            })).collect::<Vec<_>>(),
            "besides": self.besides,
        })
    }

    fn columns(&self) -> Option<Columns> {
        let measured = self.measured();
        let names = measured.iter().map(|(quantity, _)| quantity.column());
        let mut columns = Columns::new(std::iter::once("t_s".to_owned()).chain(names), &[])
            .about("name", &self.recording.name);
        for (i, time) in self.recording.time.iter().enumerate() {
            let values = measured.iter().map(|(quantity, channel)| channel[i] / quantity.unit());
            let row: Vec<Cell> = std::iter::once(*time).chain(values).map(Cell::Number).collect();
            columns.push(&row);
        }
        Some(columns)
    }

    fn charts(&self) -> Vec<(String, Picture)> {
        let command = self.against_time("command", "pressure (kPa)", |q| matches!(q, Quantity::Command(_)));
        let pressure =
            self.against_time("measured", "pressure (kPa)", |q| matches!(q, Quantity::Pressure(_)));
        let position = self.against_time("tip", "position (mm)", |q| matches!(q, Quantity::Position(_)));
        let rotation = self.against_time("tip", "quaternion", |q| matches!(q, Quantity::Rotation(_)));
        let twist = self.against_time("twist", "twist (rad)", |q| q == Quantity::Twist);
        let extension = self.against_time("extension", "extension (mm)", |q| q == Quantity::Extension);
        let view = match (
            self.recording.channel(Quantity::Position(0)),
            self.recording.channel(Quantity::Position(1)),
        ) {
            (Some(x), Some(y)) if x.iter().any(|value| value.is_finite()) => {
                let points = x.iter().zip(y).map(|(x, y)| (x / MM, y / MM)).collect();
                let chart =
                    Chart::new(format!("{}: tip along the axis", self.recording.name), "x (mm)", "y (mm)");
                Some(Chart { equal_axes: true, ..chart }.with(Series::new("", Mark::Dots, points)))
            }
            _ => None,
        };
        let named = [
            ("command", command),
            ("pressure", pressure),
            ("position", position),
            ("rotation", rotation),
            ("twist", twist),
            ("extension", extension),
            ("view", view),
        ];
        named.into_iter().filter_map(|(stem, chart)| Some((stem.to_owned(), chart?.into()))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use record::Motion;

    #[test]
    fn only_what_was_measured_is_told() {
        let nan = vec![f64::NAN; 2];
        let recording = Recording {
            name: "two".into(),
            time: vec![0.0, 0.5],
            command: vec![vec![1e3, 2e3]],
            pressure: vec![],
            motion: Motion::Free {
                twist: vec![0.1, f64::NAN],
                extension: nan.clone(),
                outer_diameter: nan.clone(),
                torque: nan.clone(),
                force: nan,
            },
        };
        let inspected = Inspected { recording, findings: Findings::default(), besides: vec![] };
        assert_eq!(inspected.columns().unwrap().csv(), "t_s,p1_command_kpa,twist_rad\n0,1,0.1\n0.5,2,\n");
        let text = inspected.text(Path::new("two.csv"));
        assert!(
            text.contains("2 samples over 500 ms (2.000 a second)") && text.contains("nothing irregular"),
            "{text}"
        );
        assert_eq!(inspected.json()["columns"][1]["not_measured"], 1);
        assert_eq!(inspected.charts().len(), 2);
    }
}
