//! A solid as what it covers of parallel lines.

use super::patch::Face;

/// Gaps shorter than this (m) are rounding between neighbouring simplices.
const GAP: f64 = 1e-9;
/// Ends are rounded to this (m), so that simplices that share an end agree on it, whatever their order.
const GRAIN: f64 = 1e-10;
/// How far outside a triangle, in barycentric coordinates, a line still meets it: neighbours leave no slit.
const RIM: f64 = 1e-9;

/// A piece of a line that the set covers, and what the pressures at its ends are held by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub low: f64,
    pub high: f64,
    pub faces: [Face; 2],
}

/// An even lattice of points: multiples of the spacing along each axis, a half off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    pub spacing: [f64; 3],
    pub first: [i64; 3],
    pub count: [usize; 3],
}

impl Lattice {
    /// Around a box, with a layer of points outside it on all sides.
    pub fn around(extent: [(f64, f64); 3], spacing: [f64; 3]) -> Self {
        let first: [i64; 3] =
            std::array::from_fn(|axis| (extent[axis].0 / spacing[axis] - 0.5).ceil() as i64 - 1);
        let last: [i64; 3] =
            std::array::from_fn(|axis| (extent[axis].1 / spacing[axis] - 0.5).floor() as i64 + 1);
        let count = std::array::from_fn(|axis| (last[axis] - first[axis]).max(0) as usize + 1);
        Lattice { spacing, first, count }
    }

    pub fn at(&self, axis: usize, index: usize) -> f64 {
        ((self.first[axis] + index as i64) as f64 + 0.5) * self.spacing[axis]
    }

    /// Indices of the points between two places on an axis.
    fn between(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let place = |value: f64| value / self.spacing[axis] - 0.5 - self.first[axis] as f64;
        let (from, to) = (place(low).ceil().max(0.0), place(high).floor() + 1.0);
        from as usize..(to.max(0.0) as usize).min(self.count[axis])
    }
}

/// What a solid covers of the lines through a lattice along one axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Columns {
    pub axis: usize,
    lattice: Lattice,
    /// Pieces of each line, rising and apart.
    lines: Vec<Vec<Piece>>,
}

impl Columns {
    pub fn new(axis: usize, lattice: Lattice) -> Self {
        let [u, v] = across(axis);
        Columns { axis, lattice, lines: vec![vec![]; lattice.count[u] * lattice.count[v]] }
    }

    /// Pieces of the line at a place on the two other axes, in their cyclic order.
    pub fn line(&self, at: [usize; 2]) -> &[Piece] {
        &self.lines[at[0] * self.lattice.count[across(self.axis)[1]] + at[1]]
    }

    /// Volume: lengths times the area of a line.
    pub fn volume(&self) -> f64 {
        let lengths = self.lines.iter().flatten().map(|piece| piece.high - piece.low);
        across(self.axis).into_iter().fold(lengths.sum::<f64>(), |sum, axis| sum * self.lattice.spacing[axis])
    }

    /// Adds a tetrahedron.
    pub fn add(&mut self, nodes: [&([f64; 3], Face); 4]) {
        let [u, v] = across(self.axis);
        let w = self.axis;
        let span = |axis: usize| {
            nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (at, _)| {
                (low.min(at[axis]), high.max(at[axis]))
            })
        };
        let ((u_low, u_high), (v_low, v_high), (low, high)) = (span(u), span(v), span(w));
        // Rounding keeps the order, so that no piece ends beyond these.
        let rounded = [rounded(low), rounded(high)];
        let (columns, rows) =
            (self.lattice.between(u, u_low, u_high), self.lattice.between(v, v_low, v_high));
        for i in columns {
            for j in rows.clone() {
                let line = &mut self.lines[i * self.lattice.count[v] + j];
                if line.iter().any(|piece| piece.low < rounded[0] && rounded[1] < piece.high) {
                    continue;
                }
                let at = [self.lattice.at(u, i), self.lattice.at(v, j)];
                if let Some(piece) = covered(nodes, [u, v, w], at) {
                    let [low, high] = [piece.low, piece.high].map(|end| self::rounded(end.clamp(low, high)));
                    insert(line, Piece { low, high, ..piece });
                }
            }
        }
    }

    /// Adds what other columns of the same lattice cover.
    pub fn join(&mut self, other: &Columns) {
        for (line, others) in self.lines.iter_mut().zip(&other.lines) {
            others.iter().for_each(|piece| insert(line, *piece));
        }
    }

    /// Leaves out pieces without length: lines that touch a corner.
    pub fn finish(&mut self) {
        self.lines.iter_mut().for_each(|line| line.retain(|piece| piece.high - piece.low > GAP));
    }
}

/// The two other axes, in cyclic order.
pub(super) fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

fn rounded(place: f64) -> f64 {
    // Adding zero makes one zero of two.
    (place / GRAIN).round() * GRAIN + 0.0
}

/// What a tetrahedron covers of the line along axis w.
fn covered(nodes: [&([f64; 3], Face); 4], [u, v, w]: [usize; 3], at: [f64; 2]) -> Option<Piece> {
    let mut piece: Option<Piece> = None;
    for left_out in 0..4 {
        let [a, b, c] = [1, 2, 3].map(|step| nodes[(left_out + step) % 4]);
        let side =
            |p: &[f64; 3], q: &[f64; 3]| (p[u] - at[0]) * (q[v] - at[1]) - (q[u] - at[0]) * (p[v] - at[1]);
        let parts = [side(&b.0, &c.0), side(&c.0, &a.0), side(&a.0, &b.0)];
        let area = parts[0] + parts[1] + parts[2];
        // Seen from its edge it has neighbours that are not.
        if area.abs() < 1e-18 {
            continue;
        }
        let parts = parts.map(|part| part / area);
        if parts.iter().any(|part| *part < -RIM) {
            continue;
        }
        let place = parts[0] * a.0[w] + parts[1] * b.0[w] + parts[2] * c.0[w];
        let face = a.1.both(b.1).both(c.1);
        let hit = Piece { low: place, high: place, faces: [face; 2] };
        piece = Some(piece.map_or(hit, |piece| hull(piece, hit)));
    }
    piece
}

/// The piece from the lower of two ends to the higher; at equal ends the face that holds more, so that the order does not matter.
fn hull(a: Piece, b: Piece) -> Piece {
    let rank = |face: Face| (face.0.count_ones(), face.0);
    let more = |a: Face, b: Face| if rank(a) >= rank(b) { a } else { b };
    let (low, first) = match a.low.total_cmp(&b.low) {
        std::cmp::Ordering::Less => (a.low, a.faces[0]),
        std::cmp::Ordering::Greater => (b.low, b.faces[0]),
        std::cmp::Ordering::Equal => (a.low, more(a.faces[0], b.faces[0])),
    };
    let (high, last) = match a.high.total_cmp(&b.high) {
        std::cmp::Ordering::Greater => (a.high, a.faces[1]),
        std::cmp::Ordering::Less => (b.high, b.faces[1]),
        std::cmp::Ordering::Equal => (a.high, more(a.faces[1], b.faces[1])),
    };
    Piece { low, high, faces: [first, last] }
}

/// Joins a piece with all that it touches. Pieces are what hangs together with no gap above [`GAP`], in whatever order they came.
fn insert(line: &mut Vec<Piece>, mut piece: Piece) {
    let first = line.iter().position(|other| other.high >= piece.low - GAP).unwrap_or(line.len());
    let mut last = first;
    while last < line.len() && line[last].low <= piece.high + GAP {
        piece = hull(piece, line[last]);
        last += 1;
    }
    line.splice(first..last, std::iter::once(piece));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(low: f64, high: f64) -> Piece {
        Piece { low, high, faces: [Face::NONE; 2] }
    }

    #[test]
    fn pieces_join_whatever_their_order() {
        let pieces = [piece(0.0, 1.0), piece(2.0, 3.0), piece(0.9, 2.1), piece(5.0, 6.0), piece(6.0, 6.5)];
        for turn in 0..pieces.len() {
            let mut line = vec![];
            (0..pieces.len()).for_each(|i| insert(&mut line, pieces[(i * 2 + turn) % pieces.len()]));
            let ends: Vec<(f64, f64)> = line.iter().map(|piece| (piece.low, piece.high)).collect();
            assert_eq!(ends, [(0.0, 3.0), (5.0, 6.5)]);
        }
    }

    #[test]
    fn a_tetrahedron_s_volume_comes_out_along_every_axis() {
        let corner = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 0.9, 0.1], [0.1, 0.2, 0.8]];
        let edge = |i: usize| nalgebra::Vector3::from(corner[i]);
        let exact = edge(1).cross(&edge(2)).dot(&edge(3)) / 6.0;
        let lattice = Lattice::around([(0.0, 1.0); 3], [0.01, 0.011, 0.009]);
        for axis in 0..3 {
            let mut columns = Columns::new(axis, lattice);
            let nodes = corner.map(|at| (at, Face::NONE));
            columns.add([&nodes[0], &nodes[1], &nodes[2], &nodes[3]]);
            // Lengths of a line's piece are linear: what is left is the rim, a line's area each.
            assert!((columns.volume() / exact - 1.0).abs() < 2e-3, "{axis}: {} {exact}", columns.volume());
        }
    }
}
