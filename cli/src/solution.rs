//! What a solve found, for programs and for people.

use crate::table::{Table, short};
use actuator::units::{DEG, KPA, MM};
use control::{Solution, Status};
use serde_json::{Value, json};

/// The answer of `solve --json`; where there are no pressures, their lists are empty and their numbers null.
pub fn json(solution: &Solution, seconds: f64) -> Value {
    let answer = solution.answer.as_ref();
    let pose = answer.map(control::Answer::pose);
    json!({
        "status": solution.status,
        "pressures_kpa": answer.map_or(Vec::new(), |answer| kpa(&answer.pressures)),
        "pose": pose.map(|pose| json!({
            "position_mm": (pose.position / MM).as_slice(), "rotation_wxyz": pose.wxyz(),
        })),
        "position_error_mm": answer.map(|answer| answer.position_error / MM),
        "rotation_error_deg": answer.and_then(|answer| answer.rotation_error).map(|error| error / DEG),
        "active_bounds": answer.map_or(Vec::new(), bounds),
        "limit_margin_kpa": answer.map(|answer| answer.limit_margin / KPA),
        "iterations": solution.iterations,
        "time_us": seconds * 1e6,
        "reason": solution.reason,
    })
}

/// The same as a table.
pub fn text(solution: &Solution, seconds: f64) -> String {
    let Some(answer) = &solution.answer else {
        return format!("refused: {}\n", solution.reason);
    };
    let mut text = match solution.status {
        Status::Reached => "reached\n".to_owned(),
        Status::Unreachable => format!("unreachable, the nearest pose is given: {}\n", solution.reason),
        Status::Refused => format!("refused: {}\n", solution.reason),
    };
    let (pose, chart) = (answer.pose(), &answer.chart);
    let listed = |values: &[f64], decimals: usize| {
        values.iter().map(|value| format!("{value:.decimals$}")).collect::<Vec<_>>().join(", ")
    };
    let mut table = Table::new(["<", "<"]);
    let mut row = |name: &str, value: String| table.row([name.to_owned(), value]);
    row("pressures", format!("{} kPa", listed(&kpa(&answer.pressures), 3)));
    row("position", format!("{} mm", listed((pose.position / MM).as_slice(), 3)));
    row("rotation (w, x, y, z)", listed(&pose.wxyz(), 5));
    row(
        "that is",
        format!("twist {:.2}°, bend {:.2}°", chart.twist / DEG, chart.bend[0].hypot(chart.bend[1]) / DEG),
    );
    row("off the target", format!("{} mm", short(answer.position_error / MM)));
    if let Some(error) = answer.rotation_error {
        row("rotation off", format!("{}°", short(error / DEG)));
    }
    let held = bounds(answer);
    row("bounds that hold it", if held.is_empty() { "none".into() } else { held.join(", ") });
    row("nearest limit", format!("{} kPa away", short(answer.limit_margin / KPA)));
    row("work", format!("{} iterations, {}", solution.iterations, crate::table::duration(seconds)));
    text += &table.text();
    text
}

/// Pascals as kilopascals, without the dust of the conversion.
pub fn kpa(pressures: &[f64]) -> Vec<f64> {
    pressures.iter().map(|pressure| pressure / KPA).collect()
}

fn bounds(answer: &control::Answer) -> Vec<String> {
    answer.active_bounds.iter().map(ToString::to_string).collect()
}
