//! Charts of a FREE's map, of whatever axes it has.
//!
//! A chart shows the pressure or the winding angle and one more axis; all others stand at one value, the description's own or that next
//! to it, which the line under the title tells. Curves end where the states do, nothing is extrapolated.

mod against_angle;
mod against_pressure;
mod design_space;
mod limit_pressure;
mod quantity;
mod sensitivity;
mod slice;

use crate::plot::Picture;
use actuator::FreeMap;
use slice::Slice;
pub use slice::state_at;

/// Most curves of a chart: as many as there are colours to tell apart.
const MOST_CURVES: usize = 8;

/// Charts with the stems of their files.
pub fn all(map: &FreeMap) -> Vec<(String, Picture)> {
    let slice = Slice::of(map);
    let mut charts = against_pressure::charts(&slice);
    charts.extend(against_angle::charts(&slice));
    charts.extend(design_space::charts(&slice));
    charts.extend(sensitivity::chart(&slice));
    charts.extend(limit_pressure::charts(&slice));
    charts
}

/// Places of at most `most` of `count` values, evenly spread, the first and the last among them.
pub fn spread(count: usize, most: usize) -> Vec<usize> {
    let shown = count.min(most);
    (0..shown)
        .map(|k| if shown < 2 { 0 } else { (k * (count - 1) + (shown - 1) / 2) / (shown - 1) })
        .collect()
}

#[cfg(test)]
mod tests;
