use super::{CalibrationError, least_squares::student_quantile};

/// The straight line through a pull test of a thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreFit {
    /// Its slope EA, N.
    pub axial_stiffness: f64,
    /// 95 % interval of EA, N; `None` of two points.
    pub ci95: Option<[f64; 2]>,
    /// The line's force at no strain, N: of slack (negative) or pull (positive) at the start of the test.
    pub force_at_rest: f64,
    /// Root mean square misfit, N.
    pub rms: f64,
    /// Number of points.
    pub points: usize,
}

/// Fits force (N) = EA strain + force at rest by least squares to (strain, force) pairs.
///
/// # Errors
/// [`CalibrationError::TooFewPoints`] with fewer than two different strains, [`CalibrationError::NoMinimum`] where the force
/// falls with the strain.
pub fn fit_fibre(points: &[(f64, f64)]) -> Result<FibreFit, CalibrationError> {
    let n = points.len() as f64;
    let mean = |value: fn(&(f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / n;
    let (strain, force) = (mean(|p| p.0), mean(|p| p.1));
    let spread: f64 = points.iter().map(|p| (p.0 - strain).powi(2)).sum();
    let model = || "the line of a thread".to_owned();
    if points.len() < 2 || spread.is_nan() || spread <= 0.0 {
        return Err(CalibrationError::TooFewPoints {
            model: model(),
            constants: 2,
            points: points.len().min(1),
        });
    }
    let slope = points.iter().map(|p| (p.0 - strain) * (p.1 - force)).sum::<f64>() / spread;
    if slope.is_nan() || slope <= 0.0 {
        return Err(CalibrationError::NoMinimum { model: model() });
    }
    let force_at_rest = force - slope * strain;
    let squares: f64 = points.iter().map(|p| (p.1 - slope * p.0 - force_at_rest).powi(2)).sum();
    let freedom = points.len() - 2;
    let ci95 = (freedom > 0).then(|| {
        let half = student_quantile(freedom) * (squares / freedom as f64 / spread).sqrt();
        [slope - half, slope + half]
    });
    Ok(FibreFit {
        axial_stiffness: slope,
        ci95,
        force_at_rest,
        rms: (squares / n).sqrt(),
        points: points.len(),
    })
}
