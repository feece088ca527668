//! Poses that are stamped late: `pose read at t = pose at t - d`. The base model has no state of its own, so the delay is taken on the
//! pressures it answers. State: the last pressures with their ages, linear between them.

use super::Parameter;

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

/// The last pressures (Pa), newest first, and their ages (s).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Past {
    pressures: [f64; LENGTH],
    ages: [f64; LENGTH],
    count: usize,
}

impl Past {
    pub(super) fn new() -> Self {
        Past { pressures: [0.0; LENGTH], ages: [0.0; LENGTH], count: 0 }
    }

    /// Takes in the pressure (Pa) at the end of `step` seconds and returns the one `values[0]` seconds ago.
    pub(super) fn pressure(&mut self, values: &[f64], step: f64, pressure: f64) -> f64 {
        self.count = (self.count + 1).min(LENGTH);
        for index in (1..self.count).rev() {
            self.pressures[index] = self.pressures[index - 1];
            self.ages[index] = self.ages[index - 1] + step;
        }
        self.pressures[0] = pressure;
        self.ages[0] = 0.0;
        let delay = values[0];
        for index in 1..self.count {
            if self.ages[index] >= delay {
                let (young, old) = (self.ages[index - 1], self.ages[index]);
                let share = if old > young { (delay - young) / (old - young) } else { 0.0 };
                return self.pressures[index - 1]
                    + share * (self.pressures[index] - self.pressures[index - 1]);
            }
        }
        self.pressures[self.count - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_comes_out_late_whatever_the_step() {
        for step in [0.05, 0.01] {
            let mut past = Past::new();
            let mut out = 0.0;
            let count = (1.0 / step) as usize;
            for k in 0..=count {
                out = past.pressure(&[0.12], if k == 0 { 0.0 } else { step }, k as f64 * step);
            }
            assert!((out - 0.88).abs() < 1e-12, "{out}");
        }
    }
}
