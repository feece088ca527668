use super::{
    curves,
    drawing::{self, Drawing, Drawn, SIZE, Stroke},
    font::FAMILY,
    mark::Series,
    scale::{decimals, label, range_of},
};
use crate::failure::Failure;
use plotters::{coord::Shift, prelude::*};
use std::{ops::Range, path::Path};

const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
const BAR: (u32, i32, i32) = (120, 52, 400);
const LABEL: f64 = 15.0;

/// Viridis at equal distances, after Smith and van der Walt: dark to bright also in print without colour.
const COLOURS: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [65.0, 68.0, 135.0],
    [42.0, 120.0, 142.0],
    [34.0, 168.0, 132.0],
    [122.0, 209.0, 81.0],
    [253.0, 231.0, 37.0],
];

/// A piece of a plane with a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Its corners in their order around it.
    pub corners: [(f64, f64); 4],
    /// What its colour tells.
    pub value: f64,
}

/// Values over a plane, as colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Title, one line.
    pub title: String,
    /// A line under it, smaller; empty for none.
    pub subtitle: String,
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// What the colours tell.
    pub value_label: String,
    /// The pieces; later ones hide earlier ones.
    pub patches: Vec<Patch>,
    /// Lines over them, in ink.
    pub lines: Vec<Series>,
    /// Whether a length is the same on both axes, as on a map.
    pub equal_axes: bool,
    /// Colours by the value's logarithm between these ends; beyond them the colour of the end.
    pub logarithmic: Option<Range<f64>>,
}

/// The colour of a share from 0 to 1.
fn colour(share: f64) -> RGBColor {
    let place = share.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let low = (place as usize).min(COLOURS.len() - 2);
    let part = place - low as f64;
    let [r, g, b] =
        std::array::from_fn(|i| (COLOURS[low][i] * (1.0 - part) + COLOURS[low + 1][i] * part).round() as u8);
    RGBColor(r, g, b)
}

/// A positive number with two significant figures.
fn two_figures(value: f64) -> String {
    let decimals = (1.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

impl Drawing for Field {
    fn draw<B: DrawingBackend>(&self, root: &DrawingArea<B, Shift>) -> Stroke<B>
    where
        B::ErrorType: 'static,
    {
        let (plot, bar) = root.split_horizontally(SIZE.0 - BAR.0);
        self.draw_patches(&plot)?;
        self.draw_bar(&bar)
    }
}

impl Field {
    /// A field of nothing.
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
        value_label: impl Into<String>,
    ) -> Self {
        Field {
            title: title.into(),
            subtitle: String::new(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            value_label: value_label.into(),
            patches: vec![],
            lines: vec![],
            equal_axes: true,
            logarithmic: None,
        }
    }

    /// The field as an SVG file's text, on white.
    pub fn svg(&self) -> Drawn<String> {
        self.draw_svg(true)
    }

    /// The field as an SVG element for a report, with ink in the colour of the page.
    pub fn inline_svg(&self) -> Drawn<String> {
        let ink = format!("\"#{:02X}{:02X}{:02X}\"", INK.0, INK.1, INK.2);
        Ok(self.draw_svg(false)?.replace(&ink, "\"currentColor\""))
    }

    fn draw_svg(&self, on_white: bool) -> Drawn<String> {
        // Between smoothed edges of neighbours the background would shine through.
        Ok(drawing::svg(self, on_white)?.replacen("<svg ", "<svg shape-rendering=\"crispEdges\" ", 1))
    }

    /// Writes `stem.svg` and `stem.png` into a directory.
    pub fn write(&self, directory: &Path, stem: &str) -> Result<(), Failure> {
        drawing::write(self, self.svg(), directory, stem)
    }

    fn draw_patches<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Stroke<B> {
        let (margin, below, left) = (12, 46, 74);
        let titled;
        let (area, caption) = match self.subtitle.is_empty() {
            true => (area, self.title.as_str()),
            false => {
                let title = area.titled(&self.title, (FAMILY, 19.0).into_font().color(&INK))?;
                titled = title.titled(&self.subtitle, (FAMILY, 14.0).into_font().color(&INK))?;
                (&titled, "")
            }
        };
        let (width, height) = area.dim_in_pixel();
        let inside =
            [width.saturating_sub(2 * margin + left), height.saturating_sub(2 * margin + below + 28)];
        let corners = || self.patches.iter().flat_map(|patch| patch.corners);
        let ranges = [range_of(corners().map(|at| at.0)), range_of(corners().map(|at| at.1))];
        let spans = ranges.iter().zip(inside);
        let unit =
            spans.map(|(range, pixels)| (range.end - range.start) / f64::from(pixels)).fold(0.0, f64::max);
        let [x, y] = [0, 1].map(|axis| {
            let middle = 0.5 * (ranges[axis].start + ranges[axis].end);
            let half = 0.5 * unit * f64::from(inside[axis]);
            if self.equal_axes { middle - half..middle + half } else { ranges[axis].clone() }
        });
        let (x_decimals, y_decimals) = (decimals(&x), decimals(&y));
        let text = || (FAMILY, LABEL).into_font().color(&INK);
        let mut builder = ChartBuilder::on(area);
        if !caption.is_empty() {
            builder.caption(caption, (FAMILY, 19.0).into_font().color(&INK));
        }
        let mut chart = builder
            .margin(margin)
            .x_label_area_size(below)
            .y_label_area_size(left)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(self.x_label.as_str())
            .y_desc(self.y_label.as_str())
            .x_label_formatter(&|value| label(*value, x_decimals))
            .y_label_formatter(&|value| label(*value, y_decimals))
            .axis_desc_style(text())
            .label_style(text())
            .axis_style(INK)
            .draw()?;
        let values = self.values();
        let height = |value: f64| if self.logarithmic.is_some() { value.log10() } else { value };
        let share = |value: f64| (height(value) - values.start) / (values.end - values.start);
        chart.draw_series(
            self.patches
                .iter()
                .map(|patch| Polygon::new(patch.corners.to_vec(), colour(share(patch.value)).filled())),
        )?;
        curves::draw(&mut chart, &self.lines, Some(INK))
    }

    /// Values, or their logarithms, at the ends of the colours.
    fn values(&self) -> Range<f64> {
        if let Some(ends) = &self.logarithmic {
            return ends.start.log10()..ends.end.log10();
        }
        let finite = self.patches.iter().map(|patch| patch.value).filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low < high { low..high } else { 0.0..1.0 }
    }

    fn draw_bar<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Stroke<B> {
        let (_, top, bottom) = BAR;
        for y in top..bottom {
            let share = f64::from(bottom - y) / f64::from(bottom - top);
            area.draw(&Rectangle::new([(4, y), (22, y + 1)], colour(share).filled()))?;
        }
        let text = (FAMILY, LABEL).into_font().color(&INK);
        let values = self.values();
        let decimals = decimals(&values) + 1;
        for tick in 0..=5 {
            let share = f64::from(tick) / 5.0;
            let value = values.start + share * (values.end - values.start);
            let y = bottom - (share * f64::from(bottom - top)).round() as i32;
            let words = match (&self.logarithmic, tick) {
                (None, _) => label(value, decimals),
                (Some(_), 0) => format!("≤ {}", two_figures(10f64.powf(value))),
                (Some(_), 5) => format!("≥ {}", two_figures(10f64.powf(value))),
                (Some(_), _) => two_figures(10f64.powf(value)),
            };
            area.draw(&Text::new(words, (28, y - 8), text.clone()))?;
        }
        let upright = (FAMILY, LABEL).into_font().transform(FontTransform::Rotate90).color(&INK);
        area.draw(&Text::new(self.value_label.clone(), (104, top + 60), upright))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_drawn_with_its_least_and_greatest_value() {
        let patch =
            |x: f64, value| Patch { corners: [(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)], value };
        let field = Field {
            patches: vec![patch(0.0, 0.125), patch(1.0, 0.875)],
            ..Field::new("a < b", "x (mm)", "y (mm)", "strain")
        };
        let svg = field.svg().unwrap();
        crate::report::check_tags(&svg);
        for word in ["0.12", "0.8", "a &lt; b", "strain", "#440154", "#FDE725"] {
            assert!(svg.contains(word), "{word}");
        }
        assert!(field.inline_svg().unwrap().contains("currentColor"));
        assert!(Field::new("nothing", "", "", "").svg().is_ok());
        let directory = tempfile::tempdir().unwrap();
        field.write(directory.path(), "field").unwrap();
        assert_eq!(&std::fs::read(directory.path().join("field.png")).unwrap()[1..4], b"PNG");
    }
}
