//! Tests of rubber and thread: a header, then one row a point.

use crate::failure::Failure;
use fe::material::calibration::{LoadingMode, TestPoint};
use std::path::Path;

/// Rows of a CSV file with their lines.
struct Rows<'a> {
    path: &'a Path,
    head: Vec<String>,
    rows: Vec<(u64, csv::StringRecord)>,
}

impl<'a> Rows<'a> {
    fn read(path: &'a Path, example: &str) -> Result<Self, Failure> {
        let bytes = std::fs::read(path).map_err(Failure::at(path))?;
        let file = path.display();
        let broken = |error: csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            Failure::file(format!("{file}:{line}: {error}"))
        };
        let mut reader =
            csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(&bytes[..]);
        let head = reader.headers().map_err(broken)?;
        let head: Vec<String> =
            head.iter().map(|name| name.trim_start_matches('\u{feff}').to_owned()).collect();
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(broken)?;
            rows.push((record.position().map_or(0, csv::Position::line), record));
        }
        if rows.is_empty() {
            return Err(Failure::file(format!(
                "{file}: has no rows; write a header {example} and a row a point"
            )));
        }
        Ok(Rows { path, head, rows })
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.head.iter().position(|known| known == name)
    }

    fn required(&self, names: &[&str]) -> Result<usize, Failure> {
        names.iter().find_map(|name| self.place(name)).ok_or_else(|| {
            Failure::file(format!(
                "{}:1: column `{}` is missing; the header has {}",
                self.path.display(),
                names.join("` or `"),
                self.head.join(", ")
            ))
        })
    }

    fn error(&self, line: u64, column: usize, problem: String) -> Failure {
        Failure::file(format!("{}:{line}: column `{}`: {problem}", self.path.display(), self.head[column]))
    }

    fn number(&self, (line, record): &(u64, csv::StringRecord), column: usize) -> Result<f64, Failure> {
        let cell = record.get(column).unwrap_or_default();
        match cell.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ if cell.is_empty() => Err(self.error(*line, column, "is empty; write a number".into())),
            _ => Err(self.error(*line, column, format!("`{cell}` is not a number"))),
        }
    }
}

/// Reads tests of a rubber: columns mode, stretch, stress_mpa (nominal); others are left alone.
pub fn read_tests(path: &Path) -> Result<Vec<TestPoint>, Failure> {
    let rows = Rows::read(path, "mode,stretch,stress_mpa")?;
    let (mode, stretch, stress) =
        (rows.required(&["mode"])?, rows.required(&["stretch"])?, rows.required(&["stress_mpa"])?);
    let mut points = Vec::new();
    for row in &rows.rows {
        let word = row.1.get(mode).unwrap_or_default();
        let Some(known) = LoadingMode::ALL.into_iter().find(|known| known.name() == word) else {
            let problem = format!("unknown mode \"{word}\"; write uniaxial, equibiaxial or planar");
            return Err(rows.error(row.0, mode, problem));
        };
        let at = rows.number(row, stretch)?;
        if !(1e-2..=1e2).contains(&at) {
            let problem = format!(
                "{at} is no stretch (length over length at rest, 1 + strain); it lies between 0.01 and 100"
            );
            return Err(rows.error(row.0, stretch, problem));
        }
        let pull = rows.number(row, stress)? * actuator::units::MPA;
        if (at - 1.0) * pull < 0.0 {
            let problem =
                "pulls where the stretch is below 1, or pushes where it is above; tension is positive".into();
            return Err(rows.error(row.0, stress, problem));
        }
        points.push(TestPoint { mode: known, stretch: at, stress: pull });
    }
    Ok(points)
}

/// Reads the pull of a thread as pairs of strain and force (N): columns strain, or extension_mm of a thread of `length_mm`, and
/// force_n.
pub fn read_pull(path: &Path, length_mm: Option<f64>) -> Result<Vec<(f64, f64)>, Failure> {
    let rows = Rows::read(path, "strain,force_n")?;
    let force = rows.required(&["force_n"])?;
    let along = rows.required(&["strain", "extension_mm"])?;
    let scale = match (rows.head[along].as_str(), length_mm) {
        ("strain", _) => 1.0,
        (_, Some(length)) => 1.0 / length,
        _ => {
            return Err(Failure::usage(format!(
                "{}: column `extension_mm` needs the length of the thread: give --fibre-length-mm",
                path.display()
            )));
        }
    };
    rows.rows.iter().map(|row| Ok((scale * rows.number(row, along)?, rows.number(row, force)?))).collect()
}
