use crate::rows::Rows;
use crate::verdict::Errors;
use actuator::units::{DEG, MM};

fn mean_square(channels: &[&Vec<f64>]) -> Option<f64> {
    let count = channels.first()?.len();
    let sums: Vec<f64> = (0..count)
        .map(|k| channels.iter().map(|channel| channel[k] * channel[k]).sum::<f64>())
        .filter(|sum| sum.is_finite())
        .collect();
    (!sums.is_empty()).then(|| sums.iter().sum::<f64>() / sums.len() as f64)
}

/// Root-mean-square errors of residuals in the order of [`crate::Seen::difference`].
pub fn errors(rows: &Rows, is_module: bool, outer_diameter: f64) -> Errors {
    let root = |channels: &[usize]| {
        let chosen: Vec<&Vec<f64>> = channels.iter().map(|channel| &rows.channels[*channel]).collect();
        mean_square(&chosen).map(f64::sqrt)
    };
    if is_module {
        Errors {
            position_rms_mm: root(&[0, 1, 2]).map(|error| error / MM),
            rotation_rms_deg: root(&[3, 4, 5]).map(|error| error / DEG),
            ..Errors::default()
        }
    } else {
        Errors {
            twist_rms_rad: root(&[0]),
            extension_rms_mm: root(&[1]).map(|error| error / MM),
            expansion_rms: root(&[2]).map(|error| error / outer_diameter),
            ..Errors::default()
        }
    }
}
