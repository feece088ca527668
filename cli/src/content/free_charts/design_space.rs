//! What can be reached together: twist and stretch against expansion, for the least and the greatest value of another axis (the paper's
//! Fig. 7, rubber of half and full stiffness).

use super::{
    MOST_CURVES,
    quantity::{EXPANSION, STRETCH, TWIST},
    slice::{Slice, plain},
    spread,
};
use crate::plot::{Chart, Mark, Picture, Series};
use actuator::units::KPA;

/// Two charts for each axis beside the winding angle; none where the map has fewer than three angles.
pub fn charts(slice: &Slice<'_>) -> Vec<(String, Picture)> {
    let angle_axis = slice.angle_axis();
    let angles = slice.angles_deg();
    if angles.len() < 3 {
        return vec![];
    }
    let most = slice.map.pressures.last().copied().unwrap_or(0.0);
    let mut axes: Vec<Option<usize>> = slice.parameters().into_iter().map(Some).collect();
    if axes.is_empty() {
        axes.push(None);
    }
    let mut charts = vec![];
    for axis in axes {
        for quantity in [TWIST, STRETCH] {
            let title = format!(
                "{}: {} and expansion to {} kPa",
                slice.map.source.0,
                quantity.name,
                plain(most / KPA)
            );
            let mut chart = Chart::new(title, EXPANSION.label, quantity.label);
            let shown: Vec<usize> = axis.into_iter().chain([angle_axis]).collect();
            chart.subtitle = slice.told(&shown);
            chart.legend = axis.map_or_else(String::new, |axis| slice.head(axis));
            let places = axis.map_or_else(Vec::new, |axis| spread(slice.map.axes[axis].values.len(), 2));
            let families: Vec<Vec<(usize, usize)>> = match axis {
                Some(axis) => places.into_iter().map(|place| vec![(axis, place)]).collect(),
                None => vec![vec![]],
            };
            let mut limits = false;
            for (colour, at) in families.iter().enumerate() {
                let mut name =
                    at.first().map_or_else(String::new, |(axis, place)| slice.value(*axis, *place));
                for place in spread(angles.len(), MOST_CURVES) {
                    let at: Vec<_> = at.iter().copied().chain([(angle_axis, place)]).collect();
                    let Some(path) = slice.path(&at) else { continue };
                    let states = path.states.iter().filter(|state| state.pressure <= most * (1.0 + 1e-9));
                    let points: Vec<_> =
                        states.map(|state| ((EXPANSION.of)(state), (quantity.of)(state))).collect();
                    let ended = path.limit_pressure().is_some_and(|limit| limit <= most);
                    let end = points.last().copied();
                    let mut series =
                        Series::new(std::mem::take(&mut name), Mark::Line, points).coloured(colour);
                    if colour == 0 {
                        series.at_end = slice.value(angle_axis, place);
                    }
                    chart = chart.with(series);
                    if let Some(end) = end.filter(|_| ended) {
                        limits = true;
                        chart = chart.with(Series::new("", Mark::Rings, vec![end]).coloured(colour));
                    }
                }
            }
            if limits {
                chart = chart.with(Series::new("limit point", Mark::Rings, vec![]).coloured(6));
            }
            let stem = match axis {
                Some(axis) => format!("design-space-{}-by-{}", quantity.stem, slice.stem(axis)),
                None => format!("design-space-{}", quantity.stem),
            };
            charts.push((stem, chart.into()));
        }
    }
    charts
}
