use super::{SolidError, Specimen};
use actuator::Free;
use std::f64::consts::TAU;

/// How finely a specimen is divided into 27-node hexahedra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolidMesh {
    /// Elements through the wall.
    pub radial: usize,
    /// Elements around the tube, beside those under the fibres; with fibres an even number for each.
    pub around: usize,
    /// Elements under half the width of each fibre; zero where the fibres' width is not resolved.
    pub under_fibre: usize,
    /// Elements along the tube.
    pub along: usize,
    /// Whether the lines of the mesh along the tube follow the first family of fibres; else they are straight.
    pub follows_fibres: bool,
}

impl SolidMesh {
    /// One element through the wall, `around` around and `along` along, following the fibres.
    pub fn new(around: usize, along: usize) -> Self {
        SolidMesh { radial: 1, around, under_fibre: 0, along, follows_fibres: true }
    }

    /// Elements through the wall, around and along.
    pub(crate) fn of_elements([radial, around, along]: [u32; 3]) -> Self {
        SolidMesh { radial: radial as usize, ..SolidMesh::new(around as usize, along as usize) }
    }

    /// Greatest length of an element along a FREE, m, that keeps it well shaped: 0.26 outer radii (1.45 mm for the paper's tube), and no
    /// more than spans 0.76 of them along a fibre. At low angles the fibre, not the tube, sets it: an edge spans no more than 43 deg of
    /// its helix.
    pub(crate) fn longest_element(free: &Free) -> f64 {
        free.tube.outer_radius() * 0.26f64.min(0.76 * free.winding.angle_from_hoop().sin())
    }

    /// Elements around a FREE: an even number for each fibre, at least so many.
    pub(crate) fn around(free: &Free, least: usize) -> usize {
        let each = 2 * free.winding.fibres.max(1) as usize;
        each * least.div_ceil(each)
    }

    /// The leanest mesh that is good for bending and for modules: one element through the wall, two around for each fibre (at least 12
    /// in all), as many along as keep them well shaped.
    pub fn lean(free: &Free) -> Self {
        let along = (free.tube.length / Self::longest_element(free)).ceil().min(1e6) as usize;
        SolidMesh::new(Self::around(free, 12), 2 * along.div_ceil(2))
    }

    /// Every element divided in `factor` in all three directions.
    pub fn refined(self, factor: usize) -> Self {
        SolidMesh {
            radial: self.radial * factor,
            around: self.around * factor,
            under_fibre: self.under_fibre * factor,
            along: self.along * factor,
            ..self
        }
    }
}

/// Nodes and elements of a tube, undeformed; `lines` of nodes radially (inside out), around (counter-clockwise seen from the
/// tip) and along (base to tip). Point (i, j, k) has number `(k lines[1] + j) lines[0] + i`; element (i, j, k) spans points 2i to
/// 2i + 2, and so on.
///
/// A mesh of the whole tube closes around. A mesh of one sector of a specimen that is the same in every sector has one
/// more line of points around, the images of its first line turned by one sector.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Reference positions of all points, m.
    pub points: Vec<[f64; 3]>,
    pub lines: [usize; 3],
    /// Elements radially, around, along.
    pub elements: [usize; 3],
    /// How many such sectors make the tube; 1 for the whole tube.
    pub sectors: usize,
    /// Elements through the tube's own wall; those beyond are the coat's.
    pub through_tube: usize,
    /// Angles of the lines around at z = 0, rad, one for each half element and the end.
    pub angles: Vec<f64>,
    /// Turn of the lines along the tube, rad/m.
    pub turn: f64,
}

/// Angles of the lines of elements around: `elements` between fibres, finer towards them, and `under` under each half fibre.
fn lines_around(pitches: usize, pitch: f64, half_width: f64, elements: usize, under: usize) -> Vec<f64> {
    let beside = elements / 2;
    let mut half = vec![0.0];
    let from = if under == 0 { 0.0 } else { half_width };
    half.extend((1..=under).map(|i| half_width * i as f64 / under as f64));
    // Widths grow away from the fibre by the same factor, from the width under it.
    let first = if under == 0 { 0.0 } else { half_width / under as f64 };
    let ratio = growth(first, 0.5 * pitch - from, beside);
    let total: f64 = (0..beside).map(|i| ratio.powi(i as i32)).sum();
    let mut place = from;
    for i in 0..beside {
        place += (0.5 * pitch - from) * ratio.powi(i as i32) / total;
        half.push(place);
    }
    let mut edges = vec![];
    for index in 0..pitches {
        let start = index as f64 * pitch;
        edges.extend(half.iter().map(|angle| start + angle));
        edges.extend(half[1..half.len() - 1].iter().rev().map(|angle| start + pitch - angle));
    }
    edges.push(pitches as f64 * pitch);
    edges
}

/// Factor between neighbouring widths with which `count` elements starting with about `first` fill `total`; 1 when they need not grow.
fn growth(first: f64, total: f64, count: usize) -> f64 {
    let filled = |ratio: f64| (1..=count as i32).map(|i| first * ratio.powi(i)).sum::<f64>();
    if first == 0.0 || filled(1.0) >= total {
        return 1.0;
    }
    let (mut low, mut high) = (1.0, 1.0 + total / first);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if filled(middle) < total { low = middle } else { high = middle }
    }
    low
}

fn with_midpoints(edges: &[f64]) -> Vec<f64> {
    let mut lines = vec![edges[0]];
    for pair in edges.windows(2) {
        lines.extend([0.5 * (pair[0] + pair[1]), pair[1]]);
    }
    lines
}

impl Grid {
    /// The mesh of the whole specimen, or of one of its equal sectors.
    pub fn new(specimen: &Specimen, mesh: SolidMesh, sectors: usize) -> Result<Self, SolidError> {
        let refuse = |field, value: usize, requirement| {
            Err(SolidError::Invalid { field, value: value as f64, requirement })
        };
        if mesh.radial == 0 || mesh.along == 0 {
            return refuse(
                "a number of elements",
                0,
                "there must be at least one through the wall and one along",
            );
        }
        let fibres = specimen.windings.first().map(|winding| winding.fibres as usize);
        let pitches = fibres.unwrap_or(sectors);
        if mesh.around < 4 || mesh.around > 100_000 {
            return refuse("the number of elements around", mesh.around, "it must be at least 4");
        }
        if fibres.is_some() && mesh.follows_fibres && !mesh.around.is_multiple_of(2 * pitches) {
            return refuse(
                "the number of elements around",
                mesh.around,
                "it must be an even number for each fibre",
            );
        }
        let tube = specimen.tube;
        let outer = tube.outer_radius();
        let turn = if mesh.follows_fibres { specimen.turn_per_length() } else { 0.0 };
        // Three points of a helix that turns by more than a half circle pass for another helix.
        let along = (turn * tube.length).abs() / mesh.along as f64;
        if along > 0.5 * TAU {
            return Err(SolidError::Invalid {
                field: "the turn (rad) of the mesh's lines around the tube in one element along it",
                value: along,
                requirement: "it must be at most pi: use more elements along, or a mesh that does not follow the fibres",
            });
        }
        let edges = match specimen.windings.first() {
            Some(winding) if mesh.follows_fibres => {
                let pitch = TAU / pitches as f64;
                let half_width = 0.5 * winding.fibre.diameter / (winding.angle_from_hoop().sin() * outer);
                if mesh.under_fibre > 0 && !(half_width > 0.0 && half_width < 0.4 * pitch) {
                    return Err(SolidError::Invalid {
                        field: "half the angle that a fibre covers (rad)",
                        value: half_width,
                        requirement: "to put elements under it, it must lie between 0 and 40 % of the pitch",
                    });
                }
                lines_around(pitches / sectors, pitch, half_width, mesh.around / pitches, mesh.under_fibre)
            }
            _ => {
                let around = mesh.around / sectors;
                (0..=around).map(|i| TAU * i as f64 / (around * sectors) as f64).collect()
            }
        };
        let around = edges.len() - 1;
        let angles = with_midpoints(&edges);
        let through_coat = specimen.coat.map_or(0, |_| mesh.radial);
        let elements = [mesh.radial + through_coat, around, mesh.along];
        let closed = sectors == 1;
        let lines = [2 * elements[0] + 1, 2 * around + usize::from(!closed), 2 * mesh.along + 1];
        let mut points = Vec::with_capacity(lines.iter().product());
        for k in 0..lines[2] {
            let share = k as f64 / (lines[2] - 1) as f64;
            let z = tube.length * share;
            let offset = [0, 1].map(|axis| {
                specimen.bore_offset[0][axis] * (1.0 - share) + specimen.bore_offset[1][axis] * share
            });
            let tube_outer = tube.inner_radius + tube.wall * (1.0 + (specimen.wall_taper - 1.0) * share);
            for &start in &angles[..lines[1]] {
                let (sine, cosine) = (start + turn * z).sin_cos();
                // Distance of the shifted bore from the axis in this direction.
                let along = offset[0] * cosine + offset[1] * sine;
                let across = offset[1] * cosine - offset[0] * sine;
                let bore = along + (tube.inner_radius.powi(2) - across * across).sqrt();
                for i in 0..lines[0] {
                    let radius = if i <= 2 * mesh.radial {
                        bore + (tube_outer - bore) * i as f64 / (2 * mesh.radial) as f64
                    } else {
                        let thickness = specimen.coat.map_or(0.0, |coat| coat.thickness);
                        tube_outer + thickness * (i - 2 * mesh.radial) as f64 / (2 * mesh.radial) as f64
                    };
                    points.push([radius * cosine, radius * sine, z]);
                }
            }
        }
        Ok(Grid { points, lines, elements, sectors, through_tube: mesh.radial, angles, turn })
    }

    /// Number of point (i, j, k); j may be one past the last line of a closed mesh.
    pub fn point(&self, i: usize, j: usize, k: usize) -> u32 {
        let j = if self.sectors == 1 && j == self.lines[1] { 0 } else { j };
        ((k * self.lines[1] + j) * self.lines[0] + i) as u32
    }

    /// Elements in order: radially fastest, then around, then along.
    pub fn element_places(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let [ni, nj, nk] = self.elements;
        (0..nk).flat_map(move |k| (0..nj).flat_map(move |j| (0..ni).map(move |i| [i, j, k])))
    }

    /// The 27 points of element (i, j, k), radially fastest, then around, then along.
    pub fn element_points(&self, [i, j, k]: [usize; 3]) -> [u32; 27] {
        std::array::from_fn(|a| self.point(2 * i + a % 3, 2 * j + a / 3 % 3, 2 * k + a / 9))
    }

    /// The 9 points of the face of elements (., j, k) at line `i` of points, around fastest, then along: its normal
    /// (around x along) points outwards.
    pub fn face_points(&self, i: usize, [j, k]: [usize; 2]) -> [u32; 9] {
        std::array::from_fn(|a| self.point(i, 2 * j + a % 3, 2 * k + a / 3))
    }

    /// The point of which `point` is the image in a sector's mesh; `None` for a point of its own.
    pub fn master(&self, point: usize) -> Option<usize> {
        let [ni, nj, _] = self.lines;
        let j = point / ni % nj;
        (self.sectors > 1 && j == nj - 1).then(|| point - j * ni)
    }

    /// Plane of points (k) of a point.
    pub fn plane(&self, point: usize) -> usize {
        point / (self.lines[0] * self.lines[1])
    }

    /// Whether elements at radial place `i` belong to the coat.
    pub fn is_coat(&self, i: usize) -> bool {
        i >= self.through_tube
    }
}
