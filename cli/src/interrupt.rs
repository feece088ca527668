//! Ctrl-C: the first asks the work to stop and keep what is finished, the second ends the program at once.

use crate::exit::Exit;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// The flag that long work looks at.
pub fn flag() -> &'static AtomicBool {
    &STOP
}

/// Whether a stop was asked for.
pub fn is_asked() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Makes Ctrl-C set the flag. Where the system refuses, Ctrl-C keeps its usual meaning.
pub fn listen() {
    let handler = || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(Exit::Interrupted.code()));
        }
        eprintln!("\nstopping after the running step; press Ctrl-C again to end at once");
    };
    drop(ctrlc::set_handler(handler));
}
