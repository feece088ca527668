pub use crate::plot::Picture;

use crate::table::Table;
use std::fmt;

/// What became of a claim of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Our computation shows the same.
    Holds,
    /// It shows otherwise.
    DoesNotHold,
    /// What the paper gives, or what is computed here, does not suffice.
    CannotBeJudged,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Verdict::Holds => "holds",
            Verdict::DoesNotHold => "does not hold",
            Verdict::CannotBeJudged => "cannot be judged",
        })
    }
}

impl Verdict {
    /// Of a claim that can be judged.
    pub fn of(holds: bool) -> Self {
        if holds { Verdict::Holds } else { Verdict::DoesNotHold }
    }
}

/// A claim and what became of it.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Row of the table of claims, "P4".
    pub row: &'static str,
    /// What the paper says.
    pub claim: &'static str,
    /// What is found here, with numbers.
    pub ours: String,
    /// Whether they agree.
    pub verdict: Verdict,
    /// Why.
    pub reason: String,
}

/// A table under a title.
#[derive(Clone, Debug)]
pub struct Titled {
    /// Its title.
    pub title: String,
    /// Heads of its columns; one that begins with `<` is set flush left.
    pub head: Vec<String>,
    /// Its cells.
    pub rows: Vec<Vec<String>>,
}

impl Titled {
    /// An empty table.
    pub fn new<const N: usize>(title: impl Into<String>, head: [&str; N]) -> Self {
        Titled { title: title.into(), head: head.map(str::to_owned).to_vec(), rows: vec![] }
    }

    /// The table as text.
    pub fn text(&self) -> String {
        let mut table = Table::with_head(self.head.clone());
        self.rows.iter().for_each(|row| table.row_of(row.clone()));
        table.text()
    }
}

/// Rows of numbers for a CSV file.
#[derive(Clone, Debug)]
pub struct Curves {
    /// Name of the file without its ending.
    pub stem: String,
    /// Names of the columns, with units.
    pub head: Vec<&'static str>,
    /// Texts and numbers as they are written.
    pub rows: Vec<Vec<String>>,
}

impl Curves {
    /// The file.
    pub fn csv(&self) -> String {
        let lines = std::iter::once(self.head.join(",")).chain(self.rows.iter().map(|row| row.join(",")));
        lines.map(|line| line + "\n").collect()
    }
}

/// A state for viewers of finite elements.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Name of the file, with its ending.
    pub name: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

/// What a study came to.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// What was computed, in sentences.
    pub setup: Vec<String>,
    /// The claims.
    pub findings: Vec<Finding>,
    /// Numbers.
    pub tables: Vec<Titled>,
    /// Stem of the file, picture, sentence under it.
    pub figures: Vec<(&'static str, Picture, String)>,
    /// Every curve.
    pub curves: Vec<Curves>,
    /// Files for viewers.
    pub grids: Vec<Grid>,
}
