//! As many pressures per FREE as a module's map needs for its fit to be as good as asked for.

use crate::failure::Failure;
use actuator::{ModuleMap, units::MM};
use rom::ModuleModel;

/// Pressures per FREE of the first map.
pub const FIRST: usize = 4;
/// Greatest number of pressures per FREE.
const MOST: usize = 25;
/// Greatest number of nodes of a map.
const MOST_NODES: usize = 200_000;
/// Share of the error asked for that the next map is laid out for.
const AIM: f64 = 0.7;

/// What is to be done after a map and its fit.
pub enum Next {
    /// The error (m, the 95th percentile on states never fitted) is small enough.
    Enough(f64),
    /// It is not, and a map of so many pressures per FREE comes next.
    Refine(f64, Vec<usize>),
    /// It is not, and a finer map would have too many nodes.
    TooMany(f64),
}

/// Judges a map by its fit. The error of splines falls with the fourth power of the spacing; each axis takes its part of it, as its
/// nodes are missed by their neighbours.
pub fn judge(map: &ModuleMap, target: f64) -> Result<Next, Failure> {
    let model = ModuleModel::fit(map).map_err(Failure::file)?;
    let errors = model.errors().position;
    if errors.count == 0 {
        return Err(Failure::refused(
            "no state for checks lies in the model's domain, so that its error is not known; give more --checks",
        ));
    }
    if errors.p95 <= target {
        return Ok(Next::Enough(errors.p95));
    }
    let misses = rom::axis_misses(map);
    let sum: f64 = misses.iter().sum();
    let axes = misses.len() as f64;
    let counts: Vec<usize> = map.pressures.iter().map(Vec::len).collect();
    let finer = |(count, miss): (&usize, &f64)| {
        let share = if sum > 0.0 { miss / sum } else { 1.0 / axes };
        let excess = axes * share * errors.p95 / (AIM * target);
        // Rounded so that FREEs that are alike get as many nodes as each other whatever the last bits of their errors.
        let intervals = (*count - 1) as f64 * excess.max(1.0).powf(0.25);
        1 + ((intervals - 1e-6).ceil() as usize).max(*count - 1)
    };
    let mut next: Vec<usize> = counts.iter().zip(&misses).map(finer).collect();
    if next == counts {
        let most = misses.iter().fold(0.0, |most: f64, miss| most.max(*miss));
        for (count, miss) in next.iter_mut().zip(&misses) {
            *count += usize::from(*miss >= most * (1.0 - 1e-6));
        }
    }
    let nodes = next.iter().try_fold(1usize, |all, count| all.checked_mul(*count));
    let fits = next.iter().all(|count| *count <= MOST) && nodes.is_some_and(|nodes| nodes <= MOST_NODES);
    Ok(if fits { Next::Refine(errors.p95, next) } else { Next::TooMany(errors.p95) })
}

/// One map of a refinement, in words.
pub fn told(map: &ModuleMap, error: f64, target: f64) -> String {
    let counts: Vec<String> = map.pressures.iter().map(|axis| axis.len().to_string()).collect();
    format!(
        "{} pressures, {} nodes: 95 % of positions within {:.4} mm of the finite elements, {:.4} mm asked for",
        counts.join(" x "),
        map.node_count(),
        error / MM,
        target / MM
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map_file::samples;
    use actuator::ModuleCheck;
    use rom::PoseModel;

    /// What no cubic follows, along the first FREE's pressure more than along the others'.
    fn wave(pressures: &[f64]) -> f64 {
        let along = |(free, pressure): (usize, &f64)| {
            let share = if free == 0 { 1.0 } else { 0.05 };
            share * (4.0 * pressure / 50e3).sin()
        };
        1e-3 * pressures.iter().enumerate().map(along).sum::<f64>()
    }

    fn waved() -> ModuleMap {
        let mut map = samples::smooth_module_map(1.0);
        let smooth = ModuleModel::fit(&map).unwrap();
        let mut into = smooth.workspace();
        for node in 0..map.node_count() {
            let by = wave(&map.node_pressures(node));
            map.states[node].as_mut().unwrap().chart.position[2] += by;
        }
        for k in 0..60 {
            let spread = |free: i32| (f64::from(k + 1) * 0.754_877_666f64.powi(free + 1)).fract();
            let pressures: Vec<f64> = (0..4).map(|free| 50e3 * spread(free)).collect();
            smooth.evaluate(&pressures, &mut into).unwrap();
            let mut state = map.states[0].clone().unwrap();
            state.chart = into.chart;
            state.chart.position[2] += wave(&pressures);
            map.checks.push(ModuleCheck { pressures, state });
        }
        map
    }

    #[test]
    fn a_coarse_map_is_refined_where_it_errs_and_a_fine_one_is_enough() {
        let map = waved();
        let errors = ModuleModel::fit(&map).unwrap().errors().position;
        assert!(errors.p95 > 1e-5);
        assert!(
            matches!(judge(&map, 1.01 * errors.p95).unwrap(), Next::Enough(error) if error == errors.p95)
        );
        let Next::Refine(error, next) = judge(&map, errors.p95 / 16.0).unwrap() else {
            panic!("a sixteenth of the error asks for more nodes")
        };
        assert_eq!(error, errors.p95);
        // Of four pressures: twice as many intervals and more along the first axis, which has nearly all of the error.
        assert!(next[0] >= 7 && next[1..].iter().all(|count| *count < next[0]), "{next:?}");
        assert!(matches!(judge(&map, 1e-15).unwrap(), Next::TooMany(_)));
        let mut unchecked = map;
        unchecked.checks.clear();
        assert!(
            judge(&unchecked, 1e-3).is_err_and(|failure| failure.paragraph().contains("give more --checks"))
        );
    }
}
