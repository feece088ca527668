use serde::{Deserialize, Serialize};

/// How large an error is over a set of states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorStatistics {
    /// Number of states.
    pub count: usize,
    /// Root of the mean square.
    pub rms: f64,
    /// The 95th percentile: the least of the errors that at least 95 % of them do not exceed.
    pub p95: f64,
    /// The worst.
    pub worst: f64,
}

impl ErrorStatistics {
    /// Statistics of the sizes of the errors; all zero where there are none.
    pub fn of(errors: &[f64]) -> Self {
        let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let count = sizes.len();
        let Some(&worst) = sizes.last() else { return Self::default() };
        let rms = (sizes.iter().map(|size| size * size).sum::<f64>() / count as f64).sqrt();
        // ceil(0.95 n) in whole numbers, so that rounding cannot choose another state.
        let rank = (count * 95).div_ceil(100);
        ErrorStatistics { count, rms, p95: sizes[rank - 1], worst }
    }

    /// Whether all numbers can be statistics.
    pub(crate) fn is_sound(&self) -> bool {
        [self.rms, self.p95, self.worst].iter().all(|value| value.is_finite() && *value >= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentile_and_mean_square_are_those_of_the_definition() {
        let hundred: Vec<f64> =
            (1..=100).map(|i| if i % 2 == 0 { -f64::from(i) } else { f64::from(i) }).collect();
        let statistics = ErrorStatistics::of(&hundred);
        assert_eq!((statistics.count, statistics.p95, statistics.worst), (100, 95.0, 100.0));
        // Sum of the squares of 1..n is n (n + 1)(2 n + 1)/6.
        assert!((statistics.rms - (101.0f64 * 201.0 / 6.0).sqrt()).abs() < 1e-12);
        let two_hundred: Vec<f64> = (1..=200).map(f64::from).collect();
        assert_eq!(ErrorStatistics::of(&two_hundred).p95, 190.0);
        // Of three errors, 95 % are all three.
        assert_eq!(ErrorStatistics::of(&[3.0, 1.0, 2.0]).p95, 3.0);
        assert_eq!(ErrorStatistics::of(&[]), ErrorStatistics::default());
    }
}
