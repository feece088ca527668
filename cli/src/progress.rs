//! Progress of long work, on standard error and only where it is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// A line that tells how far the work is; invisible where standard error is not a terminal.
///
/// Rate and time left are those of the steps done since the first was told of: what was there before took no time.
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

    /// Tells how far the work is: at first, how much of it was done before.
    pub fn at(&self, done: usize, total: usize) {
        let is_first = done == 0 || self.0.length() != Some(total as u64);
        self.0.set_length(total as u64);
        self.0.set_position(done as u64);
        if is_first {
            self.0.reset_eta();
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_done_before_makes_no_rate() {
        let bar = Progress::bar("test");
        bar.at(1000, 2000);
        assert_eq!((bar.0.position(), bar.0.length(), bar.0.per_sec()), (1000, Some(2000), 0.0));
        std::thread::sleep(std::time::Duration::from_millis(50));
        // One step in 50 ms or more.
        bar.at(1001, 2000);
        assert!(bar.0.per_sec() > 0.0 && bar.0.per_sec() < 21.0, "{}", bar.0.per_sec());
        // 999 of them are left.
        assert!(bar.0.eta().as_secs_f64() > 40.0, "{:?}", bar.0.eta());
    }
}
