//! The font of the charts. The drawing library brings none and cannot find the system's, so one is in the program.

use plotters::style::{FontStyle, register_font};
use std::sync::Once;

/// Name under which charts ask for it; in an SVG the viewer's own sans-serif is used.
pub const FAMILY: &str = "sans-serif";

static DEJAVU: &[u8] = include_bytes!("../../fonts/DejaVuSans.ttf");
static REGISTERED: Once = Once::new();

/// Makes the font known to the drawing library, once.
pub fn register() {
    // The only way to fail is a damaged font, which is part of the program and drawn in its tests.
    REGISTERED.call_once(|| drop(register_font(FAMILY, FontStyle::Normal, DEJAVU)));
}
