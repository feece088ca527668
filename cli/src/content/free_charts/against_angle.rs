//! Deformations against the winding angle at several pressures (the paper's Fig. 4), and two angles that stand out.

use super::{
    MOST_CURVES,
    quantity::{QUANTITIES, STRETCH, TWIST},
    slice::{Slice, plain, state_at},
    spread,
};
use crate::plot::{Chart, Mark, Picture, Series};
use actuator::units::KPA;

const ANGLE: &str = "winding angle (° from hoop)";

/// One chart a quantity, and one of the angles that stand out; none where the map has fewer than three angles.
pub fn charts(slice: &Slice<'_>) -> Vec<(String, Picture)> {
    let angles = slice.angles_deg();
    if angles.len() < 3 {
        return vec![];
    }
    let axis = slice.angle_axis();
    let shown: Vec<f64> = isobars(&slice.map.pressures);
    let name = &slice.map.source.0;
    let mut charts = vec![];
    for quantity in &QUANTITIES {
        let mut chart = Chart::new(format!("{name}: {}", quantity.name), ANGLE, quantity.label);
        chart.subtitle = slice.told(&[axis]);
        chart.legend = "pressure\n(kPa)".into();
        let (mut ends, mut marked) = (vec![], vec![]);
        for (colour, pressure) in shown.iter().enumerate() {
            let curve = curve(slice, *pressure, quantity.of);
            marked.extend(match quantity.stem {
                stem if stem == STRETCH.stem => zero_extension(&curve).map(|angle| (angle, 1.0)),
                stem if stem == TWIST.stem => greatest(&curve),
                _ => None,
            });
            // Where the next angle's path ends below this pressure.
            let stops = |i: usize| {
                slice
                    .path(&[(axis, i)])
                    .and_then(|path| path.limit_pressure())
                    .is_some_and(|limit| limit < *pressure)
            };
            for (i, (angle, value)) in curve.iter().enumerate().filter(|(_, point)| point.1.is_finite()) {
                if (i > 0 && stops(i - 1)) || (i + 1 < curve.len() && stops(i + 1)) {
                    ends.push((colour, (*angle, *value)));
                }
            }
            let series = Series::new(plain(pressure / KPA), Mark::Line, curve);
            chart = chart.with(series.coloured(colour));
        }
        let any_end = !ends.is_empty();
        for (colour, end) in ends {
            chart = chart.with(Series::new("", Mark::Rings, vec![end]).coloured(colour));
        }
        if !marked.is_empty() {
            let what = if quantity.stem == TWIST.stem { "greatest" } else { "zero extension" };
            chart = chart.with(Series::new(what, Mark::Points, marked).coloured(7));
        }
        if any_end {
            chart = chart.with(Series::new("limit ahead", Mark::Rings, vec![]).coloured(6));
        }
        charts.push((format!("{}-over-winding-angle", quantity.stem), chart.into()));
    }
    charts.extend(outstanding(slice));
    charts
}

/// The angles of zero extension and of greatest twist against pressure.
fn outstanding(slice: &Slice<'_>) -> Option<(String, Picture)> {
    let pressures = slice.map.pressures.iter().filter(|pressure| **pressure > 0.0);
    let (mut zero, mut most) = (vec![], vec![]);
    for pressure in pressures {
        let kpa = pressure / KPA;
        zero.extend(zero_extension(&curve(slice, *pressure, STRETCH.of)).map(|angle| (kpa, angle)));
        most.extend(greatest(&curve(slice, *pressure, TWIST.of)).map(|(angle, _)| (kpa, angle)));
    }
    if zero.is_empty() && most.is_empty() {
        return None;
    }
    let title = format!("{}: angles of zero extension and of greatest twist", slice.map.source.0);
    let mut chart = Chart::new(title, "pressure (kPa)", ANGLE);
    chart.subtitle = slice.told(&[slice.angle_axis()]);
    for (place, (what, points)) in
        [("zero extension", zero), ("greatest twist", most)].into_iter().enumerate()
    {
        if !points.is_empty() {
            chart = chart.with(Series::new(what, Mark::Line, points).coloured(place));
        }
    }
    Some(("angles-of-zero-extension-and-greatest-twist".into(), chart.into()))
}

/// Pressures (Pa) to show: multiples of a round step, or else spread evenly.
fn isobars(pressures: &[f64]) -> Vec<f64> {
    let above: Vec<f64> = pressures.iter().copied().filter(|pressure| *pressure > 0.0).collect();
    if above.len() < MOST_CURVES {
        return above;
    }
    let multiples = |step: f64| -> Vec<f64> {
        let is = |pressure: &f64| (pressure / step - (pressure / step).round()).abs() < 1e-6;
        above.iter().copied().filter(is).collect()
    };
    let steps = [1.0, 2.0, 5.0, 10.0, 20.0, 25.0, 50.0, 100.0, 200.0].map(|step| multiples(step * KPA));
    let round = steps.into_iter().find(|shown| (4..MOST_CURVES).contains(&shown.len()));
    round.unwrap_or_else(|| spread(above.len(), MOST_CURVES - 1).into_iter().map(|i| above[i]).collect())
}

/// A quantity over the angles (degrees) at a pressure; not a number where there is no state.
fn curve(slice: &Slice<'_>, pressure: f64, of: fn(&actuator::FreeState) -> f64) -> Vec<(f64, f64)> {
    let value = |i: usize| {
        let path = slice.path(&[(slice.angle_axis(), i)])?;
        state_at(path, pressure).map(of)
    };
    slice
        .angles_deg()
        .into_iter()
        .enumerate()
        .map(|(i, angle)| (angle, value(i).unwrap_or(f64::NAN)))
        .collect()
}

/// Value at `x` between points `i` and `i + 1`: of the cubic through them and their next ones, as many as there are.
fn between(curve: &[(f64, f64)], i: usize, x: f64) -> f64 {
    let from = if i > 0 && curve[i - 1].1.is_finite() { i - 1 } else { i };
    let to = if i + 2 < curve.len() && curve[i + 2].1.is_finite() { i + 3 } else { i + 2 };
    let near = &curve[from..to];
    let weight = |k: usize| -> f64 {
        let others = near.iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, other)| (x - other.0) / (near[k].0 - other.0)).product()
    };
    near.iter().enumerate().map(|(k, point)| point.1 * weight(k)).sum()
}

/// Where the stretch falls through one: the angle at which a FREE neither lengthens nor shortens. `None` where it does not in the map.
fn zero_extension(curve: &[(f64, f64)]) -> Option<f64> {
    let i = curve.windows(2).position(|pair| pair[0].1 > 1.0 && pair[1].1 <= 1.0)?;
    let (mut low, mut high) = (curve[i].0, curve[i + 1].0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        match between(curve, i, middle) > 1.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(0.5 * (low + high))
}

/// Angle and value of the greatest magnitude; `None` where it is at an end of the map or next to a limit, where more may lie beyond.
fn greatest(curve: &[(f64, f64)]) -> Option<(f64, f64)> {
    let finite = curve.iter().enumerate().filter(|(_, point)| point.1.is_finite());
    let (most, at) = finite.max_by(|a, b| a.1.1.abs().total_cmp(&b.1.1.abs()))?;
    let inside =
        most > 0 && most + 1 < curve.len() && curve[most - 1].1.is_finite() && curve[most + 1].1.is_finite();
    if !inside || at.1 == 0.0 {
        return None;
    }
    let value = |x: f64| between(curve, if x < at.0 { most - 1 } else { most }, x);
    let (mut low, mut high) = (curve[most - 1].0, curve[most + 1].0);
    for _ in 0..100 {
        let third = (high - low) / 3.0;
        match value(low + third).abs() < value(high - third).abs() {
            true => low += third,
            false => high -= third,
        }
    }
    let angle = 0.5 * (low + high);
    Some((angle, value(angle)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outstanding_angles_are_found_between_the_nodes() {
        let sampled = |of: fn(f64) -> f64| -> Vec<(f64, f64)> {
            (1..=8).map(|i| 10.0 * f64::from(i)).map(|angle| (angle, of(angle))).collect()
        };
        // Zero at 54.3, and at 90.
        let stretch = sampled(|angle| {
            1.0 + 0.1 * (angle - 54.3).to_radians().sin() * (angle - 90.0).to_radians().sin()
        });
        assert!((zero_extension(&stretch).unwrap() - 54.3).abs() < 0.02, "{:?}", zero_extension(&stretch));
        // Greatest at 33.
        let twist = sampled(|angle| -2.0 * (1.5 * (angle - 33.0)).to_radians().cos());
        let (angle, value) = greatest(&twist).unwrap();
        assert!((angle - 33.0).abs() < 0.2 && (value + 2.0).abs() < 1e-3, "{angle} {value}");
        // At an end, or where the neighbour's path has ended, nothing is known.
        assert_eq!(greatest(&sampled(|angle| angle)), None);
        let mut ended = twist.clone();
        ended[3].1 = f64::NAN;
        assert_eq!(greatest(&ended), None);
        assert_eq!(zero_extension(&sampled(|_| 1.2)), None);
    }

    #[test]
    fn pressures_shown_are_round_and_few() {
        let grid = |count: u32, step: f64| (0..=count).map(|i| f64::from(i) * step * KPA).collect::<Vec<_>>();
        let kpa = |pressures: Vec<f64>| pressures.iter().map(|p| (p / KPA).round()).collect::<Vec<_>>();
        assert_eq!(kpa(isobars(&grid(70, 1.0))), [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0]);
        assert_eq!(kpa(isobars(&grid(3, 20.0))), [20.0, 40.0, 60.0]);
        let odd = isobars(&grid(60, 1.137));
        assert!(odd.len() < MOST_CURVES && odd.len() > 3, "{odd:?}");
    }
}
