//! Tables of pressures for `predict`: a header, then one row a state. Columns that are not asked for are left alone.

use crate::failure::Failure;
use std::path::Path;

/// Columns of a CSV file that were asked for, row by row, as numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// Names, in the order asked for; of alternatives, the one found.
    pub names: Vec<String>,
    /// Numbers, one row a state.
    pub rows: Vec<Vec<f64>>,
}

/// A column that is asked for: its name or names, and whether the file may lack it.
pub struct Wanted<'a> {
    /// The name, and other names it may have.
    pub names: &'a [&'a str],
    /// Whether the file may lack it.
    pub optional: bool,
}

impl Columns {
    /// Reads the wanted columns of a CSV text; `path` is for messages. `frees` is how many FREEs the model has.
    pub fn parse(path: &Path, text: &[u8], wanted: &[Wanted], frees: usize) -> Result<Self, Failure> {
        let file = path.display();
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text);
        let broken = |error: csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            Failure::file(format!("{file}:{line}: {error}"))
        };
        let head = reader.headers().map_err(broken)?.clone();
        let head: Vec<&str> = head.iter().map(|name| name.trim_start_matches('\u{feff}')).collect();
        if head.iter().all(|name| name.is_empty()) {
            return Err(Failure::file(format!(
                "{file}: is empty; write a header such as p1_kpa,p2_kpa and a row a state"
            )));
        }
        let free_of = |name: &str| name.strip_prefix('p')?.strip_suffix("_kpa")?.parse::<usize>().ok();
        if let Some(name) =
            head.iter().find(|name| free_of(name).is_some_and(|free| free == 0 || free > frees))
        {
            return Err(Failure::file(format!(
                "{file}:1: column `{name}`: the model has {frees} FREEs, counted from 1"
            )));
        }
        let (mut names, mut places) = (Vec::new(), Vec::new());
        for column in wanted {
            let found: Vec<usize> = (0..head.len()).filter(|i| column.names.contains(&head[*i])).collect();
            match found[..] {
                [place] => {
                    names.push(head[place].to_owned());
                    places.push(place);
                }
                [] if column.optional => {}
                [] => {
                    let missing = column.names.join("` or `");
                    return Err(Failure::file(format!(
                        "{file}:1: column `{missing}` is missing; the header has {}",
                        head.join(", ")
                    )));
                }
                _ => {
                    return Err(Failure::file(format!(
                        "{file}:1: column `{}` stands twice",
                        column.names.join("` or `")
                    )));
                }
            }
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(broken)?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |place: &usize| {
                let cell = record.get(*place).unwrap_or_default();
                cell.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| {
                    let problem = match cell {
                        "" => "is empty; write a number".to_owned(),
                        _ => format!("`{cell}` is not a number"),
                    };
                    Failure::file(format!("{file}:{line}: column `{}`: {problem}", head[*place]))
                })
            };
            rows.push(places.iter().map(number).collect::<Result<Vec<_>, _>>()?);
        }
        if rows.is_empty() {
            return Err(Failure::file(format!("{file}: has a header but no rows; write one row a state")));
        }
        Ok(Columns { names, rows })
    }

    /// Place of a column by its name.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: [Wanted; 3] = [
        Wanted { names: &["p1_kpa"], optional: false },
        Wanted { names: &["p2_kpa"], optional: false },
        Wanted { names: &["t_s"], optional: true },
    ];

    fn parse(text: &str) -> Result<Columns, String> {
        Columns::parse(Path::new("in.csv"), text.as_bytes(), &TWO, 2).map_err(|failure| failure.paragraph())
    }

    #[test]
    fn columns_are_found_by_name() {
        let columns = parse("# by hand\nx_mm, p2_kpa,p1_kpa\n9,2,1\n9,4,3\n").unwrap();
        assert_eq!(columns.names, ["p1_kpa", "p2_kpa"]);
        assert_eq!(columns.rows, [[1.0, 2.0], [3.0, 4.0]]);
        assert_eq!((columns.place("p2_kpa"), columns.place("t_s")), (Some(1), None));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        for (text, word) in [
            ("", "in.csv: is empty"),
            ("p1_kpa\n1\n", "in.csv:1: column `p2_kpa` is missing"),
            ("p1_kpa,p2_kpa\n", "no rows"),
            ("p1_kpa,p2_kpa,p3_kpa\n1,2,3\n", "in.csv:1: column `p3_kpa`: the model has 2 FREEs"),
            ("p1_kpa,p2_kpa\n1,2\n3,x\n", "in.csv:3: column `p2_kpa`: `x` is not a number"),
            ("p1_kpa,p2_kpa\n1,nan\n", "in.csv:2: column `p2_kpa`"),
            ("p1_kpa,p2_kpa\n1,\n", "in.csv:2: column `p2_kpa`: is empty; write a number"),
            ("p1_kpa,p2_kpa\n1\n", "in.csv:2:"),
            ("p1_kpa,p1_kpa,p2_kpa\n1,1,2\n", "stands twice"),
        ] {
            let message = parse(text).unwrap_err();
            assert!(message.contains(word), "{text:?}: {message}");
        }
    }
}
