use actuator::units::MM;
use std::{io, path::Path, path::PathBuf};

/// A pose that the tip shall have at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Time, s.
    pub time: f64,
    /// Position of the plate's centre, m.
    pub position: [f64; 3],
    /// Rotation (w, x, y, z), where it matters.
    pub rotation: Option<[f64; 4]>,
}

/// What is wrong with a file of waypoints, and where.
#[derive(Debug, thiserror::Error)]
pub enum WaypointError {
    /// The file cannot be read.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// It is no CSV.
    #[error("{path}: {source}", path = path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// The reader's reason.
        source: csv::Error,
    },
    /// The header misses a column or has one that is not known.
    #[error("{path}:1: column `{column}` {problem}; the header is t_s,x_mm,y_mm,z_mm or t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz", path = path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// Name of the column.
        column: String,
        /// What about it.
        problem: &'static str,
    },
    /// A field says something that cannot be.
    #[error("{path}:{line}: column `{column}`: {message}", path = path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// Line, counted from one.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// What is wrong and what to do.
        message: String,
    },
    /// There is nothing to follow.
    #[error("{path}: there is no waypoint below the header; write at least one", path = path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
}

const COLUMNS: [&str; 8] = ["t_s", "x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz"];

/// Reads a CSV file of waypoints: columns `t_s, x_mm, y_mm, z_mm` in any order, and `qw, qx, qy, qz` all or none; a row
/// whose four quaternion fields are empty leaves the rotation free. Times rise.
pub fn read_waypoints(path: &Path) -> Result<Vec<Waypoint>, WaypointError> {
    let file =
        std::fs::File::open(path).map_err(|source| WaypointError::Io { path: path.to_owned(), source })?;
    waypoints_from(path, file)
}

/// Reads waypoints from the content of a CSV file; `path` is for messages.
pub fn waypoints_from(path: &Path, content: impl io::Read) -> Result<Vec<Waypoint>, WaypointError> {
    let in_csv = |source| WaypointError::Csv { path: path.to_owned(), source };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(content);
    let header = reader.headers().map_err(in_csv)?.clone();
    let wrong = |column: &str, problem| WaypointError::Header {
        path: path.to_owned(),
        column: column.to_owned(),
        problem,
    };
    let mut places = [None; 8];
    for (place, name) in header.iter().enumerate() {
        // A spreadsheet may have written a byte order mark.
        let name = name.trim_start_matches('\u{feff}');
        let column =
            COLUMNS.iter().position(|column| *column == name).ok_or_else(|| wrong(name, "is not known"))?;
        if places[column].replace(place).is_some() {
            return Err(wrong(name, "stands there twice"));
        }
    }
    let turned = places[4..].iter().any(Option::is_some);
    let needed = if turned { 8 } else { 4 };
    if let Some(missing) = (0..needed).find(|&column| places[column].is_none()) {
        return Err(wrong(COLUMNS[missing], "is missing"));
    }
    let mut waypoints: Vec<Waypoint> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(in_csv)?;
        let line = record.position().map_or(0, csv::Position::line);
        let error = |column: usize, message| WaypointError::Field {
            path: path.to_owned(),
            line,
            column: COLUMNS[column],
            message,
        };
        let text = |column: usize| places[column].and_then(|place| record.get(place)).unwrap_or("");
        let number = |column: usize| match text(column).parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ if text(column).is_empty() => Err(error(column, "is empty; write a number".into())),
            _ => Err(error(column, format!("`{}` is not a finite number; write it like 12.5", text(column)))),
        };
        let time = number(0)?;
        if let Some(last) = waypoints.last().filter(|last| last.time >= time) {
            return Err(error(0, format!("{time} s does not follow {} s; times must rise", last.time)));
        }
        let position = [number(1)? * MM, number(2)? * MM, number(3)? * MM];
        let rotation = if !turned || (4..8).all(|column| text(column).is_empty()) {
            None
        } else {
            let wxyz = [number(4)?, number(5)?, number(6)?, number(7)?];
            let length = wxyz.iter().map(|value| value * value).sum::<f64>().sqrt();
            // Rounded to two decimals a unit quaternion is within 1 %: farther off it is something else.
            if (length - 1.0).abs() > 0.02 {
                return Err(error(4, format!("the quaternion has length {length:.4}; it must be 1")));
            }
            Some(wxyz)
        };
        waypoints.push(Waypoint { time, position, rotation });
    }
    if waypoints.is_empty() {
        return Err(WaypointError::Empty { path: path.to_owned() });
    }
    Ok(waypoints)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Waypoint>, String> {
        waypoints_from(Path::new("w.csv"), text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn both_forms_are_read() {
        let plain = read("t_s,x_mm,y_mm,z_mm\n0,1,2,170\n 0.5 , -1, 2e0, 171\n").unwrap();
        assert_eq!(plain[1], Waypoint { time: 0.5, position: [-MM, 2.0 * MM, 171.0 * MM], rotation: None });
        let turned = read("\u{feff}qw,qx,qy,qz,t_s,x_mm,y_mm,z_mm\n1,0,0,0,0,1,2,3\n,,,,1,1,2,3\n").unwrap();
        assert_eq!(turned[0].rotation, Some([1.0, 0.0, 0.0, 0.0]));
        assert_eq!(turned[1].rotation, None);
    }

    #[test]
    fn errors_name_file_line_and_column() {
        let table = [
            ("t_s,x_mm,y_mm\n0,1,2\n", "w.csv:1: column `z_mm` is missing"),
            ("t_s,x_mm,y_mm,z_m\n0,1,2,3\n", "column `z_m` is not known"),
            ("t_s,x_mm,x_mm,z_mm\n0,1,2,3\n", "`x_mm` stands there twice"),
            ("t_s,x_mm,y_mm,z_mm,qw\n0,1,2,3,1\n", "`qx` is missing"),
            ("t_s,x_mm,y_mm,z_mm\n0,1,2,3\n1,1,two,3\n", "w.csv:3: column `y_mm`: `two`"),
            ("t_s,x_mm,y_mm,z_mm\n0,1,2,\n", "w.csv:2: column `z_mm`: is empty"),
            ("t_s,x_mm,y_mm,z_mm\n0,1,nan,3\n", "`nan` is not a finite number"),
            ("t_s,x_mm,y_mm,z_mm\n1,1,2,3\n1,1,2,3\n", "w.csv:3: column `t_s`: 1 s does not follow 1 s"),
            ("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,1,2,3,0,0,0,0\n", "column `qw`: the quaternion has length 0"),
            ("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,1,2,3,1,,0,0\n", "column `qx`: is empty"),
            ("t_s,x_mm,y_mm,z_mm\n", "no waypoint"),
            ("t_s,x_mm,y_mm,z_mm\n0,1\n", "w.csv"),
            ("", "column `t_s` is missing"),
        ];
        for (text, expected) in table {
            let message = read(text).unwrap_err();
            assert!(message.contains(expected), "{message} lacks {expected}");
        }
        let binary = waypoints_from(Path::new("w.csv"), &b"t_s,x_mm,y_mm,z_mm\n\xff\xfe,1,2,3\n"[..]);
        assert!(binary.is_err());
    }
}
