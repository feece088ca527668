//! Poses that are stamped late: `pose read at t = pose at t - d`. The base model has no state of its own, so the delay is taken on the
//! pressures it answers. State: the number of pressures held, the last pressures (Pa, newest first), their ages (s); linear between them.

use super::Parameter;
use crate::Real;

/// `delay_s`: d.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "delay_s",
    unit: 1.0,
    neutral: 0.0,
    start: 0.03,
    lower: 0.0,
    upper: 0.5,
    scale: 0.02,
}];

/// Samples remembered. A delay longer than they span (at 100 Hz: 0.63 s) answers with the oldest.
const LENGTH: usize = 64;

/// Numbers of its state.
pub(super) const MEMORY: usize = 1 + 2 * LENGTH;

/// Takes in the pressure (Pa) at the end of `step` seconds and returns the one `values[0]` seconds ago.
pub(super) fn pressure<T: Real>(values: &[T], memory: &mut [T; MEMORY], step: T, pressure: T) -> T {
    let (held, past) = memory.split_at_mut(1);
    let (pressures, ages) = past.split_at_mut(LENGTH);
    // Written so that a memory that was never set, or was overwritten, cannot lead outside.
    let count = (held[0].to_f64() as usize).min(LENGTH - 1) + 1;
    held[0] = T::constant(count as f64);
    for index in (1..count).rev() {
        pressures[index] = pressures[index - 1];
        ages[index] = ages[index - 1] + step;
    }
    pressures[0] = pressure;
    ages[0] = T::ZERO;
    let delay = values[0];
    for index in 1..count {
        if ages[index] >= delay {
            let (young, old) = (ages[index - 1], ages[index]);
            let share = if old > young { (delay - young) / (old - young) } else { T::ZERO };
            return pressures[index - 1] + share * (pressures[index] - pressures[index - 1]);
        }
    }
    pressures[count - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_memory_that_is_none_leads_nowhere() {
        for held in [f64::NAN, -1.0, 1e300, f64::INFINITY] {
            let mut memory = [held; MEMORY];
            pressure(&[0.12], &mut memory, 0.01, 1e3);
            assert!((1.0..=LENGTH as f64).contains(&memory[0]));
        }
    }

    #[test]
    fn a_ramp_comes_out_late_whatever_the_step() {
        for step in [0.05, 0.01] {
            let mut memory = [0.0; MEMORY];
            let mut out = 0.0;
            let count = (1.0 / step) as usize;
            for k in 0..=count {
                out = pressure(&[0.12], &mut memory, if k == 0 { 0.0 } else { step }, k as f64 * step);
            }
            assert!((out - 0.88).abs() < 1e-12, "{out}");
        }
    }
}
