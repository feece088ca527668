use super::font;
use crate::failure::Failure;
use plotters::{coord::Shift, prelude::*};
use std::path::Path;

/// Pixels across and down.
pub(super) const SIZE: (u32, u32) = (760, 460);

/// What comes of drawing; a backend's error is only shown.
pub(super) type Drawn<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// What can be drawn by any backend, with a white background or none.
pub(super) trait Drawing {
    fn draw<B: DrawingBackend>(&self, root: &DrawingArea<B, Shift>, on_white: bool) -> Drawn<()>
    where
        B::ErrorType: 'static;
}

/// The text of an SVG file.
pub(super) fn svg(drawing: &impl Drawing, on_white: bool) -> Drawn<String> {
    font::register();
    let mut text = String::new();
    let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
    drawing.draw(&root, on_white)?;
    root.present().map_err(|error| error.to_string())?;
    drop(root);
    Ok(text)
}

/// Writes `stem.svg` with the text given and draws `stem.png` into a directory.
pub(super) fn write(
    drawing: &impl Drawing,
    svg: Drawn<String>,
    directory: &Path,
    stem: &str,
) -> Result<(), Failure> {
    crate::output::save(&directory.join(format!("{stem}.svg")), svg.map_err(Failure::file)?.as_bytes())?;
    let png = directory.join(format!("{stem}.png"));
    let root = BitMapBackend::new(&png, SIZE).into_drawing_area();
    let drawn = drawing.draw(&root, true);
    let drawn = drawn.and_then(|()| root.present().map_err(|error| error.to_string().into()));
    drawn.map_err(|error| Failure::file(format!("{}: {error}", png.display())))
}
