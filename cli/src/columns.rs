//! A table of numbers and words by columns: what CSV and Parquet files hold.

use crate::map_csv::number;

/// A cell of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// A number; one that is not finite counts as empty.
    Number(f64),
    /// A word.
    Word(&'static str),
    /// Nothing.
    Empty,
}

/// The cells of a column, one a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; `None` where there is none.
    Numbers(Vec<Option<f64>>),
    /// Words.
    Words(Vec<&'static str>),
}

/// A column under its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, with its unit.
    pub name: String,
    /// Its cells.
    pub values: Values,
}

/// Columns of equal length, and what is to be known of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// The columns.
    pub columns: Vec<Column>,
    /// Keys and texts about the whole: name, settings, description.
    pub about: Vec<(&'static str, String)>,
    /// Number of rows.
    pub rows: usize,
}

/// Twelve significant figures, without the dust of a conversion of units; `None` for what is no number.
pub fn rounded(value: f64) -> Option<f64> {
    // 0.0 and -0.0 are one number to a reader.
    value.is_finite().then(|| format!("{value:.11e}").parse().unwrap_or(value) + 0.0)
}

impl Columns {
    /// Columns without rows: those named in `words` hold words, the others numbers.
    pub fn new(names: impl IntoIterator<Item = String>, words: &[&str]) -> Self {
        let column = |name: String| match words.contains(&name.as_str()) {
            true => Column { name, values: Values::Words(vec![]) },
            false => Column { name, values: Values::Numbers(vec![]) },
        };
        Columns { columns: names.into_iter().map(column).collect(), about: vec![], rows: 0 }
    }

    /// Adds a row; missing cells are empty.
    pub fn push(&mut self, row: &[Cell]) {
        for (i, column) in self.columns.iter_mut().enumerate() {
            let cell = row.get(i).copied().unwrap_or(Cell::Empty);
            match (&mut column.values, cell) {
                (Values::Numbers(numbers), Cell::Number(value)) => numbers.push(rounded(value)),
                (Values::Numbers(numbers), _) => numbers.push(None),
                (Values::Words(words), Cell::Word(word)) => words.push(word),
                (Values::Words(words), _) => words.push(""),
            }
        }
        self.rows += 1;
    }

    /// The same with a text about the whole.
    pub fn about(mut self, key: &'static str, text: impl Into<String>) -> Self {
        self.about.push((key, text.into()));
        self
    }

    /// The columns as CSV: names, then a line a row, empty cells empty.
    pub fn csv(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|column| column.name.as_str()).collect();
        let mut text = names.join(",") + "\n";
        for row in 0..self.rows {
            for (i, column) in self.columns.iter().enumerate() {
                if i > 0 {
                    text.push(',');
                }
                match &column.values {
                    Values::Numbers(numbers) => text += &numbers[row].map(number).unwrap_or_default(),
                    Values::Words(words) => text += words[row],
                }
            }
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_cells_stay_empty_and_dust_goes() {
        let names = ["a", "status", "b"].map(str::to_owned);
        let mut columns = Columns::new(names, &["status"]);
        columns.push(&[Cell::Number(0.1 + 0.2), Cell::Word("good"), Cell::Number(-0.0)]);
        columns.push(&[Cell::Number(f64::NAN)]);
        assert_eq!(columns.csv(), "a,status,b\n0.3,good,0\n,,\n");
        assert_eq!(columns.columns[0].values, Values::Numbers(vec![Some(0.3), None]));
    }
}
