use crate::rows::Rows;
use nalgebra::{DMatrix, DVector};

/// How much of a residual goes with one thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// What it goes with, in words.
    pub with: String,
    /// Share of the held-out mean square that it explains, fitted elsewhere.
    pub share: f64,
}

/// Features of each sample that a residual may go with.
pub struct Features {
    /// Name of the group, and its features, each over all samples.
    pub groups: Vec<(String, Vec<Vec<f64>>)>,
}

/// What is known of a sample beside its residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Circumstance {
    /// Time from the start of the recording, s.
    pub time: f64,
    /// Time since the pressures last moved by more than noise, s.
    pub rest: f64,
}

impl Features {
    /// Features from the pressures (Pa, FREEs fastest) and their rates (Pa/s) at chosen samples. `greatest` (Pa) scales them.
    pub fn new(
        pressures: &[f64],
        rates: &[f64],
        circumstances: &[Circumstance],
        frees: usize,
        greatest: f64,
    ) -> Self {
        let each = |flat: &[f64], f: &dyn Fn(f64, f64) -> f64| -> Vec<Vec<f64>> {
            (0..frees)
                .map(|free| {
                    let own = flat.iter().skip(free).step_by(frees);
                    own.zip(pressures.iter().skip(free).step_by(frees))
                        .map(|(value, p)| f(*value, *p / greatest))
                        .collect()
                })
                .collect()
        };
        let longest = circumstances.iter().map(|at| at.time).fold(1.0, f64::max);
        let typical_rate =
            (rates.iter().map(|rate| rate * rate).sum::<f64>() / rates.len().max(1) as f64).sqrt().max(1.0);
        // Noise of the rate must not count as a direction.
        let direction = move |rate: f64, _: f64| (rate / (0.3 * typical_rate)).clamp(-1.0, 1.0);
        let time: Vec<f64> = circumstances.iter().map(|at| at.time / longest).collect();
        let mut time_by_pressure = each(pressures, &|_, p| p);
        for channel in &mut time_by_pressure {
            channel.iter_mut().zip(&time).for_each(|(value, time)| *value *= time);
        }
        let mut by_time = vec![time];
        by_time.extend(time_by_pressure);
        let mut by_rest = each(pressures, &|_, p| p);
        for channel in &mut by_rest {
            channel.iter_mut().zip(circumstances).for_each(|(value, at)| *value *= (1.0 + at.rest).ln());
        }
        let mut moving = each(rates, &direction);
        moving.extend(each(rates, &|rate, p| direction(rate, p) * p));
        Features {
            groups: vec![
                (
                    "the rate of the pressures (lag or viscosity)".into(),
                    each(rates, &|rate, _| rate / typical_rate),
                ),
                ("the direction in which the pressures move (hysteresis)".into(), moving),
                ("the time since the pressures came to rest (creep)".into(), by_rest),
                ("the time since the start of the recording (drift)".into(), by_time),
            ],
        }
    }
}

/// For each group: fits the whitened residuals of the fit samples by its features, and tells what share of the held-out mean square that takes away.
pub fn shares(fit: (&Rows, &Features), held_out: (&Rows, &Features)) -> Vec<Share> {
    let mut all = Vec::new();
    for ((name, features), (_, held_features)) in fit.1.groups.iter().zip(&held_out.1.groups) {
        let matrix = |features: &[Vec<f64>]| {
            DMatrix::from_fn(features[0].len(), features.len(), |k, f| features[f][k])
        };
        let (basis, held_basis) = (matrix(features), matrix(held_features));
        let mut normal = basis.transpose() * &basis;
        let pull = 1e-6 * normal.trace() + f64::MIN_POSITIVE;
        for k in 0..normal.nrows() {
            normal[(k, k)] += pull;
        }
        let Some(factor) = normal.cholesky() else { continue };
        let (mut before, mut after) = (0.0, 0.0);
        for (channel, held) in fit.0.channels.iter().zip(&held_out.0.channels) {
            let filled = DVector::from_iterator(
                channel.len(),
                channel.iter().map(|v| if v.is_finite() { *v } else { 0.0 }),
            );
            let fitted = &held_basis * factor.solve(&basis.tr_mul(&filled));
            for (value, fitted) in held.iter().zip(fitted.iter()).filter(|(value, _)| value.is_finite()) {
                before += value * value;
                after += (value - fitted).powi(2);
            }
        }
        let share = if before > 0.0 { 1.0 - after / before } else { 0.0 };
        all.push(Share { with: name.clone(), share });
    }
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all
}

/// Whether residuals look white: the mean over the channels of the correlation of neighbouring samples within blocks stays within what
/// chance gives, 2/sqrt(n) of all pairs.
pub fn is_white(rows: &Rows, blocks: &[usize]) -> bool {
    let (mut product, mut square, mut pairs) = (0.0, 0.0, 0usize);
    for channel in &rows.channels {
        for (k, pair) in channel.windows(2).enumerate() {
            if blocks[k] == blocks[k + 1] && pair[0].is_finite() && pair[1].is_finite() {
                product += pair[0] * pair[1];
                square += 0.5 * (pair[0] * pair[0] + pair[1] * pair[1]);
                pairs += 1;
            }
        }
    }
    pairs < 2 || (product / square.max(f64::MIN_POSITIVE)).abs() < 2.0 / (pairs as f64).sqrt()
}
