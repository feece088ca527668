use rom::effect::Link;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What the identification came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Finding {
    /// Effects were found, and what is left is noise and the base model's own error.
    #[serde(rename = "explained")]
    Explained,
    /// The calibrated base model leaves only noise and its own error.
    #[serde(rename = "nothing missing")]
    NothingMissing,
    /// Something is left that no effect of the library earns.
    #[serde(rename = "unexplained")]
    Unexplained,
}

/// An estimate with its 95 % confidence interval, both in the unit of its name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// The estimate.
    pub value: f64,
    /// Ends of the interval.
    pub ci95: [f64; 2],
}

/// An effect that earned its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoundEffect {
    /// Its name.
    pub name: String,
    /// The link it sits on.
    pub link: Link,
    /// FREEs it acts on, counted from one.
    pub frees: Vec<usize>,
    /// Its numbers.
    pub parameters: BTreeMap<String, Estimated>,
    /// Other effects that could have left the same traces in these recordings.
    pub indistinguishable_from: Vec<String>,
    /// Share of the held-out loss that it takes away.
    pub gain_held_out: f64,
}

/// Root-mean-square errors; those of a pose for a module, those of a FREE for a FREE.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Distance of positions, mm.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub position_rms_mm: Option<f64>,
    /// Angle between rotations, deg.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub rotation_rms_deg: Option<f64>,
    /// Twist of a FREE, rad.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub twist_rms_rad: Option<f64>,
    /// Change of length of a FREE, mm.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub extension_rms_mm: Option<f64>,
    /// Expansion of a FREE.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub expansion_rms: Option<f64>,
}

/// Errors on held-out recordings, stage by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stages {
    /// The base model from the description alone.
    pub before: Errors,
    /// With the base model's own free numbers fitted.
    pub calibrated: Errors,
    /// With the effects found.
    pub after: Errors,
    /// What a perfect model would leave.
    pub noise: Errors,
}

/// What is left.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Residual {
    /// Whether it looks like noise without any order.
    pub white: bool,
    /// Its order, in words.
    pub structure: String,
}

/// The content of `identify.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The finding.
    pub verdict: Finding,
    /// The effects found, in the order in which they were found.
    pub effects: Vec<FoundEffect>,
    /// The base model's own numbers.
    pub calibration: BTreeMap<String, Estimated>,
    /// Errors when the measured pressure drives the model; absent where it was not recorded.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub held_out: Option<Stages>,
    /// Errors when the command drives the model; absent where it was not recorded.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub held_out_from_command: Option<Stages>,
    /// What is left.
    pub residual_after: Residual,
    /// The experiment that would tell most.
    pub next_experiment: String,
    /// How the held-out data were chosen, and what was noticed of the recordings, in words.
    pub findings: Vec<String>,
    /// Wall time, s; set by the caller, so that the rest is the same at every run.
    pub seconds: f64,
}
