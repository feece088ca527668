//! Points, triangles and quadrangles with numbers for viewers (VTK's XML, numbers as text).

use std::fmt::Write;

/// Numbers at each point or cell under a name with its unit.
pub struct Numbers<'a> {
    /// Name.
    pub name: &'a str,
    /// One a point or cell; not finite ones are written as NaN.
    pub values: Vec<f64>,
}

/// An unstructured grid of cells of one kind.
pub struct Cells<'a> {
    /// Points in the unit in which they shall be shown.
    pub points: Vec<[f64; 3]>,
    /// Points of each cell: one for a vertex, four for a quadrangle.
    pub cells: Vec<Vec<usize>>,
    /// What is known at the points.
    pub at_points: Vec<Numbers<'a>>,
    /// What is known of the cells.
    pub of_cells: Vec<Numbers<'a>>,
}

fn data(text: &mut String, kind: &str, name: &str, components: usize, values: impl Iterator<Item = f64>) {
    let words: Vec<String> =
        values.map(|value| if value.is_finite() { value.to_string() } else { "nan".into() }).collect();
    let _ = writeln!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">\n{}\n</DataArray>",
        words.join(" ")
    );
}

impl Cells<'_> {
    /// The file.
    pub fn text(&self) -> String {
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
             <UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n",
            self.points.len(),
            self.cells.len()
        );
        data(&mut text, "Float64", "position_mm", 3, self.points.iter().flatten().copied());
        text += "</Points>\n<Cells>\n";
        let index = |index: usize| index as f64;
        data(&mut text, "Int64", "connectivity", 1, self.cells.iter().flatten().copied().map(index));
        let mut end = 0;
        let ends = self.cells.iter().map(|cell| {
            end += cell.len();
            index(end)
        });
        data(&mut text, "Int64", "offsets", 1, ends);
        // VTK's numbers of a vertex, a triangle and a quadrangle.
        let kinds = self.cells.iter().map(|cell| match cell.len() {
            1 => 1.0,
            3 => 5.0,
            _ => 9.0,
        });
        data(&mut text, "UInt8", "types", 1, kinds);
        text += "</Cells>\n<PointData>\n";
        for numbers in &self.at_points {
            data(&mut text, "Float64", numbers.name, 1, numbers.values.iter().copied());
        }
        text += "</PointData>\n<CellData>\n";
        for numbers in &self.of_cells {
            data(&mut text, "Float64", numbers.name, 1, numbers.values.iter().copied());
        }
        text + "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_names_what_it_holds() {
        let grid = Cells {
            points: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]],
            cells: vec![vec![0, 1, 2, 3]],
            at_points: vec![Numbers { name: "a", values: vec![1.0, 2.0, f64::INFINITY, 4.0] }],
            of_cells: vec![Numbers { name: "b", values: vec![7.5] }],
        };
        let text = grid.text();
        for words in [
            "NumberOfPoints=\"4\" NumberOfCells=\"1\"",
            "0 0 0 1 0 0 1 1 0 0 1 0.5",
            "Name=\"offsets\" NumberOfComponents=\"1\" format=\"ascii\">\n4\n",
            "Name=\"types\" NumberOfComponents=\"1\" format=\"ascii\">\n9\n",
            "\n1 2 nan 4\n",
            "\n7.5\n",
        ] {
            assert!(text.contains(words), "{words} is not in\n{text}");
        }
    }
}
