//! Outlines of a solid in a plane: of its shadow, and of a cut through it.

use super::{
    ReachableSet,
    columns::{Columns, Piece, across},
};

/// Pieces of straight line in the plane, m.
pub type Segments = Vec<[[f64; 2]; 2]>;

/// Intervals along the lines of one direction of a plane.
type Lines = Vec<Vec<(f64, f64)>>;

fn union(pieces: impl Iterator<Item = Piece>) -> Vec<(f64, f64)> {
    let mut all: Vec<(f64, f64)> = pieces.map(|piece| (piece.low, piece.high)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut joined: Vec<(f64, f64)> = vec![];
    for (low, high) in all {
        match joined.last_mut() {
            Some(last) if low <= last.1 => last.1 = last.1.max(high),
            _ => joined.push((low, high)),
        }
    }
    joined
}

impl ReachableSet {
    /// Outline of the shadow along an axis (0 to 2), in the coordinates of the two others in their cyclic order.
    pub fn shadow(&self, axis: usize) -> Segments {
        self.outline(axis, None)
    }

    /// Outline of the cut across an axis at the place of the lattice next to `at` (m), and that place.
    pub fn cut(&self, axis: usize, at: f64) -> (f64, Segments) {
        let lattice = &self.lattice;
        let off = |index: &usize| (lattice.at(axis, *index) - at).abs();
        let index = (0..lattice.count[axis]).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        (lattice.at(axis, index), self.outline(axis, Some(index)))
    }

    fn outline(&self, axis: usize, at: Option<usize>) -> Segments {
        let Some(columns) = &self.columns else { return vec![] };
        let [u, v] = across(axis);
        // Lines along v at each u, and along u at each v: in the plane, or all behind it together.
        let lines = |columns: &Columns, fixed: usize| -> Lines {
            let order = across(columns.axis);
            let place = |place: usize, depth: usize| order.map(|of| if of == fixed { place } else { depth });
            let depths = || at.map_or(0..self.lattice.count[axis], |at| at..at + 1);
            (0..self.lattice.count[fixed])
                .map(|index| {
                    union(depths().flat_map(|depth| columns.line(place(index, depth)).iter().copied()))
                })
                .collect()
        };
        let (along_v, along_u) = (lines(&columns[v], u), lines(&columns[u], v));
        let lattice = &self.lattice;
        let inside = |i: usize, j: usize| {
            let place = lattice.at(v, j);
            along_v[i].iter().any(|(low, high)| *low <= place && place <= *high)
        };
        // A point in every cell that is passed, at the mean of the crossings of its edges; neighbours across a crossed edge joined.
        let crossing = |line: &[(f64, f64)], low: f64, high: f64, leaves: bool| {
            let mut ends = line.iter().map(|piece| if leaves { piece.1 } else { piece.0 });
            ends.find(|end| low <= *end && *end <= high).unwrap_or(0.5 * (low + high))
        };
        let (nu, nv) = (lattice.count[u], lattice.count[v]);
        let mut points = vec![([0.0; 2], 0.0); nu * nv];
        let mut joined = vec![];
        for (i, up) in along_v.iter().enumerate() {
            for (j, beside) in along_u.iter().enumerate() {
                let here = inside(i, j);
                let mut cross = |point: [f64; 2], cells: [usize; 2]| {
                    for cell in cells {
                        points[cell].0[0] += point[0];
                        points[cell].0[1] += point[1];
                        points[cell].1 += 1.0;
                    }
                    joined.push(cells);
                };
                if i > 0 && j + 1 < nv && here != inside(i, j + 1) {
                    let (low, high) = (lattice.at(v, j), lattice.at(v, j + 1));
                    let place = crossing(up, low, high, here);
                    cross([lattice.at(u, i), place], [(i - 1) * nv + j, i * nv + j]);
                }
                if j > 0 && i + 1 < nu && here != inside(i + 1, j) {
                    let (low, high) = (lattice.at(u, i), lattice.at(u, i + 1));
                    let place = crossing(beside, low, high, here);
                    cross([place, lattice.at(v, j)], [i * nv + j - 1, i * nv + j]);
                }
            }
        }
        let mean = |cell: usize| points[cell].0.map(|sum| sum / points[cell].1);
        joined.into_iter().map(|cells| cells.map(mean)).collect()
    }
}
