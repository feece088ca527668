//! Series drawn into a chart's or a field's plane.

use super::{
    drawing::Stroke,
    font::FAMILY,
    mark::{Mark, PALETTE, Series},
};
use plotters::{
    coord::types::RangedCoordf64,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

/// Draws the series; a colour that is not given is `first` and those after it.
pub fn draw<B: DrawingBackend>(
    chart: &mut ChartContext<'_, B, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
    series: &[Series],
    ink: Option<RGBColor>,
) -> Stroke<B> {
    for (place, series) in series.iter().enumerate() {
        let index = series.colour.unwrap_or(place);
        let colour = ink.unwrap_or(PALETTE[index % PALETTE.len()]);
        for run in series.runs() {
            let line = || run.iter().copied();
            match series.mark {
                Mark::Line | Mark::LinePoints => {
                    chart.draw_series(LineSeries::new(line(), colour.stroke_width(2)))?;
                }
                Mark::Dashed => {
                    chart.draw_series(DashedLineSeries::new(line(), 7, 5, colour.stroke_width(2)))?;
                }
                Mark::Dots => {
                    chart.draw_series(line().map(|p| Circle::new(p, 1, colour.filled())))?;
                }
                Mark::Rings => {
                    chart.draw_series(line().map(|p| Circle::new(p, 5, colour.stroke_width(2))))?;
                }
                Mark::Points => {}
            }
            if matches!(series.mark, Mark::Points | Mark::LinePoints) {
                chart.draw_series(line().map(|p| EmptyElement::at(p) + shape(index, colour)))?;
            }
        }
        if let (false, Some(end)) =
            (series.at_end.is_empty(), series.runs().last().and_then(|run| run.last()))
        {
            let text = (FAMILY, 13.0).into_font().color(&colour).pos(Pos::new(HPos::Left, VPos::Center));
            let label = Text::new(series.at_end.clone(), (8, 0), text);
            chart.draw_series(std::iter::once(EmptyElement::at(*end) + label))?;
        }
    }
    Ok(())
}

/// The shape of a point: circle, square, triangle or diamond, by the colour's index.
pub fn shape(index: usize, colour: RGBColor) -> Polygon<(i32, i32)> {
    let outline = match index % 4 {
        0 => vec![(-1, -3), (1, -3), (3, -1), (3, 1), (1, 3), (-1, 3), (-3, 1), (-3, -1)],
        1 => vec![(-3, -3), (3, -3), (3, 3), (-3, 3)],
        2 => vec![(0, -4), (4, 3), (-4, 3)],
        _ => vec![(0, -4), (4, 0), (0, 4), (-4, 0)],
    };
    Polygon::new(outline, colour.filled())
}
