//! Fibres on the tube's outer surface: helices that the surface carries along.

mod crossing;
mod surface;
#[cfg(test)]
mod tests;
mod trace;
mod truss;

use super::{SolidError, Specimen, mesh::Grid};
use actuator::Winding;
pub(crate) use crossing::Crossing;
use nalgebra::UnitQuaternion;
use std::{collections::BTreeMap, f64::consts::TAU};
use trace::{Around, Strand, trace};
pub(crate) use truss::Truss;
use truss::TrussPiece;

/// Three unknowns of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Block {
    /// Position of a point of the mesh, m.
    Point(u32),
}

/// A place on a fibre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FibreState {
    /// Number of the fibre: families after one another.
    pub fibre: u32,
    /// Reference arc length from the base, m; of the fibre's middle line, whichever strand the place is on.
    pub arc_length: f64,
    /// m.
    pub position: [f64; 3],
    /// Length over reference length.
    pub stretch: f64,
    /// EA (stretch - 1), N; of the whole fibre, whatever the strand's share.
    pub tension: f64,
    /// Reference length that the place stands for, times its strand's share of the fibre, m.
    pub weight: f64,
}

/// A dense contribution of fibres to the energy.
#[derive(Clone, Debug)]
pub(crate) enum FibreElement {
    /// Stretches along lines of the mesh.
    Truss(Truss),
    /// Stretches across the mesh.
    Crossing(Crossing),
}

impl FibreElement {
    /// What its unknowns are, three each.
    pub fn blocks(&self) -> &[Block] {
        match self {
            FibreElement::Truss(truss) => truss.blocks(),
            FibreElement::Crossing(crossing) => crossing.blocks(),
        }
    }

    /// Energy (J) at the positions (m) of all points and the rotations of all nodes that have one, as for
    /// [`FibreElement::evaluate`].
    pub fn energy(&self, positions: &[[f64; 3]], _rotations: &[UnitQuaternion<f64>]) -> Option<f64> {
        match self {
            FibreElement::Truss(truss) => truss.energy(positions),
            FibreElement::Crossing(crossing) => crossing.energy(positions),
        }
    }

    /// Energy (J) with its first and second derivatives by the unknowns of [`FibreElement::blocks`], n = 3 times their number:
    /// the first n places of `gradient` and the first n^2 of `tangent` (columns one after another, both triangles) are set.
    /// `None` where a fibre has shrunk to a point.
    pub fn evaluate(
        &self,
        positions: &[[f64; 3]],
        _rotations: &[UnitQuaternion<f64>],
        gradient: &mut [f64],
        tangent: &mut [f64],
    ) -> Option<f64> {
        match self {
            FibreElement::Truss(truss) => truss.evaluate(positions, gradient, tangent),
            FibreElement::Crossing(crossing) => crossing.evaluate(positions, gradient, tangent),
        }
    }

    /// Stretch and tension at its integration points.
    pub fn states(&self, positions: &[[f64; 3]], _rotations: &[UnitQuaternion<f64>]) -> Vec<FibreState> {
        match self {
            FibreElement::Truss(truss) => truss.states(positions).collect(),
            FibreElement::Crossing(crossing) => crossing.states(positions).collect(),
        }
    }
}

/// Largest number of unknowns of an element of fibres.
pub(crate) const MAX_UNKNOWNS: usize = 27;

/// All fibres of a specimen, or of one of its sectors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fibres {
    /// Contributions to the energy.
    pub elements: Vec<FibreElement>,
}

/// Gauss's rule of two points across an interval of a fibre's width: of the surface's two new lines of points per element, as
/// along the fibre.
const ACROSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// The winding's fibre `index` as lines in the grid: one in its middle, or several over the width that it covers, d/sin(angle)
/// along the hoop.
fn strands(grid: &Grid, winding: &Winding, outer_radius: f64, index: usize) -> Vec<Strand> {
    let middle = middle_line(grid, winding, outer_radius, index);
    let half = 0.5 * winding.fibre.diameter / (winding.angle_from_hoop().sin() * outer_radius);
    // Wider than its pitch it covers the tube, no more.
    let half = half.min(0.5 * TAU / f64::from(winding.fibres));
    if half == 0.0 {
        return vec![middle];
    }
    let around = Around::new(grid);
    let (from, to) = (middle.start - half, middle.start + half);
    let mut borders = vec![from];
    if middle.slope == 0.0 {
        borders.extend(around.edges_between(from, to));
        if !borders.iter().any(|edge| (edge - middle.start).abs() < 1e-9 * half) {
            borders.push(middle.start);
        }
        borders.sort_by(f64::total_cmp);
    } else {
        // It crosses the cells: no wider than one on average.
        let parts = 2 * (half * around.cells() as f64 / around.period).ceil() as usize;
        borders.extend((1..parts).map(|i| from + (to - from) * i as f64 / parts as f64));
    }
    borders.push(to);
    let between = |pair: &[f64]| {
        let (start, width) = (pair[0], pair[1] - pair[0]);
        let share = 0.5 * width / (to - from);
        ACROSS.map(|place| Strand { start: start + width * place, slope: middle.slope, share })
    };
    borders.windows(2).flat_map(between).collect()
}

fn middle_line(grid: &Grid, winding: &Winding, outer_radius: f64, index: usize) -> Strand {
    let turn = winding.handedness.sign() * winding.turn_per_length(outer_radius);
    // An angle of 90 degrees leaves a rounding error of a turn, which must not cross a line of the mesh.
    let slope = if (turn - grid.turn).abs() * outer_radius < 1e-12 { 0.0 } else { turn - grid.turn };
    Strand { start: TAU * index as f64 / f64::from(winding.fibres), slope, share: 1.0 }
}

/// How many of a winding's fibres begin in each sector.
fn fibres_in_sector(grid: &Grid, winding: &Winding) -> Result<usize, SolidError> {
    let fibres = winding.fibres as usize;
    if fibres == 0 || !fibres.is_multiple_of(grid.sectors) {
        return Err(SolidError::Invalid {
            field: "the number of fibres of a family",
            value: fibres as f64,
            requirement: "it must be positive and a multiple of the number of sectors: mesh the whole tube",
        });
    }
    let diameter = winding.fibre.diameter;
    if !(diameter >= 0.0 && diameter.is_finite()) {
        return Err(SolidError::Invalid {
            field: "the fibres' diameter (m)",
            value: diameter,
            requirement: "it must be zero (a line) or positive",
        });
    }
    Ok(fibres / grid.sectors)
}

impl Fibres {
    /// All fibres as trusses; none for a bare tube.
    ///
    /// # Errors
    /// [`SolidError::Invalid`] if a family does not divide into the grid's sectors.
    pub fn trusses(specimen: &Specimen, grid: &Grid) -> Result<Self, SolidError> {
        let outer = specimen.tube.outer_radius();
        let layer = 2 * grid.through_tube;
        let mut elements = vec![];
        let mut first_fibre = 0;
        for winding in &specimen.windings {
            let crosses = middle_line(grid, winding, outer, 0).slope != 0.0;
            let mut cells: BTreeMap<[usize; 2], Vec<TrussPiece>> = BTreeMap::new();
            for index in 0..fibres_in_sector(grid, winding)? {
                for strand in strands(grid, winding, outer, index) {
                    let mut arc_length = 0.0;
                    for piece in trace(grid, specimen.tube.length, strand) {
                        let [j, k] = piece.cell;
                        let fibre = (first_fibre + index) as u32;
                        let traced = TrussPiece { piece, share: strand.share, fibre, arc_length };
                        arc_length += truss::length(&piece, &grid.face_points(layer, [j, k]), &grid.points);
                        cells.entry([k, j]).or_default().push(traced);
                    }
                }
            }
            first_fibre += winding.fibres as usize;
            elements.extend(cells.iter().map(|([k, j], pieces)| {
                let face = grid.face_points(layer, [*j, *k]);
                if crosses {
                    FibreElement::Crossing(Crossing::new(pieces, &winding.fibre, &face, &grid.points))
                } else {
                    FibreElement::Truss(Truss::new(pieces, &winding.fibre, &face, &grid.points))
                }
            }));
        }
        Ok(Fibres { elements })
    }
}
