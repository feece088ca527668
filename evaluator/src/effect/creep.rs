//! Creep of the rubber: deformation goes on growing after the pressure has settled. One standard-linear-solid branch in terms of pressure:
//! `p_effective = p + c q`, `dq/dt = (p - q)/T`.
//!
//! After a long hold at `p` the base model sees `(1 + c) p`, right after the step `p`. Exact for a pressure that is constant over the step:
//! `q <- p + (q - p) exp(-dt/T)`. State: `q`, Pa; zero in an actuator that has rested.

use super::Parameter;
use crate::Real;

/// `share`: c, without unit; `time_constant_s`: T.
pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter { name: "share", unit: 1.0, neutral: 0.0, start: 0.02, lower: -0.1, upper: 0.6, scale: 0.02 },
    Parameter {
        name: "time_constant_s",
        unit: 1.0,
        neutral: 20.0,
        start: 20.0,
        lower: 0.5,
        upper: 2000.0,
        scale: 10.0,
    },
];

/// The pressure (Pa) that the base model is to answer.
pub(super) fn pressure<T: Real>(values: &[T], memory: &mut T, step: T, pressure: T) -> T {
    *memory = pressure + (*memory - pressure) * (-step / values[1]).exp();
    pressure + values[0] * *memory
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hold_creeps_exponentially_at_any_step_size() {
        for steps in [1, 7] {
            let mut memory = 0.0;
            let mut out = 0.0;
            for _ in 0..steps {
                out = pressure(&[0.1, 30.0], &mut memory, 60.0 / f64::from(steps), 10.0);
            }
            assert!((out - 10.0 * (1.0 + 0.1 * (1.0 - (-2f64).exp()))).abs() < 1e-12);
        }
    }
}
