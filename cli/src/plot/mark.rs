//! What a series looks like.

use plotters::style::RGBColor;

/// Okabe and Ito's colours, told apart by colour-blind readers, darkened where too pale for a white page; a grey and a violet
/// stand for their black and yellow, which a dark or a white page swallows.
pub const PALETTE: [RGBColor; 8] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xB8, 0x86, 0x00),
    RGBColor(0x3B, 0xA3, 0xDE),
    RGBColor(0x80, 0x80, 0x80),
    RGBColor(0x8E, 0x5B, 0xC9),
];

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line through the points.
    Line,
    /// A dashed line: a limit, a target, a model beside data.
    Dashed,
    /// Points; their shape changes with the colour, so that print without colour can be read.
    Points,
    /// Small dots, for thousands of points.
    Dots,
    /// A line with points.
    LinePoints,
    /// Open circles: where a curve ends.
    Rings,
}

/// Points under a name. A point that is not finite breaks a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend; empty for none.
    pub name: String,
    /// The points.
    pub points: Vec<(f64, f64)>,
    /// How they are drawn.
    pub mark: Mark,
    /// Which colour; by default that of the series' place in the chart.
    pub colour: Option<usize>,
    /// What is written at its last point; empty for nothing.
    pub at_end: String,
}

impl Series {
    /// A series in the colour of its place.
    pub fn new(name: impl Into<String>, mark: Mark, points: Vec<(f64, f64)>) -> Self {
        Series { name: name.into(), points, mark, colour: None, at_end: String::new() }
    }

    /// The same in a given colour, to pair series.
    pub fn coloured(self, colour: usize) -> Self {
        Series { colour: Some(colour), ..self }
    }

    /// The runs of finite points.
    pub fn runs(&self) -> impl Iterator<Item = &[(f64, f64)]> {
        self.points.split(|(x, y)| !x.is_finite() || !y.is_finite()).filter(|run| !run.is_empty())
    }
}
