//! VTK's XML files for unstructured grids (`.vtu`) and collections of them (`.pvd`), arrays inline in base64.

use std::io::{self, Write};

/// VTK's type number of a single point.
pub const VERTEX: u8 = 1;
/// VTK's type number of a line of two points.
pub const LINE: u8 = 3;
/// VTK's type number of a quadrangle.
pub const QUADRANGLE: u8 = 9;
/// VTK's type number of a hexahedron of 27 points.
pub const TRIQUADRATIC_HEXAHEDRON: u8 = 29;

/// Values of an array, in the precision in which they are written.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers of eight bytes; NaN and infinity are read as such.
    F64(Vec<f64>),
    /// Numbers of four bytes.
    F32(Vec<f32>),
    /// Integers.
    I64(Vec<i64>),
    /// Small integers that are not negative.
    U8(Vec<u8>),
}

/// A named array, `components` values for each point or cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Its name, with the unit.
    pub name: String,
    /// Values a point or cell.
    pub components: usize,
    /// All of them, those of a point or cell beside each other.
    pub values: Values,
}

impl Array {
    /// Of a name, values a point or cell, and all values.
    pub fn new(name: &str, components: usize, values: Values) -> Self {
        Array { name: name.to_owned(), components, values }
    }
}

/// Points and cells of one type with what is known at them.
#[derive(Clone, Debug, PartialEq)]
pub struct UnstructuredGrid {
    /// Points, in the unit in which they shall be shown.
    pub points: Vec<[f64; 3]>,
    /// VTK's number of the cells' type, as [`QUADRANGLE`].
    pub cell_type: u8,
    /// Points of a cell.
    pub nodes_per_cell: usize,
    /// Points of the cells, one cell after another, in VTK's order.
    pub connectivity: Vec<i64>,
    /// At the points.
    pub point_data: Vec<Array>,
    /// Of the cells.
    pub cell_data: Vec<Array>,
    /// Of the file as a whole.
    pub field_data: Vec<Array>,
}

const BASE64: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Base64 of RFC 4648, with padding.
fn base64(bytes: &[u8]) -> Vec<u8> {
    let mut text = Vec::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        text.extend(
            (0..4).map(|i| if i > group.len() { b'=' } else { BASE64[(bits >> (18 - 6 * i)) as usize & 63] }),
        );
    }
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// `attributes` beside type, name and format.
fn write_array(out: &mut dyn Write, name: &str, attributes: &str, values: &Values) -> io::Result<()> {
    let (kind, data): (_, Vec<u8>) = match values {
        Values::F64(values) => ("Float64", values.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Values::F32(values) => ("Float32", values.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Values::I64(values) => ("Int64", values.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Values::U8(values) => ("UInt8", values.clone()),
    };
    // The number of bytes goes before them, in one stream.
    let mut bytes = (data.len() as u64).to_le_bytes().to_vec();
    bytes.extend(data);
    write!(out, "<DataArray type=\"{kind}\" Name=\"{}\"{attributes} format=\"binary\">", escaped(name))?;
    out.write_all(&base64(&bytes))?;
    writeln!(out, "</DataArray>")
}

/// Nothing for scalars: meshio would make a matrix of one column of them.
fn shape(components: usize) -> String {
    if components == 1 { String::new() } else { format!(" NumberOfComponents=\"{components}\"") }
}

fn write_arrays(out: &mut dyn Write, element: &str, arrays: &[Array]) -> io::Result<()> {
    writeln!(out, "<{element}>")?;
    for Array { name, components, values } in arrays {
        write_array(out, name, &shape(*components), values)?;
    }
    writeln!(out, "</{element}>")
}

impl Values {
    /// Puts others behind these.
    fn append(&mut self, other: Values) -> bool {
        match (self, other) {
            (Values::F64(own), Values::F64(other)) => own.extend(other),
            (Values::F32(own), Values::F32(other)) => own.extend(other),
            (Values::I64(own), Values::I64(other)) => own.extend(other),
            (Values::U8(own), Values::U8(other)) => own.extend(other),
            _ => return false,
        }
        true
    }
}

impl UnstructuredGrid {
    /// Puts another grid of the same cells and arrays beside this one; arrays of the file as a whole stay as they are.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] where cells or arrays are not the same.
    pub fn append(&mut self, other: UnstructuredGrid) -> io::Result<()> {
        let unlike = || io::Error::new(io::ErrorKind::InvalidInput, "grids of unlike cells or arrays");
        let names = |grid: &UnstructuredGrid| -> Vec<(String, usize)> {
            let arrays = grid.point_data.iter().chain(&grid.cell_data);
            arrays.map(|array| (array.name.clone(), array.components)).collect()
        };
        if self.cell_type != other.cell_type || names(self) != names(&other) {
            return Err(unlike());
        }
        let first = self.points.len() as i64;
        self.points.extend(other.points);
        self.connectivity.extend(other.connectivity.into_iter().map(|point| point + first));
        let own = self.point_data.iter_mut().chain(&mut self.cell_data);
        for (own, other) in own.zip(other.point_data.into_iter().chain(other.cell_data)) {
            if !own.values.append(other.values) {
                return Err(unlike());
            }
        }
        Ok(())
    }

    /// Writes the grid as a `.vtu` file.
    ///
    /// # Errors
    /// What `out` answers.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let cells = self.connectivity.len() / self.nodes_per_cell;
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(
            out,
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
        )?;
        writeln!(out, "<UnstructuredGrid>\n<FieldData>")?;
        for Array { name, components, values } in &self.field_data {
            write_array(out, name, &format!(" NumberOfTuples=\"1\"{}", shape(*components)), values)?;
        }
        writeln!(out, "</FieldData>")?;
        writeln!(out, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">", self.points.len())?;
        let points = Array::new("points", 3, Values::F64(self.points.as_flattened().to_vec()));
        write_arrays(out, "Points", &[points])?;
        writeln!(out, "<Cells>")?;
        let offsets = (1..=cells).map(|cell| (cell * self.nodes_per_cell) as i64).collect();
        write_array(out, "connectivity", "", &Values::I64(self.connectivity.clone()))?;
        write_array(out, "offsets", "", &Values::I64(offsets))?;
        write_array(out, "types", "", &Values::U8(vec![self.cell_type; cells]))?;
        writeln!(out, "</Cells>")?;
        write_arrays(out, "PointData", &self.point_data)?;
        write_arrays(out, "CellData", &self.cell_data)?;
        writeln!(out, "</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    }
}

/// Writes a `.pvd` collection: what a viewer opens to step through the states of a path.
///
/// Each frame is a time and the files to be shown at it, relative to the collection's own folder. On a path that rises the time is
/// the pressure in kPa; beyond a limit point, where pressures come twice, take the number of the state.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`] if a time is not greater than the one before: a viewer would show both states as one. Else what
/// `out` answers.
///
/// ```
/// let frames = [(0.0, vec!["rest.vtu"]), (60.0, vec!["60.vtu", "60-fibres.vtu"])];
/// let mut text = vec![];
/// fe::vtk::write_pvd(&frames, &mut text).unwrap();
/// assert_eq!(String::from_utf8(text).unwrap().matches("<DataSet").count(), 3);
/// ```
pub fn write_pvd<S: AsRef<str>>(frames: &[(f64, Vec<S>)], out: &mut dyn Write) -> io::Result<()> {
    for pair in frames.windows(2) {
        let (before, after) = (pair[0].0, pair[1].0);
        if before.partial_cmp(&after) != Some(std::cmp::Ordering::Less) {
            let message = format!("the times of a collection must rise, but {after} follows {before}");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
    }
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(out, "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>")?;
    for (time, files) in frames {
        for (part, file) in files.iter().enumerate() {
            let file = escaped(file.as_ref());
            writeln!(out, "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>")?;
        }
    }
    writeln!(out, "</Collection>\n</VTKFile>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_rfc_4648() {
        let cases = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, coded) in cases {
            assert_eq!(base64(plain.as_bytes()), coded.as_bytes(), "{plain}");
        }
        assert_eq!(base64(&[0xff, 0xfb, 0xff]), b"//v/");
    }

    #[test]
    fn names_cannot_break_the_file() {
        let grid = UnstructuredGrid {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0]],
            cell_type: LINE,
            nodes_per_cell: 2,
            connectivity: vec![0, 1],
            point_data: vec![Array::new("a<b & \"c\"", 1, Values::F32(vec![1.0, 2.0]))],
            cell_data: vec![],
            field_data: vec![],
        };
        let mut text = vec![];
        grid.write(&mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert!(text.contains("Name=\"a&lt;b &amp; &quot;c&quot;\" format"), "{text}");
        // 8 bytes follow: the number of bytes and 1.0f32, 2.0f32.
        assert!(text.contains(">CAAAAAAAAAAAAIA/AAAAQA==<"), "{text}");
    }

    #[test]
    fn grids_beside_each_other_keep_their_cells_and_arrays() {
        let line = |x: f64, values| UnstructuredGrid {
            points: vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0]],
            cell_type: LINE,
            nodes_per_cell: 2,
            connectivity: vec![0, 1],
            point_data: vec![Array::new("a", 1, values)],
            cell_data: vec![Array::new("n", 1, Values::I64(vec![x as i64]))],
            field_data: vec![],
        };
        let mut both = line(0.0, Values::F64(vec![1.0, 2.0]));
        both.append(line(5.0, Values::F64(vec![3.0, 4.0]))).unwrap();
        assert_eq!(both.connectivity, [0, 1, 2, 3]);
        assert_eq!(both.points[3], [6.0, 0.0, 0.0]);
        assert_eq!(both.point_data[0].values, Values::F64(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(both.cell_data[0].values, Values::I64(vec![0, 5]));
        assert!(both.append(line(5.0, Values::F32(vec![3.0, 4.0]))).is_err());
        let unlike = UnstructuredGrid { point_data: vec![], ..line(5.0, Values::U8(vec![])) };
        assert!(both.append(unlike).is_err());
    }

    #[test]
    fn a_collection_refuses_times_that_do_not_rise() {
        for times in [[1.0, 1.0], [2.0, 1.0], [0.0, f64::NAN]] {
            let frames = times.map(|time| (time, vec!["a.vtu"]));
            let error = write_pvd(&frames, &mut vec![]).unwrap_err();
            assert!(error.to_string().contains("must rise"), "{error}");
        }
    }
}
