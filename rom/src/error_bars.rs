//! Error bars of a module's model that depend on the pressures.
//!
//! Their shape comes from the map: how badly each node is foretold by its neighbours along every axis. Their size comes from
//! states that were never fitted: half of the map's checks set the factor under which 95 of 100 of their errors stay (the
//! quantile of split conformal prediction, rank ceil(0.95 (n + 1))), the other half are only counted.

use crate::{
    BarCoverage, ErrorStatistics, ModuleErrors, ModuleModel, PoseModel, SplineGrid, interpolation::grid,
};
use actuator::ModuleMap;
use evaluator::multilinear;

/// Greatest number of neighbours that foretell a node: as many as a cubic takes.
const NEIGHBOURS: usize = 4;
/// Least scale, as a share of the mean: no error is nought.
const FLOOR: f64 = 0.05;

/// Scale of the errors of position (m) and rotation (rad) at every node: what the node's chart differs by from the polynomial through
/// its nearest neighbours with a state, summed over the axes, and the greatest of that among the nodes beside it.
pub(crate) fn scale(grid: &SplineGrid, chart: &[Option<[f64; 6]>]) -> Vec<[f64; 2]> {
    widened(grid, (0..grid.node_count()).map(|node| misses(grid, chart, node)).collect())
}

/// Of each node the greatest of its own numbers and those of the nodes beside it, and no less than a share of the mean.
pub(crate) fn widened<const OUT: usize>(grid: &SplineGrid, own: Vec<[f64; OUT]>) -> Vec<[f64; OUT]> {
    let floor: [f64; OUT] = std::array::from_fn(|output| {
        let mean = own.iter().map(|row| row[output]).sum::<f64>() / own.len() as f64;
        (FLOOR * mean).max(f64::MIN_POSITIVE)
    });
    (0..grid.node_count())
        .map(|node| {
            let mut greatest = own[node];
            for (axis, stride) in grid.axes().iter().zip(grid.strides()) {
                let place = node / stride % axis.nodes().len();
                let below = (place > 0).then(|| own[node - stride]);
                let above = (place + 1 < axis.nodes().len()).then(|| own[node + stride]);
                for beside in below.into_iter().chain(above) {
                    greatest = std::array::from_fn(|output| greatest[output].max(beside[output]));
                }
            }
            std::array::from_fn(|output| greatest[output].max(floor[output]))
        })
        .collect()
}

/// By how much neighbours miss a node in position (m) and rotation (rad), summed over the axes; zero for a node without a state.
fn misses(grid: &SplineGrid, chart: &[Option<[f64; 6]>], node: usize) -> [f64; 2] {
    let axes = (0..grid.axes().len()).map(|axis| miss_along(grid, chart, node, axis));
    axes.fold([0.0; 2], |sum, miss| [sum[0] + miss[0], sum[1] + miss[1]])
}

/// By how much its neighbours along one axis miss a node of a module's map.
fn miss_along(grid: &SplineGrid, chart: &[Option<[f64; 6]>], node: usize, axis: usize) -> [f64; 2] {
    let (Some(here), Some(off)) = (chart[node], off_neighbours(grid, chart, node, axis)) else {
        return [0.0; 2];
    };
    let [twist, bend_x, bend_y, x, y, z] = off;
    // The chart's position stands in a frame that turns by half the twist.
    let arm = here[3].hypot(here[4]);
    [x.hypot(y).hypot(z) + 0.5 * arm * twist.abs(), twist.abs() + bend_x.hypot(bend_y)]
}

/// What a node's numbers are more than those of the polynomial through its nearest neighbours along one axis; `None` for a node
/// without numbers, or without neighbours that have any.
pub(crate) fn off_neighbours<const OUT: usize>(
    grid: &SplineGrid,
    table: &[Option<[f64; OUT]>],
    node: usize,
    axis: usize,
) -> Option<[f64; OUT]> {
    let mut off = table[node]?;
    let (nodes, stride) = (grid.axes()[axis].nodes(), grid.strides()[axis]);
    let place = node / stride % nodes.len();
    let line = node - place * stride;
    let mut near: Vec<(f64, [f64; OUT])> = (0..nodes.len())
        .filter(|other| *other != place)
        .filter_map(|other| Some((nodes[other], table[line + other * stride]?)))
        .collect();
    let at = nodes[place];
    near.sort_by(|a, b| (a.0 - at).abs().total_cmp(&(b.0 - at).abs()));
    near.truncate(NEIGHBOURS);
    for (x, values) in &near {
        // Lagrange's polynomial of this neighbour, at the node.
        let others = near.iter().filter(|(y, _)| y != x);
        let weight: f64 = others.map(|(y, _)| (at - y) / (x - y)).product();
        for (off, value) in off.iter_mut().zip(values) {
            *off -= weight * value;
        }
    }
    (!near.is_empty()).then_some(off)
}

/// How badly (m, root of the mean square) the positions of a map's nodes are foretold by their neighbours along each axis: where a finer
/// axis would help. Zero for a map whose axes are none.
pub fn axis_misses(map: &ModuleMap) -> Vec<f64> {
    let Ok(grid) = grid(map.pressures.clone()) else { return vec![0.0; map.pressures.len()] };
    let chart: Vec<_> = map.states.iter().map(|state| Some(state.as_ref()?.chart.to_array())).collect();
    let along = |axis: usize| {
        let squares = (0..chart.len()).map(|node| miss_along(&grid, &chart, node, axis)[0].powi(2));
        (squares.sum::<f64>() / chart.len() as f64).sqrt()
    };
    if chart.len() == grid.node_count() {
        (0..map.pressures.len()).map(along).collect()
    } else {
        vec![0.0; map.pressures.len()]
    }
}

/// Factor under which 95 of 100 ratios stay; the greatest where they are too few to tell.
pub(crate) fn factor(mut ratios: Vec<f64>) -> f64 {
    ratios.sort_by(f64::total_cmp);
    let rank = (95 * (ratios.len() + 1)).div_ceil(100).clamp(1, ratios.len());
    ratios[rank - 1]
}

/// The model with its errors on the map's checks, and with error bars where there are checks to set them by.
pub(crate) fn judged(model: ModuleModel, map: &ModuleMap, scale: Vec<[f64; 2]>) -> ModuleModel {
    let mut into = model.workspace();
    let mut errors = ModuleErrors::default();
    let mut found: Vec<([f64; 2], [f64; 2])> = Vec::new();
    let mut worst = -1.0;
    for check in &map.checks {
        if check.state.negative_pivots > 0 {
            errors.unstable += 1;
            continue;
        }
        if check.pressures.len() != model.domain().len()
            || model.evaluate(&check.pressures, &mut into).is_err()
        {
            errors.outside += 1;
            continue;
        }
        let (ours, theirs) = (into.chart.to_pose(), check.state.chart.to_pose());
        let off = [(ours.position - theirs.position).norm(), ours.rotation_distance(&theirs)];
        if off[0] > worst {
            worst = off[0];
            errors.worst_at.clone_from(&check.pressures);
        }
        found.push((off, multilinear(model.splines().grid(), &scale, &check.pressures)));
    }
    let of = |output: usize| found.iter().map(|(off, _)| off[output]).collect::<Vec<f64>>();
    errors.position = ErrorStatistics::of(&of(0));
    errors.rotation = ErrorStatistics::of(&of(1));
    if found.is_empty() {
        return model.with_errors(None, errors);
    }
    let setting = |output: usize| {
        factor(found.iter().step_by(2).map(|(off, scale)| off[output] / scale[output]).collect())
    };
    let factors = [setting(0), setting(1)];
    let counted = || found.iter().skip(1).step_by(2);
    let within = |output: usize| {
        counted().filter(|(off, scale)| off[output] <= factors[output] * scale[output]).count()
    };
    errors.bars = BarCoverage { states: counted().count(), position: within(0), rotation: within(1) };
    let bars = scale.into_iter().map(|[position, rotation]| [factors[0] * position, factors[1] * rotation]);
    model.with_errors(Some(bars.collect()), errors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{PRESSURE_MAX, module_map, module_state};

    fn even(count: usize) -> Vec<f64> {
        (0..count).map(|i| PRESSURE_MAX * i as f64 / (count - 1) as f64).collect()
    }

    #[test]
    fn bars_hold_on_states_that_did_not_set_them_and_follow_the_error() {
        let model = ModuleModel::fit(&module_map(vec![even(7); 3], 400)).unwrap();
        let coverage = model.errors().bars;
        assert_eq!(coverage.states, 200);
        // 95 of 100 with a standard deviation of 1.5 in 200.
        assert!(coverage.position >= 182 && coverage.rotation >= 182, "{coverage:?}");
        let mut into = model.workspace();
        let mut error = |pressures: &[f64]| {
            model.evaluate(pressures, &mut into).unwrap();
            (into.chart.to_pose().position - module_state(pressures).chart.to_pose().position).norm()
        };
        // The synthetic map folds towards its limit: errors and bars grow there.
        let (low, high) = ([17e3, 18e3, 16e3], [64e3, 65e3, 63e3]);
        let bar = |pressures: &[f64]| model.splines().error_bars(pressures).unwrap()[0];
        assert!(error(&high) > 4.0 * error(&low) && bar(&high) > 4.0 * bar(&low));
    }

    #[test]
    fn the_rank_is_that_of_conformal_prediction() {
        assert_eq!(factor((1..=99).map(f64::from).collect()), 95.0);
        assert_eq!(factor((1..=19).map(f64::from).collect()), 19.0);
        assert_eq!(factor(vec![3.0, 1.0]), 3.0);
    }
}
