use super::{Chart, Field};
use crate::failure::Failure;
use std::path::Path;

/// What a figure shows.
#[derive(Clone, Debug)]
pub enum Picture {
    /// Curves.
    Chart(Chart),
    /// Values over a plane.
    Field(Field),
}

impl From<Chart> for Picture {
    fn from(chart: Chart) -> Self {
        Picture::Chart(chart)
    }
}

impl From<Field> for Picture {
    fn from(field: Field) -> Self {
        Picture::Field(field)
    }
}

impl Picture {
    /// Its title.
    pub fn title(&self) -> &str {
        match self {
            Picture::Chart(chart) => &chart.title,
            Picture::Field(field) => &field.title,
        }
    }

    /// As an element of a page.
    pub fn inline_svg(&self) -> Result<String, Failure> {
        match self {
            Picture::Chart(chart) => chart.inline_svg(),
            Picture::Field(field) => field.inline_svg(),
        }
        .map_err(Failure::file)
    }

    /// Writes `stem.svg` and `stem.png`.
    pub fn write(&self, directory: &Path, stem: &str) -> Result<(), Failure> {
        match self {
            Picture::Chart(chart) => chart.write(directory, stem),
            Picture::Field(field) => field.write(directory, stem),
        }
    }
}
