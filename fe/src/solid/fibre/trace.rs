//! Fibres on the surface's grid. Between planes of the mesh and around, with eta = Theta - turn z the angle that the mesh's lines
//! have at z = 0, a helix is a straight line eta = eta_0 + slope z: here it is cut at the borders of the cells.

use super::super::mesh::Grid;
use std::f64::consts::TAU;

/// Nearer to a line of the mesh than this, in parts of a cell, is on it.
const ON_LINE: f64 = 1e-9;

/// One line of fibre, from base to tip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strand {
    /// eta at the base, rad.
    pub start: f64,
    /// d eta/dz, rad/m; exactly zero along the lines of the mesh.
    pub slope: f64,
    /// Its part of the fibre's stiffness.
    pub share: f64,
}

/// The part of a strand in one cell of the surface, straight in the cell's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Element around, along.
    pub cell: [usize; 2],
    /// (around, along) from -1 to 1 in the cell, where the piece begins and ends; it rises with z.
    pub ends: [[f64; 2]; 2],
    /// Sectors (turns of the whole tube) between the cell and where the fibre is: in a sector's mesh the piece stands for its
    /// image so many sectors further around.
    pub sector: i32,
}

impl Piece {
    /// Coordinates in the cell at `share` (0 to 1) of the piece.
    pub fn at(&self, share: f64) -> [f64; 2] {
        let [from, to] = self.ends;
        // Exact where both ends agree.
        std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * share)
    }

    /// Rate of the coordinates with `share`.
    pub fn direction(&self) -> [f64; 2] {
        std::array::from_fn(|axis| self.ends[1][axis] - self.ends[0][axis])
    }
}

/// Cells around, of one sector.
pub(super) struct Around<'a> {
    angles: &'a [f64],
    /// Angle of the sector, rad.
    pub period: f64,
}

impl<'a> Around<'a> {
    pub fn new(grid: &'a Grid) -> Self {
        Around { angles: &grid.angles, period: TAU / grid.sectors as f64 }
    }

    pub fn cells(&self) -> usize {
        self.angles.len() / 2
    }

    pub fn edge(&self, index: usize) -> f64 {
        self.angles[2 * index]
    }

    /// The lines between cells strictly between two angles, ascending, in all sectors.
    pub fn edges_between(&self, from: f64, to: f64) -> Vec<f64> {
        let tolerance = ON_LINE * self.period / self.cells() as f64;
        let mut edges = vec![];
        let first = (from / self.period).floor() as i64;
        let last = (to / self.period).floor() as i64;
        for sector in first..=last {
            let shift = sector as f64 * self.period;
            let inside = |edge: &f64| *edge > from + tolerance && *edge < to - tolerance;
            edges.extend((0..self.cells()).map(|index| self.edge(index) + shift).filter(inside));
        }
        edges
    }

    /// The cell that holds an angle, and its sector; the later cell on a line between two.
    fn cell_at(&self, angle: f64) -> (usize, i32) {
        let tolerance = ON_LINE * self.period / self.cells() as f64;
        let sector = ((angle + tolerance) / self.period).floor();
        let local = angle - sector * self.period;
        let mut low = 0;
        let mut high = self.cells();
        while high - low > 1 {
            let middle = (low + high) / 2;
            if self.edge(middle) <= local + tolerance { low = middle } else { high = middle }
        }
        (low, sector as i32)
    }

    /// Coordinate of an angle in a cell; on its border and middle line exactly.
    fn coordinate(&self, angle: f64, (cell, sector): (usize, i32)) -> f64 {
        let local = angle - f64::from(sector) * self.period;
        let (from, to) = (self.edge(cell), self.edge(cell + 1));
        snapped((2.0 * local - from - to) / (to - from))
    }
}

fn snapped(coordinate: f64) -> f64 {
    let nearest = coordinate.round();
    if (coordinate - nearest).abs() < 10.0 * ON_LINE { nearest } else { coordinate.clamp(-1.0, 1.0) }
}

/// The pieces of a strand on a tube of the given length (m), from base to tip.
pub(super) fn trace(grid: &Grid, length: f64, strand: Strand) -> Vec<Piece> {
    let around = Around::new(grid);
    let planes = grid.elements[2];
    // Heights are counted in elements along, so that planes between elements are whole numbers.
    let rise = strand.slope * length / planes as f64;
    let angle = |height: f64| strand.start + rise * height;
    let mut cuts: Vec<f64> = (0..=planes).map(|plane| plane as f64).collect();
    if rise != 0.0 {
        let end = angle(planes as f64);
        let edges = around.edges_between(strand.start.min(end), strand.start.max(end));
        cuts.extend(edges.iter().map(|edge| (edge - strand.start) / rise));
        cuts.sort_by(f64::total_cmp);
        // A corner of a cell is one cut, at its plane.
        let nearest_plane = |height: f64| (height - height.round()).abs();
        cuts.dedup_by(|next, kept| {
            let same = *next - *kept < ON_LINE;
            if same && nearest_plane(*next) < nearest_plane(*kept) {
                *kept = *next;
            }
            same
        });
    }
    let piece = |pair: &[f64]| {
        let middle = 0.5 * (pair[0] + pair[1]);
        let place = around.cell_at(angle(middle));
        let plane = (middle as usize).min(planes - 1);
        let end = |height: f64| {
            [around.coordinate(angle(height), place), snapped(2.0 * (height - plane as f64) - 1.0)]
        };
        Piece { cell: [place.0, plane], ends: [end(pair[0]), end(pair[1])], sector: place.1 }
    };
    cuts.windows(2).map(piece).collect()
}
