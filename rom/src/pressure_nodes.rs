use crate::LIMIT_MARGIN;
use std::f64::consts::PI;

/// Share of cosine spacing in the placing of nodes: a not-a-knot spline errs most at the ends of its axis.
const END_SHARE: f64 = 0.4;
/// Exponent m of the placing p = L (1 - (1 - v)^m) under a limit pressure L. The deformation behaves as sqrt(1 - p/L), whose fourth
/// derivative an even spread of the spline's error answers with m = 8; m = 4 is as good for it and kinder to what is smooth in p.
const FOLD_EXPONENT: f64 = 4.0;

/// Pressures (Pa) from zero to `max` at which a module's map is best computed for a spline to be laid through it: `count` of them,
/// closer at both ends and, where the FREE has a limit pressure (Pa), towards it.
///
/// Against even nodes the worst error of a spline through nine of them is 20 times smaller at `max` = 0.92 of the limit, 7 times at
/// 0.73, twice to five times far from any. Nearer to the limit than the margin that models keep, the spacing is that of the margin.
pub fn recommended_pressure_nodes(max: f64, limit: Option<f64>, count: usize) -> Vec<f64> {
    let last = count.saturating_sub(1).max(1);
    let place = |node: usize| {
        if node == last {
            return max;
        }
        let u = node as f64 / last as f64;
        let v = (1.0 - END_SHARE) * u + 0.5 * END_SHARE * (1.0 - (PI * u).cos());
        match limit {
            None => max * v,
            Some(limit) => {
                // What is left of the limit at the greatest pressure; p = max at v = 1.
                let rest = (1.0 - max / limit).max(LIMIT_MARGIN);
                let at = 1.0 - v * (1.0 - rest.powf(1.0 / FOLD_EXPONENT));
                max * (1.0 - at.powf(FOLD_EXPONENT)) / (1.0 - rest)
            }
        }
    };
    (0..count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpolation::interpolate;

    #[test]
    fn they_rise_from_zero_to_the_greatest_pressure() {
        for limit in [None, Some(7e4), Some(69e3), Some(50e3), Some(1e6)] {
            for count in 2..12 {
                let nodes = recommended_pressure_nodes(68.9e3, limit, count);
                assert_eq!((nodes.len(), nodes[0], nodes[count - 1]), (count, 0.0, 68.9e3));
                assert!(nodes.windows(2).all(|pair| pair[1] - pair[0] > 100.0), "{limit:?}: {nodes:?}");
            }
        }
        assert_eq!(recommended_pressure_nodes(68.9e3, None, 1), [0.0]);
        assert!(recommended_pressure_nodes(68.9e3, None, 0).is_empty());
    }

    #[test]
    fn they_serve_a_spline_better_than_even_ones() {
        let (max, count) = (68.9e3, 9);
        let worst = |nodes: Vec<f64>, function: &dyn Fn(f64) -> f64| {
            let table = nodes.iter().map(|p| [function(*p)]).collect();
            let spline = interpolate(vec![nodes], table).unwrap();
            let error = |k: u32| {
                let p = max * f64::from(k) / 1000.0;
                (spline.partial(&[p], &[0]).unwrap()[0] - function(p)).abs()
            };
            (0..=1000).map(error).fold(0.0, f64::max)
        };
        let even = || (0..count).map(|i| max * i as f64 / (count - 1) as f64).collect::<Vec<_>>();
        for (limit, gain) in [(75e3, 20.0), (95e3, 7.0), (140e3, 4.0)] {
            let fold = |p: f64| 1.0 - (1.0 - p / limit).sqrt();
            let bent = |p: f64| (3.0 * fold(p)).sin();
            for function in [&fold as &dyn Fn(f64) -> f64, &bent] {
                let graded = worst(recommended_pressure_nodes(max, Some(limit), count), function);
                assert!(gain * graded < 1.25 * worst(even(), function), "limit {limit}: {graded}");
            }
        }
        let smooth = |p: f64| (2.0 * p / max).sin();
        assert!(2.0 * worst(recommended_pressure_nodes(max, None, count), &smooth) < worst(even(), &smooth));
    }
}
