//! Tables for reading: aligned columns, a line under the head.

/// Rows of cells under a head.
pub struct Table {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these column heads; a head that begins with `<` is set flush left, the others flush right.
    pub fn new<const N: usize>(head: [&str; N]) -> Self {
        Table { head: head.map(str::to_owned).to_vec(), rows: Vec::new() }
    }

    /// The same for a number of columns known only when run.
    pub fn with_head(head: Vec<String>) -> Self {
        Table { head, rows: Vec::new() }
    }

    /// Adds a row; missing cells are empty.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.to_vec());
    }

    /// Adds a row of a number of cells known only when run.
    pub fn row_of(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    /// The table as text, ending in a line break.
    pub fn text(&self) -> String {
        let columns = self.head.len();
        let plain = |head: &str| head.trim_start_matches('<').to_owned();
        let cell = |row: &Vec<String>, i: usize| row.get(i).cloned().unwrap_or_default();
        let width = |i: usize| {
            let cells = self.rows.iter().map(|row| cell(row, i).chars().count());
            cells.chain([plain(&self.head[i]).chars().count()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let line = |cells: Vec<String>| {
            let padded = cells.iter().zip(&widths).zip(&self.head).map(|((cell, &width), head)| {
                if head.starts_with('<') { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            format!("  {}", padded.collect::<Vec<_>>().join("  ")).trim_end().to_owned() + "\n"
        };
        let mut text = String::new();
        if self.head.iter().any(|head| !plain(head).is_empty()) {
            text += &line(self.head.iter().map(|head| plain(head)).collect());
            text += &line(widths.iter().map(|&width| "─".repeat(width)).collect());
        }
        for row in &self.rows {
            text += &line((0..columns).map(|i| cell(row, i)).collect());
        }
        text
    }
}

/// A number with four significant figures, without an exponent where it can be read without one.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { "–".into() };
    }
    let magnitude = value.abs().log10().floor() as i32;
    match magnitude {
        -4..=5 => format!("{value:.*}", (3 - magnitude).clamp(0, 6) as usize),
        _ => format!("{value:.2e}"),
    }
}

/// A duration (s) as people say it.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.0} µs", s * 1e6),
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s if s < 100.0 => format!("{s:.1} s"),
        s => format!("{:.0} min {:.0} s", (s / 60.0).floor(), s % 60.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let mut table = Table::new(["<angle", "µ"]);
        table.row(["10°".into(), "0.2".into()]);
        table.row(["5°".into(), "0.393".into()]);
        assert_eq!(table.text(), "  angle      µ\n  ─────  ─────\n  10°      0.2\n  5°     0.393\n");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(0.000_012_3), "1.23e-5");
        assert_eq!(short(0.012_345), "0.01235");
        assert_eq!(short(-49.216), "-49.22");
        assert_eq!(short(123_456.0), "123456");
        assert_eq!(short(f64::NAN), "–");
        assert_eq!(duration(0.0421), "42 ms");
        assert_eq!(duration(125.0), "2 min 5 s");
    }
}
