use super::{LoadingMode, RubberModel, TestPoint, Weighting, fit, fit::rms};

/// How well a model tells modes it was not fitted to: each mode in turn is left out, predicted by the fit to the others, and the
/// misfits of all are taken together, relative as in [`super::Fit::relative_rms`].
///
/// `None` with a single mode, or where a fit fails or cannot be stretched as far as the mode left out.
pub fn held_out_rms(model: RubberModel, points: &[TestPoint], weighting: Weighting) -> Option<f64> {
    let (mut sum, mut modes) = (0.0, 0);
    for mode in LoadingMode::ALL {
        let (held, rest): (Vec<_>, Vec<_>) = points.iter().copied().partition(|point| point.mode == mode);
        if held.is_empty() {
            continue;
        }
        modes += 1;
        if rest.is_empty() {
            return None;
        }
        let (_, relative) = rms(fit(model, &rest, weighting).ok()?.elastomer, &held)?;
        sum += held.len() as f64 * relative * relative;
    }
    (modes > 1).then(|| (sum / points.len() as f64).sqrt())
}
