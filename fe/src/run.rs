use std::sync::atomic::{AtomicBool, Ordering};

/// How a long computation is run, told of and stopped.
pub struct Run<'a> {
    /// Number of threads.
    pub jobs: usize,
    /// Told of progress as (done, total); called from any thread.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
    /// Set from outside to stop early; what is finished is kept.
    pub stop: &'a AtomicBool,
}

impl Run<'_> {
    /// Whether a stop was asked for.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// A part of a sweep: rows `index`, `index + count`, `index + 2 count`, ...
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from zero.
    pub index: usize,
    /// How many parts.
    pub count: usize,
}

impl Shard {
    /// The whole sweep.
    pub const WHOLE: Shard = Shard { index: 0, count: 1 };

    /// Whether a row of the sweep belongs to this part.
    pub fn owns(&self, row: usize) -> bool {
        row % self.count == self.index
    }
}
