use crate::IdentifyError;
use std::sync::atomic::{AtomicBool, Ordering};

/// How an identification is told of and stopped.
pub struct Watch<'a> {
    /// Told what was tried and what came of it, a line at a time; called from any thread.
    pub tell: &'a (dyn Fn(&str) + Sync),
    /// Set from outside to stop early.
    pub stop: &'a AtomicBool,
}

impl Watch<'_> {
    /// An error when a stop was asked for.
    pub fn check(&self) -> Result<(), IdentifyError> {
        if self.stop.load(Ordering::Relaxed) { Err(IdentifyError::Stopped) } else { Ok(()) }
    }

    /// Tells of progress.
    pub fn tell(&self, line: &str) {
        (self.tell)(line);
    }
}
