//! How much the twist changes with the pressure, over pressure and winding angle: where a FREE is easy to control and where it is not
//! (the paper's Fig. 7 and its remark on steep responses).

use super::slice::Slice;
use crate::plot::{Field, Mark, Patch, Picture, Series};
use actuator::units::{DEG, KPA, MM};

/// Shares of the map left to either end of the colours: slopes go to infinity at a limit point and to zero along the tube.
const ENDS: [f64; 2] = [0.02, 0.95];

/// The field; none where the map has fewer than three angles.
pub fn chart(slice: &Slice<'_>) -> Option<(String, Picture)> {
    let angles = slice.angles_deg();
    if angles.len() < 3 {
        return None;
    }
    let edge = |i: usize| match i {
        0 => angles[0],
        i if i == angles.len() => angles[i - 1],
        i => 0.5 * (angles[i - 1] + angles[i]),
    };
    let (mut patches, mut limits) = (vec![], vec![]);
    for (i, angle) in angles.iter().enumerate() {
        let Some(path) = slice.path(&[(slice.angle_axis(), i)]) else { continue };
        for pair in path.states.windows(2) {
            let [from, to] = [pair[0].pressure / KPA, pair[1].pressure / KPA];
            let slope = (pair[1].twist_per_length - pair[0].twist_per_length) / DEG * MM / (to - from);
            if slope.is_finite() {
                let (low, high) = (edge(i), edge(i + 1));
                let corners = [(from, low), (to, low), (to, high), (from, high)];
                patches.push((corners, slope.abs(), (to - from) * (high - low)));
            }
        }
        if let Some(limit) = path.limit_pressure() {
            limits.push((limit / KPA, *angle));
        }
    }
    // The range of colours leaves out small shares of the area.
    let mut sorted: Vec<(f64, f64)> = patches.iter().map(|(_, value, area)| (*value, *area)).collect();
    sorted.retain(|(value, _)| *value > 0.0);
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = sorted.iter().map(|(_, area)| area).sum();
    let quantile = |share: f64| {
        let mut sum = 0.0;
        let reached = |(_, area): &&(f64, f64)| {
            sum += area;
            sum >= share * total
        };
        sorted.iter().find(reached).or(sorted.last()).map(|(value, _)| *value)
    };
    let range = quantile(ENDS[0])?..quantile(ENDS[1])?;
    let title = format!("{}: change of twist with pressure", slice.map.source.0);
    let mut field =
        Field::new(title, "pressure (kPa)", "winding angle (° from hoop)", "|dτ/dp| (°/mm per kPa)");
    field.subtitle = slice.told(&[slice.angle_axis()]);
    if !limits.is_empty() {
        field.subtitle += "; line: limit pressure";
    }
    field.equal_axes = false;
    field.logarithmic = Some(range);
    field.patches = patches.into_iter().map(|(corners, value, _)| Patch { corners, value }).collect();
    if !limits.is_empty() {
        field.lines.push(Series::new("", Mark::LinePoints, limits));
    }
    Some(("sensitivity-of-twist".into(), field.into()))
}
