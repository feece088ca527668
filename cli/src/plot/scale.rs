//! Ranges and tick labels of axes.

use std::ops::Range;

/// Number of ticks aimed at.
pub const TICKS: usize = 7;

/// The range that shows all finite values with a little air; never empty.
pub fn range_of(values: impl Iterator<Item = f64>) -> Range<f64> {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return 0.0..1.0;
    }
    // A constant is drawn in the middle of a range of its own size.
    let air = if high > low { 0.04 * (high - low) } else { 0.5 * low.abs().max(1e-9) };
    low - air..high + air
}

/// Decimals that tell ticks of a range apart: two significant figures of the step between them.
pub fn decimals(range: &Range<f64>) -> usize {
    let step = (range.end - range.start).abs() / TICKS as f64;
    (-(step.log10().floor())).clamp(0.0, 12.0) as usize
}

/// The label of a tick.
pub fn label(value: f64, decimals: usize) -> String {
    if value.abs() >= 1e6 || decimals > 6 {
        return if value == 0.0 { "0".into() } else { format!("{value:.1e}") };
    }
    let text = format!("{value:.decimals$}");
    // Rounding leaves "-0.0" where the tick is zero.
    match text.parse::<f64>() {
        Ok(0.0) => text.trim_start_matches('-').to_owned(),
        _ => text.replace('-', "\u{2212}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_never_empty() {
        assert_eq!(range_of(std::iter::empty()), 0.0..1.0);
        assert_eq!(range_of([f64::NAN].into_iter()), 0.0..1.0);
        for values in [[0.0, 0.0], [5.0, 5.0], [-1.0, 3.0]] {
            let range = range_of(values.into_iter());
            assert!(range.start < values[0] && range.end > values[1], "{range:?}");
        }
    }

    #[test]
    fn labels_tell_ticks_apart() {
        assert_eq!(decimals(&(0.0..70.0)), 0);
        assert_eq!(decimals(&(0.0..0.7)), 1);
        assert_eq!(label(0.02, decimals(&(0.0..0.1))), "0.02");
        assert_eq!(label(-0.001, 1), "0.0");
        assert_eq!(label(-12.0, 0), "\u{2212}12");
        assert_eq!(label(2.5e7, 0), "2.5e7");
    }
}
