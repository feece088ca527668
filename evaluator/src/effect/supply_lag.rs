//! Lag of the pressure behind its command: `dp/dt = (u - p)/T`, with `T` the filling time constant while `u > p`, the venting one otherwise.
//!
//! Over a step `dt` in which the command is constant the solution is exact at any step size, `p <- u + (p - u) exp(-dt/T)`; `p` never crosses
//! `u`, so the direction cannot change within a step. The command recorded at a sample is taken as the one that acted since the sample before.
//!
//! State: the pressure, Pa, and whether there was a command yet (1, else 0): the first starts the supply settled, `p = u`.

use super::Parameter;
use crate::Real;

/// `fill_time_constant_s`, `vent_time_constant_s`.
pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "fill_time_constant_s",
        unit: 1.0,
        neutral: 0.0,
        start: 0.1,
        lower: 0.0,
        upper: 20.0,
        scale: 0.05,
    },
    Parameter {
        name: "vent_time_constant_s",
        unit: 1.0,
        neutral: 0.0,
        start: 0.1,
        lower: 0.0,
        upper: 20.0,
        scale: 0.05,
    },
];

/// Pressure (Pa) after `step` seconds of a constant command (Pa).
pub(super) fn pressure<T: Real>(values: &[T], memory: &mut [T; 2], step: T, command: T) -> T {
    let [memory, begun] = memory;
    if *begun == T::ZERO {
        (*memory, *begun) = (command, T::ONE);
    }
    let time_constant = if command > *memory { values[0] } else { values[1] };
    let remains = if time_constant > T::ZERO { (-step / time_constant).exp() } else { T::ZERO };
    *memory = command + (*memory - command) * remains;
    *memory
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_response_is_exact_at_any_step_size() {
        for steps in [1, 3, 50] {
            let (mut up, mut down) = ([0.0, 1.0], [10.0, 1.0]);
            for _ in 0..steps {
                pressure(&[0.2, 0.7], &mut up, 0.5 / f64::from(steps), 10.0);
                pressure(&[0.2, 0.7], &mut down, 0.5 / f64::from(steps), 0.0);
            }
            assert!((up[0] - 10.0 * (1.0 - (-0.5f64 / 0.2).exp())).abs() < 1e-12);
            assert!((down[0] - 10.0 * (-0.5f64 / 0.7).exp()).abs() < 1e-12);
        }
    }

    #[test]
    fn it_starts_settled() {
        let mut memory = [0.0; 2];
        assert_eq!(pressure(&[0.2, 0.2], &mut memory, 0.1, 7.0), 7.0);
        assert!((pressure(&[0.2, 0.2], &mut memory, 0.2, 0.0) - 7.0 * (-1f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn without_time_constant_the_command_passes() {
        let mut memory = [3.0, 1.0];
        assert_eq!(pressure(&[0.0, 0.0], &mut memory, 0.05, 7.0), 7.0);
    }
}
