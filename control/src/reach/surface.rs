//! The outer surface of a solid known along three families of lines.

use super::{
    columns::{Columns, Lattice, across},
    patch::Face,
};
use std::collections::HashMap;

/// A piece of the boundary, crossed by one edge of the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Its corners among the surface's points, counter-clockwise seen from outside.
    pub corners: [usize; 4],
    /// What holds the pressures where the edge crosses it.
    pub face: Face,
}

/// The boundary of a solid as a surface net: a point in every cell of the lattice that the boundary passes, at the mean of where it
/// crosses the cell's edges, and a facet around every edge that is crossed. Its departure falls with the square of the spacing where
/// the boundary is smooth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Points, m.
    pub points: Vec<[f64; 3]>,
    /// Facets.
    pub facets: Vec<Facet>,
}

impl Surface {
    /// Through the crossings of three families of columns.
    pub(super) fn of(columns: &[Columns; 3], lattice: &Lattice) -> Self {
        let count = lattice.count;
        let inside = inside(&columns[2], lattice);
        let number = |[i, j, k]: [usize; 3]| (i * count[1] + j) * count[2] + k;
        let mut sums: HashMap<usize, ([f64; 3], f64)> = HashMap::new();
        let mut crossed = vec![];
        for axis in 0..3 {
            let [u, v] = across(axis);
            let ends: [usize; 3] = std::array::from_fn(|other| count[other] - usize::from(other == axis));
            for i in 0..ends[0] {
                for j in 0..ends[1] {
                    for k in 0..ends[2] {
                        let at = [i, j, k];
                        let mut next = at;
                        next[axis] += 1;
                        let (here, there) = (inside[number(at)], inside[number(next)]);
                        if here == there {
                            continue;
                        }
                        let (place, face) = crossing(&columns[axis], lattice, at, here);
                        let mut point: [f64; 3] = std::array::from_fn(|axis| lattice.at(axis, at[axis]));
                        point[axis] = place;
                        // Cells around the edge, in the sense of u to v; the lattice has a layer outside, so that there are all four.
                        let around = [(1, 1), (0, 1), (0, 0), (1, 0)].map(|(back_u, back_v)| {
                            let mut cell = at;
                            cell[u] -= back_u;
                            cell[v] -= back_v;
                            number(cell)
                        });
                        for cell in around {
                            let (sum, weight) = sums.entry(cell).or_default();
                            sum.iter_mut().zip(point).for_each(|(sum, value)| *sum += value);
                            *weight += 1.0;
                        }
                        // Outwards is along the axis where the edge leaves the solid.
                        let [a, b, c, d] = around;
                        crossed.push((if here { [a, b, c, d] } else { [d, c, b, a] }, face));
                    }
                }
            }
        }
        let mut cells: Vec<usize> = sums.keys().copied().collect();
        cells.sort_unstable();
        let points = cells.iter().map(|cell| {
            let (sum, weight) = sums[cell];
            sum.map(|sum| sum / weight)
        });
        let points = points.collect();
        let place: HashMap<usize, usize> =
            cells.iter().enumerate().map(|(place, cell)| (*cell, place)).collect();
        let facets =
            crossed.into_iter().map(|(corners, face)| Facet { corners: corners.map(|c| place[&c]), face });
        Surface { points, facets: facets.collect() }
    }

    /// The two triangles of a facet.
    pub fn triangles(&self, facet: &Facet) -> [[[f64; 3]; 3]; 2] {
        let [a, b, c, d] = facet.corners.map(|corner| self.points[corner]);
        [[a, b, c], [a, c, d]]
    }

    /// Middle (m) and area (m^2) of a facet.
    pub fn middle_and_area(&self, facet: &Facet) -> ([f64; 3], f64) {
        let corners = facet.corners.map(|corner| self.points[corner]);
        let middle = std::array::from_fn(|axis| corners.iter().map(|at| at[axis]).sum::<f64>() / 4.0);
        let [p, q] = [(0, 2), (1, 3)].map(|(from, to): (usize, usize)| {
            nalgebra::Vector3::from(corners[to]) - nalgebra::Vector3::from(corners[from])
        });
        (middle, 0.5 * p.cross(&q).norm())
    }

    /// Volume that the surface encloses, m^3.
    pub fn volume(&self) -> f64 {
        let triangles = self.facets.iter().flat_map(|facet| self.triangles(facet));
        triangles
            .map(|triangle| {
                let [a, b, c] = triangle.map(nalgebra::Vector3::from);
                a.cross(&b).dot(&c) / 6.0
            })
            .sum()
    }
}

/// Which points of the lattice lie inside, by columns along z.
pub(super) fn inside(columns: &Columns, lattice: &Lattice) -> Vec<bool> {
    let [nx, ny, nz] = lattice.count;
    let mut inside = vec![false; nx * ny * nz];
    for i in 0..nx {
        for j in 0..ny {
            let line = columns.line([i, j]);
            for k in 0..nz {
                let z = lattice.at(2, k);
                inside[(i * ny + j) * nz + k] = line.iter().any(|piece| piece.low <= z && z <= piece.high);
            }
        }
    }
    inside
}

/// Where the edge from a lattice point along the columns' axis crosses the boundary, and what holds the pressures there. Should the
/// columns differ by rounding, the middle of the edge.
fn crossing(columns: &Columns, lattice: &Lattice, at: [usize; 3], leaves: bool) -> (f64, Face) {
    let axis = columns.axis;
    let [u, v] = across(axis);
    let (low, high) = (lattice.at(axis, at[axis]), lattice.at(axis, at[axis] + 1));
    let mut ends = columns.line([at[u], at[v]]).iter().map(|piece| match leaves {
        true => (piece.high, piece.faces[1]),
        false => (piece.low, piece.faces[0]),
    });
    ends.find(|(end, _)| low <= *end && *end <= high).unwrap_or((0.5 * (low + high), Face::NONE))
}
