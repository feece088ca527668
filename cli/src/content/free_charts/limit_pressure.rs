//! The greatest pressure that has an equilibrium, against the winding angle or another axis.

use super::{MOST_CURVES, slice::Slice, spread};
use crate::plot::{Chart, Mark, Picture, Series};
use actuator::units::KPA;

/// Over the winding angle, one chart for each other axis; of one angle only, over each other axis. None where no limit was met.
pub fn charts(slice: &Slice<'_>) -> Vec<(String, Picture)> {
    let over_angles = slice.varied().contains(&slice.angle_axis());
    let limit = |at: &[(usize, usize)]| Some(slice.path(at)?.limit_pressure()? / KPA);
    let chart = |across: usize, by: Option<usize>| {
        let across_axis = &slice.map.axes[across];
        let title = format!("{}: greatest pressure that has an equilibrium", slice.map.source.0);
        let mut chart = Chart::new(title, across_axis.parameter.label(), "limit pressure (kPa)");
        let shown: Vec<usize> = by.into_iter().chain([across]).collect();
        chart.subtitle = slice.told(&shown);
        chart.legend = by.map_or_else(String::new, |by| slice.head(by));
        let places = by.map_or_else(
            || vec![None],
            |by| spread(slice.map.axes[by].values.len(), MOST_CURVES).into_iter().map(Some).collect(),
        );
        for place in places {
            let at = |k: usize| -> Vec<(usize, usize)> {
                by.zip(place).into_iter().chain([(across, k)]).collect()
            };
            let values = across_axis.values.iter().map(|value| value / across_axis.parameter.unit());
            let points = values.enumerate().map(|(k, value)| (value, limit(&at(k)).unwrap_or(f64::NAN)));
            let name = by.zip(place).map_or_else(String::new, |(by, place)| slice.value(by, place));
            chart = chart.with(Series::new(name, Mark::LinePoints, points.collect()));
        }
        let any = chart.series.iter().any(|series| series.runs().next().is_some());
        let stem = match (over_angles, by) {
            (true, None) => "limit-pressure".to_owned(),
            (true, Some(by)) => format!("limit-pressure-by-{}", slice.stem(by)),
            (false, _) => format!("limit-pressure-over-{}", slice.stem(across)),
        };
        any.then(|| (stem, Picture::from(chart)))
    };
    let parameters = slice.parameters();
    match (over_angles, parameters.is_empty()) {
        (true, true) => chart(slice.angle_axis(), None).into_iter().collect(),
        (true, false) => {
            parameters.into_iter().filter_map(|by| chart(slice.angle_axis(), Some(by))).collect()
        }
        (false, _) => parameters.into_iter().filter_map(|across| chart(across, None)).collect(),
    }
}
