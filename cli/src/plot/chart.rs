use super::{
    curves::{self, shape},
    drawing::{self, Drawing, Drawn, SIZE, Stroke},
    font::FAMILY,
    mark::{Mark, PALETTE, Series},
    scale::{TICKS, decimals, label, range_of},
};
use crate::failure::Failure;
use plotters::{coord::Shift, prelude::*};
use std::{ops::Range, path::Path};

/// Colours of ink and grid; in a report they become those of the reader's light or dark page.
const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
const GRID: RGBColor = RGBColor(0xDD, 0xDD, 0xDD);

const TITLE: f64 = 19.0;
const SUBTITLE: f64 = 14.0;
const LABEL: f64 = 15.0;

/// A chart of series over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Title, one line.
    pub title: String,
    /// A line under it, smaller; empty for none.
    pub subtitle: String,
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// What the legend's names mean, over it, in a line or several; empty for nothing.
    pub legend: String,
    /// The series.
    pub series: Vec<Series>,
    /// Whether a length is the same on both axes, as on a map.
    pub equal_axes: bool,
}

impl Drawing for Chart {
    fn draw<B: DrawingBackend>(&self, root: &DrawingArea<B, Shift>) -> Stroke<B>
    where
        B::ErrorType: 'static,
    {
        let (plot, legend) = self.split(root);
        self.draw_plot(&plot)?;
        match legend {
            Some(legend) => self.draw_legend(&legend),
            None => Ok(()),
        }
    }
}

impl Chart {
    /// An empty chart.
    pub fn new(title: impl Into<String>, x_label: impl Into<String>, y_label: impl Into<String>) -> Self {
        let [title, x_label, y_label] = [title.into(), x_label.into(), y_label.into()];
        let [subtitle, legend] = [String::new(), String::new()];
        Chart { title, subtitle, x_label, y_label, legend, series: Vec::new(), equal_axes: false }
    }

    /// Adds a series.
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The chart as an SVG file's text, on white.
    pub fn svg(&self) -> Drawn<String> {
        drawing::svg(self, true)
    }

    /// The chart as an SVG element for a report: no background, ink and grid in the colours of the page.
    pub fn inline_svg(&self) -> Drawn<String> {
        let hex = |colour: RGBColor| format!("\"#{:02X}{:02X}{:02X}\"", colour.0, colour.1, colour.2);
        let svg = drawing::svg(self, false)?;
        Ok(svg.replace(&hex(INK), "\"currentColor\"").replace(&hex(GRID), "\"var(--grid)\""))
    }

    /// Writes `stem.svg` and `stem.png` into a directory.
    pub fn write(&self, directory: &Path, stem: &str) -> Result<(), Failure> {
        drawing::write(self, self.svg(), directory, stem)
    }

    /// The area of the plot and that of the legend, where there is something to tell.
    fn split<B: DrawingBackend>(
        &self,
        root: &DrawingArea<B, Shift>,
    ) -> (DrawingArea<B, Shift>, Option<DrawingArea<B, Shift>>) {
        let length = |text: &str| text.chars().count();
        let widest = self.series.iter().map(|series| length(&series.name)).max().unwrap_or(0);
        if widest == 0 {
            return (root.clone(), None);
        }
        let head = self.legend.lines().map(length).max().unwrap_or(0);
        let width = |letters: usize| (letters as f64 * 0.56 * LABEL) as u32;
        let width = (width(widest) + 52).max(width(head) + 16);
        let (plot, legend) = root.split_horizontally(SIZE.0.saturating_sub(width.min(SIZE.0 / 2)));
        (plot, Some(legend))
    }

    fn ranges(&self, pixels: (u32, u32)) -> (Range<f64>, Range<f64>) {
        let points = || self.series.iter().flat_map(|series| series.runs().flatten().copied());
        let (x, y) = (range_of(points().map(|p| p.0)), range_of(points().map(|p| p.1)));
        if !self.equal_axes {
            return (x, y);
        }
        let unit = ((x.end - x.start) / f64::from(pixels.0)).max((y.end - y.start) / f64::from(pixels.1));
        let widen = |range: Range<f64>, pixels: u32| {
            let (middle, half) = (0.5 * (range.start + range.end), 0.5 * unit * f64::from(pixels));
            middle - half..middle + half
        };
        (widen(x, pixels.0), widen(y, pixels.1))
    }

    fn draw_plot<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Stroke<B> {
        let (margin, below, left) = (12, 46, 74);
        let titled;
        let (area, caption) = match self.subtitle.is_empty() {
            true => (area, self.title.as_str()),
            false => {
                let title = area.titled(&self.title, (FAMILY, TITLE).into_font().color(&INK))?;
                titled = title.titled(&self.subtitle, (FAMILY, SUBTITLE).into_font().color(&INK))?;
                (&titled, "")
            }
        };
        let (width, height) = area.dim_in_pixel();
        let inside =
            (width.saturating_sub(2 * margin + left), height.saturating_sub(2 * margin + below + 28));
        let (x, y) = self.ranges(inside);
        let (x_decimals, y_decimals) = (decimals(&x), decimals(&y));
        let title = (FAMILY, TITLE).into_font().color(&INK);
        let text = || (FAMILY, LABEL).into_font().color(&INK);
        let mut builder = ChartBuilder::on(area);
        if !caption.is_empty() {
            builder.caption(caption, title);
        }
        let mut chart = builder
            .margin(margin)
            .x_label_area_size(below)
            .y_label_area_size(left)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(self.x_label.as_str())
            .y_desc(self.y_label.as_str())
            .x_labels(TICKS)
            .y_labels(TICKS)
            .x_label_formatter(&|value| label(*value, x_decimals))
            .y_label_formatter(&|value| label(*value, y_decimals))
            .axis_desc_style(text())
            .label_style(text())
            .axis_style(INK)
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .draw()?;
        curves::draw(&mut chart, &self.series, None)
    }

    fn draw_legend<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Stroke<B> {
        let text = (FAMILY, LABEL).into_font().color(&INK);
        let mut y = 52;
        for line in self.legend.lines() {
            area.draw(&Text::new(line.to_owned(), (4, y - 8), text.clone()))?;
            y += 20;
        }
        for (place, series) in self.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty()) {
            let index = series.colour.unwrap_or(place);
            let colour = PALETTE[index % PALETTE.len()];
            let stroke = colour.stroke_width(2);
            match series.mark {
                Mark::Line | Mark::LinePoints => {
                    area.draw(&PathElement::new([(4, y), (30, y)], stroke))?;
                }
                Mark::Dashed => {
                    area.draw(&PathElement::new([(4, y), (14, y)], stroke))?;
                    area.draw(&PathElement::new([(20, y), (30, y)], stroke))?;
                }
                Mark::Dots => area.draw(&Circle::new((17, y), 2, colour.filled()))?,
                Mark::Rings => area.draw(&Circle::new((17, y), 5, stroke))?,
                Mark::Points => {}
            }
            if matches!(series.mark, Mark::Points | Mark::LinePoints) {
                area.draw(&(EmptyElement::at((17, y)) + shape(index, colour)))?;
            }
            area.draw(&Text::new(series.name.clone(), (36, y - 8), text.clone()))?;
            y += 22;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let wave = |phase: f64| (0..60).map(|i| 0.1 * f64::from(i)).map(|x| (x, (x + phase).sin())).collect();
        Chart::new("Waves & gaps", "time (s)", "height (mm)")
            .with(Series::new("seen", Mark::Points, wave(0.0)))
            .with(Series::new("model <a>", Mark::Dashed, wave(0.3)))
            .with(Series::new("broken", Mark::LinePoints, vec![(0.0, 0.0), (1.0, f64::NAN), (2.0, 0.5)]))
    }

    #[test]
    fn an_svg_says_its_units_and_names_and_is_well_formed() {
        let svg = chart().svg().unwrap();
        for word in ["time (s)", "height (mm)", "Waves &amp; gaps", "model &lt;a&gt;"] {
            assert!(svg.contains(word), "{word} is not in {svg}");
        }
        assert!(!svg.contains("NaN"));
        crate::report::check_tags(&svg);
        let inline = chart().inline_svg().unwrap();
        assert!(inline.contains("currentColor") && inline.contains("var(--grid)"));
        assert!(!inline.contains("#222222") && !inline.contains("#FFFFFF"));
    }

    #[test]
    fn a_chart_of_nothing_is_drawn_all_the_same() {
        assert!(Chart::new("nothing", "x", "y").svg().unwrap().contains("nothing"));
        let nan = Series::new("", Mark::Line, vec![(f64::NAN, 1.0)]);
        assert!(Chart::new("not a number", "x", "y").with(nan).svg().is_ok());
    }

    #[test]
    fn equal_axes_have_equal_units() {
        let track = Series::new("", Mark::Line, vec![(0.0, 0.0), (10.0, 1.0)]);
        let chart = Chart { equal_axes: true, ..Chart::new("", "", "") }.with(track);
        let (x, y) = chart.ranges((400, 200));
        assert!(((x.end - x.start) / 400.0 - (y.end - y.start) / 200.0).abs() < 1e-12);
        assert!(x.start <= 0.0 && x.end >= 10.0 && y.start <= 0.0 && y.end >= 1.0);
    }

    #[test]
    fn pictures_are_written() {
        let directory = tempfile::tempdir().unwrap();
        chart().write(directory.path(), "waves").unwrap();
        let png = std::fs::read(directory.path().join("waves.png")).unwrap();
        assert_eq!(&png[1..4], b"PNG");
    }
}
