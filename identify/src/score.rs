use crate::objective::huber;
use crate::rows::Rows;

/// Mean loss of each block of samples, over all channels measured; `None` for a block without any.
pub fn block_losses(rows: &[&Rows], blocks: &[usize]) -> Vec<Option<f64>> {
    let count = blocks.last().map_or(0, |last| last + 1);
    let mut sums = vec![(0.0, 0usize); count];
    for channel in rows.iter().flat_map(|rows| &rows.channels) {
        for (value, block) in channel.iter().zip(blocks) {
            if value.is_finite() {
                sums[*block].0 += huber(*value);
                sums[*block].1 += 1;
            }
        }
    }
    sums.into_iter().map(|(sum, count)| (count > 0).then(|| sum / count as f64)).collect()
}

/// Mean loss of each block of samples, channel by channel.
pub fn channel_losses(rows: &[Rows], blocks: &[usize]) -> Vec<Vec<Option<f64>>> {
    let channels = rows.iter().flat_map(|rows| &rows.channels);
    channels.map(|channel| block_losses(&[&Rows { channels: vec![channel.clone()] }], blocks)).collect()
}

/// How much a change of the model gains on data that took no part in its fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// Share of the mean loss that goes: 1 - after/before.
    pub share: f64,
    /// Mean of the blocks' losses that goes.
    pub loss: f64,
    /// Mean of the blocks' gains over its standard error.
    pub t: f64,
    /// Number of blocks.
    pub blocks: usize,
}

/// Paired comparison block by block.
pub fn gain(before: &[Option<f64>], after: &[Option<f64>]) -> Gain {
    let pairs: Vec<(f64, f64)> = before.iter().zip(after).filter_map(|(b, a)| Some(((*b)?, (*a)?))).collect();
    let count = pairs.len() as f64;
    if pairs.len() < 2 {
        return Gain { share: 0.0, loss: 0.0, t: 0.0, blocks: pairs.len() };
    }
    let mean = pairs.iter().map(|(b, a)| b - a).sum::<f64>() / count;
    let variance = pairs.iter().map(|(b, a)| (b - a - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let total = pairs.iter().map(|(b, _)| b).sum::<f64>() / count;
    let error = (variance / count).sqrt();
    Gain {
        share: if total > 0.0 { mean / total } else { 0.0 },
        loss: mean,
        t: if error > 0.0 { mean / error } else { 0.0 },
        blocks: pairs.len(),
    }
}

/// As [`gain`], with the standard error of the root losses: a few blocks with heavy losses do not drown the others.
pub fn root_gain(before: &[Option<f64>], after: &[Option<f64>]) -> Gain {
    let root = |losses: &[Option<f64>]| losses.iter().map(|loss| loss.map(f64::sqrt)).collect::<Vec<_>>();
    Gain { t: gain(&root(before), &root(after)).t, ..gain(before, after) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_losses_gain_nothing_and_halved_ones_half() {
        let before: Vec<Option<f64>> = (0..10).map(|k| Some(2.0 + f64::from(k % 3))).collect();
        let half: Vec<Option<f64>> = before.iter().map(|loss| loss.map(|loss| 0.5 * loss)).collect();
        assert_eq!(gain(&before, &before).share, 0.0);
        let gain = gain(&before, &half);
        assert!((gain.share - 0.5).abs() < 1e-12 && gain.t > 5.0);
    }

    #[test]
    fn blocks_without_samples_are_left_out() {
        let rows = Rows { channels: vec![vec![1.0, f64::NAN, 2.0], vec![1.0, f64::NAN, f64::NAN]] };
        assert_eq!(block_losses(&[&rows], &[0, 1, 2]), [Some(0.5), None, Some(2.0)]);
    }
}
