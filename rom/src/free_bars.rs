//! Error bars of a FREE's model, made as those of modules are: see [`crate::error_bars`].

use crate::{
    FreeBarCoverage, FreeModel,
    error_bars::{factor, off_neighbours, widened},
};
use actuator::FreeMap;

/// An error of stretch, expansion and twist per length (rad/m), and its scale at that state.
type Judged = ([f64; 3], [f64; 3]);

/// Sets a model's error bars: every other check path sets their size, the rest are counted. `table` holds 1/stretch, expansion and twist
/// per length at the nodes of the states.
pub(crate) fn set(model: &mut FreeModel, map: &FreeMap, table: &[[f64; 3]]) {
    let grid = model.splines().states().grid();
    let holed: Vec<Option<[f64; 3]>> = table.iter().map(|row| Some(*row)).collect();
    let own = (0..table.len()).map(|node| {
        let mut sum = [0.0; 3];
        for axis in 0..grid.axes().len() {
            let off = off_neighbours(grid, &holed, node, axis).unwrap_or_default();
            for (sum, off) in sum.iter_mut().zip(off) {
                *sum += off.abs();
            }
        }
        // The table holds 1/stretch.
        sum[0] /= table[node][0] * table[node][0];
        sum
    });
    let scale = widened(grid, own.collect());
    model.set_bars(scale.as_flattened().to_vec(), FreeBarCoverage::default());
    let judged = |odd: usize| -> Vec<Judged> {
        map.checks.iter().skip(odd).step_by(2).flat_map(|check| judge(model, check)).collect()
    };
    let (setting, counted) = (judged(0), judged(1));
    if setting.is_empty() {
        model.set_bars(Vec::new(), FreeBarCoverage::default());
        return;
    }
    let factors: [f64; 3] = std::array::from_fn(|output| {
        factor(setting.iter().map(|(off, scale)| off[output] / scale[output]).collect())
    });
    let within = |output: usize| {
        counted.iter().filter(|(off, scale)| off[output] <= factors[output] * scale[output]).count()
    };
    let coverage = FreeBarCoverage {
        states: counted.len(),
        axial_stretch: within(0),
        expansion: within(1),
        twist_per_length: within(2),
    };
    let bars = scale.iter().flat_map(|row| row.iter().zip(factors).map(|(scale, factor)| scale * factor));
    model.set_bars(bars.collect(), coverage);
}

/// Errors and their scales at the states of a check path that lie in the model's domain.
fn judge(model: &FreeModel, (node, path): &(actuator::LoadedFree, actuator::FreePath)) -> Vec<Judged> {
    let (angle, modulus) = (node.free.winding.angle_from_hoop(), node.free.elastomer.shear_modulus());
    let states = path.states.iter().filter(|state| state.pressure > 0.0);
    let of = |state: &actuator::FreeState| {
        let ours = model.evaluate(state.pressure, angle, modulus).ok()?;
        let scale = model.splines().error_bars(state.pressure, angle, modulus).ok()??;
        let off = [
            (ours.axial_stretch - state.axial_stretch).abs(),
            (ours.expansion - state.expansion).abs(),
            (ours.twist_per_length - state.twist_per_length).abs(),
        ];
        Some((off, scale))
    };
    states.filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{free_map, free_state, limit_pressure};

    #[test]
    fn bars_hold_on_paths_that_did_not_set_them_and_follow_the_error() {
        let angles: Vec<f64> = (0..9).map(|k| 0.3 + 0.12 * f64::from(k)).collect();
        let map = free_map(angles, vec![0.2e6, 0.4e6, 0.6e6], 40, None);
        let model = FreeModel::fit(&map).unwrap();
        let coverage = model.bar_coverage();
        assert!(coverage.states > 200, "{coverage:?}");
        // Of states on a path the errors go together: less certain than 95 of 100.
        for held in [coverage.axial_stretch, coverage.expansion, coverage.twist_per_length] {
            assert!(held * 100 >= 85 * coverage.states, "{coverage:?}");
        }
        let (angle, modulus) = (0.36, 0.3e6);
        let limit = limit_pressure(angle, modulus);
        let bar = |s: f64| {
            let pressure = limit * (1.0 - (1.0 - s) * (1.0 - s));
            model.splines().error_bars(pressure, angle, modulus).unwrap().unwrap()
        };
        let off = |s: f64| {
            let state = free_state(angle, modulus, s);
            (model.evaluate(state.pressure, angle, modulus).unwrap().expansion - state.expansion).abs()
        };
        assert!(off(0.8) > 4.0 * off(0.1) && bar(0.8)[1] > 2.0 * bar(0.1)[1]);
        let mut bare = map.clone();
        bare.checks.clear();
        let none = FreeModel::fit(&bare).unwrap();
        assert!(
            none.splines().bars().is_empty()
                && none.splines().error_bars(1e3, angle, modulus).unwrap().is_none()
        );
    }
}
