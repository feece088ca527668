//! Fibres on the tube's outer surface: helices that the surface carries along.

mod beam;
mod crossing;
mod foreseen;
mod surface;
#[cfg(test)]
mod tests;
mod trace;
mod truss;

use super::{SolidError, Specimen, mesh::Grid};
use actuator::Winding;
pub(crate) use beam::Beam;
use beam::BeamPlace;
pub(crate) use crossing::Crossing;
pub(crate) use foreseen::ForeseenTensions;
use nalgebra::{UnitQuaternion, Vector3, Vector6};
use std::{collections::BTreeMap, f64::consts::TAU};
use surface::SurfacePoint;
use trace::{Around, Piece, Strand, trace};
pub(crate) use truss::Truss;
use truss::TrussPiece;

/// Three unknowns of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Block {
    /// Position of a point of the mesh, m.
    Point(u32),
    /// Rotation R of a node of a beam: w (rad) in the node's own frame makes it R exp(w), see [`Fibres::moved`].
    Rotation(u32),
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
    Crossing(Box<Crossing>),
    /// Bends and twists.
    Beam(Box<Beam>),
}

impl FibreElement {
    /// What its unknowns are, three each.
    pub fn blocks(&self) -> &[Block] {
        match self {
            FibreElement::Truss(truss) => truss.blocks(),
            FibreElement::Crossing(crossing) => crossing.blocks(),
            FibreElement::Beam(beam) => beam.blocks(),
        }
    }

    #[cfg(test)]
    /// Energy (J) at the positions (m) of all points and the rotations of all nodes that have one, as for
    /// [`FibreElement::evaluate`].
    pub fn energy(&self, positions: &[[f64; 3]], rotations: &[UnitQuaternion<f64>]) -> Option<f64> {
        match self {
            FibreElement::Truss(truss) => truss.energy(positions),
            FibreElement::Crossing(crossing) => crossing.energy(positions),
            FibreElement::Beam(beam) => beam.energy(positions, rotations),
        }
    }

    /// Energy (J) with its first and second derivatives by the unknowns of [`FibreElement::blocks`], n = 3 times their number:
    /// the first n places of `gradient` and the first n^2 of `tangent` (columns one after another, both triangles) are set.
    /// `None` where a fibre has shrunk to a point.
    pub fn evaluate(
        &self,
        positions: &[[f64; 3]],
        rotations: &[UnitQuaternion<f64>],
        gradient: &mut [f64],
        tangent: &mut [f64],
    ) -> Option<f64> {
        match self {
            FibreElement::Truss(truss) => truss.evaluate(positions, gradient, tangent),
            FibreElement::Crossing(crossing) => crossing.evaluate(positions, gradient, tangent),
            FibreElement::Beam(beam) => beam.evaluate(positions, rotations, gradient, tangent),
        }
    }

    /// Stretch and tension at its integration points.
    pub fn states(&self, positions: &[[f64; 3]], rotations: &[UnitQuaternion<f64>]) -> Vec<FibreState> {
        match self {
            FibreElement::Truss(truss) => truss.states(positions).collect(),
            FibreElement::Crossing(crossing) => crossing.states(positions).collect(),
            FibreElement::Beam(beam) => beam.states(positions, rotations).collect(),
        }
    }
}

/// Largest number of unknowns of an element of fibres.
pub(crate) const MAX_UNKNOWNS: usize = 33;

/// All fibres of a specimen, or of one of its sectors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fibres {
    /// Contributions to the energy.
    pub elements: Vec<FibreElement>,
    /// Rotations of the beams' nodes, undeformed, from the section's frame (x outwards, z along the fibre) to the base frame.
    pub rotations: Vec<UnitQuaternion<f64>>,
    /// The beams' rotation nodes at the base and at the tip, one pair a fibre. Unless the caps hold these, nothing but its curvature
    /// holds a fibre against turning about itself: a straight one leaves the tangent singular.
    pub ends: Vec<[u32; 2]>,
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
    /// [`SolidError::Invalid`] if a family does not divide into the grid's sectors, or its diameter is negative.
    pub fn trusses(specimen: &Specimen, grid: &Grid) -> Result<Self, SolidError> {
        let radius = specimen.tube.outer_radius();
        let mut fibres = Fibres::default();
        let mut first = 0;
        for winding in &specimen.windings {
            let strands = (0..fibres_in_sector(grid, winding)?).flat_map(|index| {
                let strands = strands(grid, winding, radius, index).into_iter();
                strands.map(move |strand| ((first + index) as u32, strand))
            });
            fibres.elements.extend(stretching(specimen, grid, winding, strands));
            first += winding.fibres as usize;
        }
        Ok(fibres)
    }

    /// All fibres as beams in the fibres' middle lines, round sections of the fibres' diameter; none for a bare tube.
    ///
    /// # Errors
    /// As for [`Fibres::trusses`], and [`SolidError::Invalid`] if a family has no diameter.
    pub fn beams(specimen: &Specimen, grid: &Grid) -> Result<Self, SolidError> {
        let radius = specimen.tube.outer_radius();
        let mut fibres = Fibres::default();
        let mut first = 0;
        for winding in &specimen.windings {
            let count = fibres_in_sector(grid, winding)?;
            if winding.fibre.diameter == 0.0 {
                return Err(SolidError::Invalid {
                    field: "the fibres' diameter (m)",
                    value: 0.0,
                    requirement: "beams need one for their bending stiffness: give it, or take trusses",
                });
            }
            let middles = || {
                (0..count).map(|index| ((first + index) as u32, middle_line(grid, winding, radius, index)))
            };
            let mut stiffness = beam::stiffness(&winding.fibre);
            if middle_line(grid, winding, radius, 0).slope != 0.0 {
                // Between places that a quadratic surface has interpolated, chords are wrong by second order, and EA would resist.
                stiffness[2] = 0.0;
                fibres.elements.extend(stretching(specimen, grid, winding, middles()));
            }
            for (fibre, strand) in middles() {
                fibres.add_beam(specimen, grid, winding, stiffness, (fibre, strand));
            }
            first += winding.fibres as usize;
        }
        Ok(fibres)
    }

    /// Two elements a piece of the strand.
    fn add_beam(
        &mut self,
        specimen: &Specimen,
        grid: &Grid,
        winding: &Winding,
        stiffness: Vector6<f64>,
        (fibre, strand): (u32, Strand),
    ) {
        let tube = specimen.tube;
        let turn = strand.slope + grid.turn;
        let flare = tube.wall * (specimen.wall_taper - 1.0) / tube.length;
        let face = |piece: &Piece| grid.face_points(2 * grid.through_tube, piece.cell);
        let frame = |piece: &Piece, share: f64| {
            let values = SurfacePoint::new(piece, share).values;
            beam::helix_frame(SurfacePoint::combine(&values, &face(piece), &grid.points), turn, flare)
        };
        let pieces = trace(grid, tube.length, strand);
        let start = self.rotations.len();
        // A node is in the sector of the piece that begins there; the last one in that of the last piece.
        let mut sectors = vec![];
        for piece in &pieces {
            self.rotations.extend([frame(piece, 0.0), frame(piece, 0.5)]);
            sectors.extend([piece.sector; 2]);
        }
        let Some(last) = pieces.last() else { return };
        self.rotations.push(frame(last, 1.0));
        sectors.push(last.sector);
        self.ends.push([start as u32, self.rotations.len() as u32 - 1]);
        let mut arc_length = 0.0;
        for (index, half) in (0..pieces.len()).flat_map(|index| [(index, 0), (index, 1)]) {
            let piece = &pieces[index];
            let node = |end: usize| {
                let node = 2 * index + half + end;
                let ahead = f64::from(sectors[node] - piece.sector) * TAU / grid.sectors as f64;
                ((start + node) as u32, UnitQuaternion::from_axis_angle(&Vector3::z_axis(), ahead))
            };
            let place = BeamPlace {
                piece,
                shares: [0.5 * half as f64, 0.5 * (half + 1) as f64],
                nodes: [node(0), node(1)],
                fibre,
                arc_length,
            };
            let undeformed = (&grid.points[..], &self.rotations[..]);
            let beam = Beam::new(&place, winding.fibre.law, stiffness, &face(piece), undeformed);
            arc_length += beam.length();
            self.elements.push(FibreElement::Beam(Box::new(beam)));
        }
    }

    /// A node's rotation after an increment w, rad, in its own frame: R exp(w).
    pub fn moved(rotation: &UnitQuaternion<f64>, increment: [f64; 3]) -> UnitQuaternion<f64> {
        let mut moved = rotation * UnitQuaternion::from_scaled_axis(Vector3::from(increment));
        moved.renormalize();
        moved
    }
}

/// What answers to the stretch of strands of one family: an element for each face that they run through.
fn stretching(
    specimen: &Specimen,
    grid: &Grid,
    winding: &Winding,
    strands: impl Iterator<Item = (u32, Strand)>,
) -> Vec<FibreElement> {
    let face = |[j, k]: [usize; 2]| grid.face_points(2 * grid.through_tube, [j, k]);
    let mut cells: BTreeMap<[usize; 2], Vec<TrussPiece>> = BTreeMap::new();
    let mut crosses = false;
    for (fibre, strand) in strands {
        crosses = strand.slope != 0.0;
        let mut arc_length = 0.0;
        for piece in trace(grid, specimen.tube.length, strand) {
            let traced = TrussPiece { piece, share: strand.share, fibre, arc_length };
            arc_length += truss::length(&piece, &face(piece.cell), &grid.points);
            let [j, k] = piece.cell;
            cells.entry([k, j]).or_default().push(traced);
        }
    }
    let element = |([k, j], pieces): (&[usize; 2], &Vec<TrussPiece>)| {
        let face = face([*j, *k]);
        if crosses {
            FibreElement::Crossing(Box::new(Crossing::new(pieces, &winding.fibre, &face, &grid.points)))
        } else {
            FibreElement::Truss(Truss::new(pieces, &winding.fibre, &face, &grid.points))
        }
    };
    cells.iter().map(element).collect()
}
