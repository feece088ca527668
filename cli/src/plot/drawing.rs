use super::font;
use crate::failure::Failure;
use plotters::{coord::Shift, prelude::*};
use std::path::Path;

/// Pixels across and down.
pub(super) const SIZE: (u32, u32) = (760, 460);

/// What comes of drawing; a backend's error is only shown.
pub(super) type Drawn<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// What becomes of a stroke.
pub(super) type Stroke<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// What can be drawn by any backend.
pub(super) trait Drawing {
    fn draw<B: DrawingBackend>(&self, root: &DrawingArea<B, Shift>) -> Stroke<B>
    where
        B::ErrorType: 'static;
}

/// Draws all of it, on white or on nothing.
fn draw<B: DrawingBackend>(drawing: &impl Drawing, root: &DrawingArea<B, Shift>, on_white: bool) -> Drawn<()>
where
    B::ErrorType: 'static,
{
    let ground = if on_white { root.fill(&WHITE) } else { Ok(()) };
    let drawn = ground.and_then(|()| drawing.draw(root)).and_then(|()| root.present());
    drawn.map_err(|error| error.to_string().into())
}

/// The text of an SVG file.
pub(super) fn svg(drawing: &impl Drawing, on_white: bool) -> Drawn<String> {
    font::register();
    let mut text = String::new();
    let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
    draw(drawing, &root, on_white)?;
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
    draw(drawing, &root, true).map_err(|error| Failure::file(format!("{}: {error}", png.display())))
}
