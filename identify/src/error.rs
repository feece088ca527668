use rom::OutOfDomain;

/// Why an identification cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// Nothing to fit or nothing to judge on.
    #[error("no recording to {purpose}; give at least one")]
    NoRecording {
        /// "fit" or "hold out".
        purpose: &'static str,
    },
    /// A recording without any pressure of the right number of FREEs.
    #[error(
        "recording \"{recording}\" has neither commands nor readings of {frees} pressures; name them in [recordings] of the rig file"
    )]
    NoPressure {
        /// Name of the recording.
        recording: String,
        /// Number of FREEs of the model.
        frees: usize,
    },
    /// A recording in which nothing was seen of the deformation.
    #[error("recording \"{recording}\" has {found} samples with a deformation; at least {least} are needed")]
    NoDeformation {
        /// Name of the recording.
        recording: String,
        /// Samples with one.
        found: usize,
        /// Least number.
        least: usize,
    },
    /// A recording of another kind of actuator.
    #[error("recording \"{recording}\" holds {found}, but the rig describes {expected}")]
    WrongKind {
        /// Name of the recording.
        recording: String,
        /// What it holds.
        found: &'static str,
        /// What was expected.
        expected: &'static str,
    },
    /// The same recording is fitted and held out.
    #[error(
        "recording \"{recording}\" is both fitted and held out; a held-out recording must take no part in the fit"
    )]
    Overlap {
        /// Name of the recording.
        recording: String,
    },
    /// The base model does not answer.
    #[error(transparent)]
    Model(#[from] OutOfDomain),
    /// A stop was asked for.
    #[error("stopped before the end; nothing was written")]
    Stopped,
}
