//! Progress of long work, on standard error and only where it is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// A line that tells how far the work is; invisible where standard error is not a terminal.
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar for work with a known number of steps.
    pub fn bar(what: &str) -> Self {
        let progress = Self::hidden_unless_terminal();
        if let Ok(style) =
            ProgressStyle::with_template("{msg} {wide_bar:.cyan} {pos}/{len}, {per_sec}, {eta} left")
        {
            progress.0.set_style(style);
        }
        progress.0.set_message(what.to_owned());
        progress
    }

    /// A turning wheel for work of unknown length.
    pub fn wheel(what: &str) -> Self {
        let progress = Self::hidden_unless_terminal();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
            progress.0.set_style(style);
        }
        progress.0.set_message(what.to_owned());
        progress.0.enable_steady_tick(std::time::Duration::from_millis(120));
        progress
    }

    fn hidden_unless_terminal() -> Self {
        let target = match std::io::stderr().is_terminal() {
            true => ProgressDrawTarget::stderr(),
            false => ProgressDrawTarget::hidden(),
        };
        Progress(ProgressBar::with_draw_target(None, target))
    }

    /// Tells how far the work is.
    pub fn at(&self, done: usize, total: usize) {
        self.0.set_length(total as u64);
        self.0.set_position(done as u64);
    }

    /// Changes the words.
    pub fn say(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
