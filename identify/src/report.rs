use crate::Verdict;
use rom::effect::Chain;

/// Residuals of one recording before and after, decimated, for plots.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name of the recording.
    pub name: String,
    /// Whether it was held out.
    pub is_held_out: bool,
    /// Times, s.
    pub time: Vec<f64>,
    /// Driving pressures (Pa), FREE by FREE.
    pub pressures: Vec<Vec<f64>>,
    /// Rates of the driving pressures (Pa/s), smoothed over half a second, FREE by FREE.
    pub rates: Vec<Vec<f64>>,
    /// Residuals of the calibrated model, channel by channel: for a module x, y, z (m) and rotation vector (rad) in the half-turned frame; for
    /// a FREE twist (rad), extension (m), outer diameter (m). NaN = not measured.
    pub before: Vec<Vec<f64>>,
    /// The same with the effects found.
    pub after: Vec<Vec<f64>>,
}

/// Everything an identification hands back.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The content of `identify.json`.
    pub verdict: Verdict,
    /// Calibration and effects, for the corrected model.
    pub chain: Chain,
    /// Residuals for plots.
    pub series: Vec<Series>,
    /// What was tried: a line each.
    pub log: Vec<String>,
}
