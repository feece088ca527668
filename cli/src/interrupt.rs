//! Ctrl-C: the first asks the work to stop and keep what is finished, a later one ends the program at once.

use crate::exit::Exit;
use std::{
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

static STOP: AtomicBool = AtomicBool::new(false);
static ASKED: Mutex<Option<Instant>> = Mutex::new(None);

/// Signals nearer than this to the first are the same wish: shells and supervisors may send one to the program and to its group.
const SAME_WISH: Duration = Duration::from_millis(500);

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
        let mut asked = ASKED.lock().unwrap_or_else(PoisonError::into_inner);
        match *asked {
            None => {
                *asked = Some(Instant::now());
                STOP.store(true, Ordering::Relaxed);
                eprintln!("\nstopping after the running step; press Ctrl-C again to end at once");
            }
            Some(first) if first.elapsed() > SAME_WISH => {
                std::process::exit(i32::from(Exit::Interrupted.code()));
            }
            Some(_) => {}
        }
    };
    drop(ctrlc::set_handler(handler));
}
