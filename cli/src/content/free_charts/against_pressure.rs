//! Deformations against pressure, one curve a value of an axis: winding angles (the paper's Figs. 3 and 4), stiffnesses (Fig. 6).

use super::{MOST_CURVES, quantity::QUANTITIES, slice::Slice, spread};
use crate::plot::{Chart, Mark, Picture, Series};
use actuator::units::KPA;

/// One chart a quantity and axis; of a map without such an axis the only curve.
pub fn charts(slice: &Slice<'_>) -> Vec<(String, Picture)> {
    let mut axes = slice.varied();
    if axes.is_empty() {
        axes.push(slice.angle_axis());
    }
    let each = axes.into_iter().flat_map(|axis| QUANTITIES.iter().map(move |quantity| (axis, quantity)));
    each.map(|(axis, quantity)| {
        let title = format!("{}: {}", slice.map.source.0, quantity.name);
        let mut chart = Chart::new(title, "pressure (kPa)", quantity.label);
        chart.subtitle = slice.told(&[axis]);
        chart.legend = slice.head(axis);
        let [mut limits, mut middles, mut unstable] = [false; 3];
        for (colour, place) in spread(slice.map.axes[axis].values.len(), MOST_CURVES).into_iter().enumerate()
        {
            let Some(path) = slice.path(&[(axis, place)]) else { continue };
            let point = |state: &actuator::FreeState| (state.pressure / KPA, (quantity.of)(state));
            let points = path.states.iter().map(point).collect();
            let add = |chart: Chart, name: String, mark: Mark, points: Vec<(f64, f64)>| {
                chart.with(Series::new(name, mark, points).coloured(colour))
            };
            chart = add(chart, slice.value(axis, place), Mark::Line, points);
            let middle = |state: &actuator::FreeState| {
                Some((state.pressure / KPA, quantity.of_middle?(&state.middle?)))
            };
            let middle: Vec<_> = path.states.iter().filter_map(middle).collect();
            if !middle.is_empty() {
                middles = true;
                chart = add(chart, String::new(), Mark::Dashed, middle);
            }
            if !path.beyond.is_empty() {
                unstable = true;
                let beyond = path.states.last().into_iter().chain(&path.beyond).map(point).collect();
                chart = add(chart, String::new(), Mark::Dashed, beyond);
            }
            if let (Some(_), Some(state)) = (path.limit_pressure(), path.states.last()) {
                limits = true;
                chart = add(chart, String::new(), Mark::Rings, vec![point(state)]);
            }
        }
        let explained = [
            (middles, "middle", Mark::Dashed),
            (unstable, "unstable", Mark::Dashed),
            (limits, "limit point", Mark::Rings),
        ];
        for (_, name, mark) in explained.into_iter().filter(|(is, ..)| *is) {
            chart = chart.with(Series::new(name, mark, vec![]).coloured(6));
        }
        (format!("{}-by-{}", quantity.stem, slice.stem(axis)), chart.into())
    })
    .collect()
}
