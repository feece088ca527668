//! Rate-independent hysteresis of the rubber and the thread: a Prandtl-Ishlinskii operator of one play on the pressure in the FREE.
//!
//! `p_effective = p + w (z - p)`, `z <- max(p - r, min(p + r, z))`, with `r` the radius of the play and `w` its share. With `w = 1` it is
//! the pure play operator: on reversal nothing moves over a dead band of `2 r`. Half-width of the loop in pressure: `w r`.
//! Minor loops are congruent and the past is wiped out by a larger excursion (return-point memory); the rate has no influence.
//!
//! State: `z`, Pa; a FREE that was never inflated has `z = 0`.

use super::Parameter;
use crate::Real;

/// `radius_kpa`: r; `share`: w, without unit.
pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "radius_kpa",
        unit: 1e3,
        neutral: 0.0,
        start: 1.5e3,
        lower: 0.0,
        upper: 20e3,
        scale: 0.5e3,
    },
    Parameter { name: "share", unit: 1.0, neutral: 0.0, start: 0.7, lower: 0.0, upper: 1.5, scale: 0.2 },
];

/// One step of the play operator: radius r (Pa), memory z (Pa), input p (Pa); returns the new z.
pub(super) fn play<T: Real>(radius: T, memory: T, pressure: T) -> T {
    memory.greater(pressure - radius).lesser(pressure + radius)
}

/// The pressure (Pa) that the base model is to answer.
pub(super) fn pressure<T: Real>(values: &[T], memory: &mut T, pressure: T) -> T {
    *memory = play(values[0], *memory, pressure);
    pressure + values[1] * (*memory - pressure)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn drive(path: &[f64]) -> Vec<f64> {
        let mut memory = 0.0;
        path.iter().map(|p| pressure(&[2.0, 0.5], &mut memory, *p)).collect()
    }

    #[test]
    fn the_loop_is_as_wide_as_twice_share_times_radius() {
        let out = drive(&[0.0, 5.0, 10.0, 5.0]);
        // Up: z = p - 2, so p - 1; down: z = p + 2, so p + 1.
        assert!((out[1] - 4.0).abs() < 1e-12 && (out[3] - 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_closed_minor_loop_is_forgotten() {
        // Return-point memory: after 10 -> 6 -> 10 the operator goes on as if the minor loop had not been.
        let with = drive(&[0.0, 10.0, 6.0, 10.0, 12.0, 9.0]);
        let without = drive(&[0.0, 10.0, 12.0, 9.0]);
        assert_eq!(with[with.len() - 2..], without[without.len() - 2..]);
    }

    #[test]
    fn rate_and_step_size_do_not_matter() {
        let coarse = drive(&[0.0, 10.0, 3.0, 8.0]);
        let fine: Vec<f64> = [(0.0, 10.0), (10.0, 3.0), (3.0, 8.0)]
            .iter()
            .flat_map(|(a, b)| (0..=100).map(move |k| a + (b - a) * f64::from(k) / 100.0))
            .collect();
        assert!((drive(&fine).last().unwrap() - coarse.last().unwrap()).abs() < 1e-12);
    }
}
