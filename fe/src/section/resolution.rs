//! Whether the states of a path are dense enough to be interpolated.

use crate::PressureUnit;
use actuator::{FreeState, PathEnd};

/// States nearer to each other than this are not interpolated between, nor is one put there: their rounding would be a slope.
const LEAST_STEP: f64 = 2e-3;
/// Rounds of putting states in the middle of intervals.
const MOST_ROUNDS: usize = 6;
/// The fourth derivative is known from five states only: half the tolerance is left to what it is between them.
const SAFETY: f64 = 2.0;
/// Changes along the path below this are rounding: of stretch and expansion, and of the twist times the outer radius.
const LEAST_CHANGE: f64 = 1e-4;

/// States of a path in the coordinate in which they are smooth.
struct Trace {
    /// Coordinates s of the pressures, p over the last pressure where there is no limit.
    places: Vec<f64>,
    /// Stretch, expansion and twist, over their greatest change along the path.
    values: Vec<[f64; 3]>,
}

/// What pressures of a path are measured by.
fn unit(states: &[FreeState], end: PathEnd) -> PressureUnit {
    let last = states.last().map_or(0.0, |state| state.pressure);
    match end {
        PathEnd::LimitPoint => PressureUnit::Limit(last),
        PathEnd::Range => PressureUnit::Other(last),
    }
}

/// Divided difference of values at places: their highest derivative over its factorial.
fn divided_difference(places: &[f64], values: &[[f64; 3]]) -> [f64; 3] {
    let mut table = values.to_vec();
    for order in 1..places.len() {
        for i in 0..places.len() - order {
            let width = places[i + order] - places[i];
            table[i] = std::array::from_fn(|q| (table[i + 1][q] - table[i][q]) / width);
        }
    }
    table[0]
}

impl Trace {
    fn new(states: &[FreeState], end: PathEnd, outer_radius: f64) -> Self {
        let unit = unit(states, end);
        let least = [LEAST_CHANGE, LEAST_CHANGE, LEAST_CHANGE / outer_radius];
        let all = || states.iter().map(FreeState::deformation);
        let scale: [f64; 3] = std::array::from_fn(|q| {
            let (low, high) = all()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v[q]), high.max(v[q])));
            (high - low).max(least[q])
        });
        let mut trace = Trace { places: vec![], values: vec![] };
        for (index, state) in states.iter().enumerate() {
            let s = unit.coordinate(state.pressure);
            if trace.places.last().is_some_and(|before| s - before < LEAST_STEP) {
                // The end is worth more than its neighbour, the state of rest more than any.
                if index + 1 < states.len() || trace.places.len() == 1 {
                    continue;
                }
                trace.places.pop();
                trace.values.pop();
            }
            trace.places.push(s);
            let values = state.deformation();
            trace.values.push(std::array::from_fn(|q| values[q] / scale[q]));
        }
        trace
    }

    /// By how much the cubic through the two states either side of interval `i` (at the ends: through the four nearest) misses the middle
    /// of it: the fourth derivative, from the states on either side of those four, times the cubic's nodes.
    fn miss(&self, i: usize) -> f64 {
        let count = self.places.len();
        if count < 5 {
            return f64::INFINITY;
        }
        let first = i.saturating_sub(1).min(count - 4);
        let middle = 0.5 * (self.places[i] + self.places[i + 1]);
        let nodes: f64 = self.places[first..first + 4].iter().map(|place| (middle - place).abs()).product();
        let starts = first.saturating_sub(1)..=first.min(count - 5);
        let fourth = |start: usize| {
            let stencil = start..start + 5;
            divided_difference(&self.places[stencil.clone()], &self.values[stencil])
        };
        starts.flat_map(fourth).map(|derivative| nodes * derivative.abs()).fold(0.0, f64::max)
    }

    /// Middles of the intervals where the cubic misses by more than `tolerance`.
    fn weak(&self, tolerance: f64) -> Vec<f64> {
        let intervals = 0..self.places.len().saturating_sub(1);
        intervals
            .filter(|i| {
                self.places[i + 1] - self.places[*i] >= 2.0 * LEAST_STEP && SAFETY * self.miss(*i) > tolerance
            })
            .map(|i| 0.5 * (self.places[i] + self.places[i + 1]))
            .collect()
    }
}

/// Puts states, by `solve` at a pressure, between those of a path where a cubic misses by more than `tolerance` times the greatest
/// change of a quantity along the path.
pub(crate) fn resolve<E>(
    states: &mut Vec<FreeState>,
    end: PathEnd,
    (tolerance, outer_radius): (f64, f64),
    solve: &mut dyn FnMut(f64) -> Result<FreeState, E>,
) -> Result<(), E> {
    if states.last().is_none_or(|state| state.pressure <= 0.0) {
        return Ok(());
    }
    let unit = unit(states, end);
    for _ in 0..MOST_ROUNDS {
        let weak = Trace::new(states, end, outer_radius).weak(tolerance);
        if weak.is_empty() {
            break;
        }
        for place in weak {
            states.push(solve(unit.pressure(place))?);
        }
        states.sort_by(|a, b| a.pressure.total_cmp(&b.pressure));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_not_resolved() {
        let twist = |i: u32| 1e-11 * f64::from(i * 7919 % 13);
        let state = |i: u32| FreeState {
            pressure: 1e3 * f64::from(i),
            axial_stretch: 1.0 + 1e-3 * f64::from(i),
            expansion: 1.0 + 2e-3 * f64::from(i),
            twist_per_length: twist(i),
            residual: 1e-12,
            middle: None,
            section: None,
            mesh_error: None,
        };
        let mut states: Vec<FreeState> = (0..20).map(state).collect();
        resolve(&mut states, PathEnd::Range, (1e-5, 5e-3), &mut |pressure| Err(pressure)).unwrap();
        // The same where the twist is worth asking about.
        states.iter_mut().for_each(|state| state.twist_per_length *= 1e10);
        assert!(resolve(&mut states, PathEnd::Range, (1e-5, 5e-3), &mut |pressure| Err(pressure)).is_err());
    }
}
