use actuator::Free;
use std::f64::consts::{PI, TAU};

/// How finely one fibre pitch of the cross-section is divided into nine-node quadrilaterals.
///
/// Half a pitch is meshed, from a fibre's middle to halfway between two fibres: a half turn about the radius through the
/// fibre's middle carries tube, fibres and loads into themselves, so the other half is its image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectionMesh {
    /// Elements through the wall.
    pub radial: usize,
    /// Elements under half the fibre's width.
    pub under_fibre: usize,
    /// Elements from the fibre's edge to halfway between two fibres, finer towards the fibre.
    pub between_fibres: usize,
}

impl Default for SectionMesh {
    /// Two elements through the wall, two under half the fibre, four beside it: a mesh that can be halved every way.
    fn default() -> Self {
        SectionMesh { radial: 2, under_fibre: 2, between_fibres: 4 }
    }
}

impl SectionMesh {
    /// Every element divided in `factor` both ways.
    pub fn refined(self, factor: usize) -> Self {
        SectionMesh {
            radial: self.radial * factor,
            under_fibre: self.under_fibre * factor,
            between_fibres: self.between_fibres * factor,
        }
    }

    /// Two coarser meshes for an estimate of errors: half as many elements every way, and half as many through the wall. `None` where
    /// a number of them is odd.
    pub fn coarsened(self) -> Option<[Self; 2]> {
        let SectionMesh { radial, under_fibre, between_fibres } = self;
        let even = [radial, under_fibre, between_fibres].iter().all(|count| count % 2 == 0);
        let through_wall = SectionMesh { radial: radial / 2, ..self };
        let every_way =
            SectionMesh { under_fibre: under_fibre / 2, between_fibres: between_fibres / 2, ..through_wall };
        even.then_some([every_way, through_wall])
    }
}

/// Lines of nodes of the cross-section, in units of the outer radius; element (i, j) spans lines 2i..2i+2 and 2j..2j+2.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Radii of nodes, from the bore to 1.
    pub radii: Vec<f64>,
    /// Angles eta of nodes, rad, from the middle of the fibre.
    pub angles: Vec<f64>,
    /// For each element around: whether it lies under a fibre.
    pub under_fibre: Vec<bool>,
    /// Half of the angle that a fibre covers, rad.
    pub half_footprint: f64,
    /// How many such pieces make the whole tube.
    pub pieces: f64,
    /// Whether the last line of nodes is the first one again (a whole pitch), instead of a second mirror line.
    pub periodic: bool,
}

/// Edges of `count` elements on [from, to], each `ratio` times as wide as the one before.
fn graded(from: f64, to: f64, count: usize, ratio: f64) -> impl Iterator<Item = f64> {
    let total: f64 = (0..count as i32).map(|i| ratio.powi(i)).sum();
    (1..=count).map(move |i| {
        let share: f64 = (0..i as i32).map(|i| ratio.powi(i)).sum::<f64>() / total;
        from + (to - from) * share
    })
}

/// Ratio of neighbouring widths for which `count` elements starting with width `first` fill `total`; never below one.
fn grading_ratio(first: f64, total: f64, count: usize) -> f64 {
    let filled = |ratio: f64| (0..count as i32).map(|i| first * ratio.powi(i)).sum::<f64>();
    if count < 2 || filled(1.0) >= total {
        return 1.0;
    }
    let (mut low, mut high) = (1.0, total / first);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if filled(middle) < total { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

fn with_midpoints(edges: &[f64]) -> Vec<f64> {
    let mut lines = vec![edges[0]];
    for pair in edges.windows(2) {
        lines.extend([0.5 * (pair[0] + pair[1]), pair[1]]);
    }
    lines
}

impl Grid {
    /// Half a pitch of the FREE's section.
    pub fn half_pitch(free: &Free, mesh: SectionMesh) -> Self {
        let outer = free.tube.outer_radius();
        let half_pitch = PI / f64::from(free.winding.fibres);
        // A thread of width d across itself covers d/sin(angle from hoop) along the hoop.
        let width = free.winding.fibre.diameter / free.winding.angle_from_hoop().sin();
        let half_footprint = (0.5 * width / outer).min(half_pitch);

        let mut edges = vec![0.0];
        edges.extend(graded(0.0, half_footprint, mesh.under_fibre, 1.0));
        let rest = half_pitch - half_footprint;
        // A gap narrower than this is rounding of a fibre that covers the pitch.
        let beside = if rest > 1e-9 * half_pitch { mesh.between_fibres } else { 0 };
        let first = half_footprint / mesh.under_fibre as f64;
        edges.extend(graded(half_footprint, half_pitch, beside, grading_ratio(first, rest, beside)));
        let bore = free.tube.inner_radius / outer;
        let mut radial = vec![bore];
        radial.extend(graded(bore, 1.0, mesh.radial, 1.0));
        Grid {
            radii: with_midpoints(&radial),
            angles: with_midpoints(&edges),
            under_fibre: (0..mesh.under_fibre + beside).map(|i| i < mesh.under_fibre).collect(),
            half_footprint,
            pieces: 2.0 * f64::from(free.winding.fibres),
            periodic: false,
        }
    }

    /// The whole pitch, fibre in the middle, made of the half and its mirror image.
    #[cfg(test)]
    pub fn whole_pitch(free: &Free, mesh: SectionMesh) -> Self {
        let half = Grid::half_pitch(free, mesh);
        let mirrored = half.angles[1..].iter().rev().map(|angle| -angle);
        Grid {
            angles: mirrored.chain(half.angles.iter().copied()).collect(),
            under_fibre: half.under_fibre.iter().rev().chain(&half.under_fibre).copied().collect(),
            pieces: 0.5 * half.pieces,
            periodic: true,
            ..half
        }
    }

    pub fn elements_around(&self) -> usize {
        self.under_fibre.len()
    }

    pub fn elements_through(&self) -> usize {
        self.radii.len() / 2
    }

    pub fn nodes(&self) -> usize {
        self.radii.len() * self.angles.len()
    }

    pub fn node(&self, around: usize, through: usize) -> usize {
        around * self.radii.len() + through
    }

    /// Share of the circumference that the fibres cover.
    pub fn covered(&self) -> f64 {
        let fibres = if self.periodic { self.pieces } else { 0.5 * self.pieces };
        fibres * 2.0 * self.half_footprint / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::tests::free;

    #[test]
    fn lines_fall_on_the_bore_the_surface_and_the_fibres_edge() {
        let free = free(20.0);
        let grid = Grid::half_pitch(&free, SectionMesh { radial: 3, under_fibre: 2, between_fibres: 5 });
        assert!((grid.radii[0] - 4.76 / 5.56).abs() < 1e-14 && (grid.radii[6] - 1.0).abs() < 1e-14);
        let edge = 0.5 * 0.3 / 20f64.to_radians().sin() / 5.56;
        assert!((grid.angles[4] - edge).abs() < 1e-14, "the fibre ends between lines");
        assert!((grid.angles[14] - PI / 6.0).abs() < 1e-14);
        let widths: Vec<f64> = (0..7).map(|i| grid.angles[2 * i + 2] - grid.angles[2 * i]).collect();
        assert!(
            widths.windows(2).all(|pair| pair[1] > pair[0] - 1e-14),
            "not finer towards the fibre: {widths:?}"
        );
        assert!((grid.covered() - 6.0 * 2.0 * edge / TAU).abs() < 1e-14);
    }

    #[test]
    fn a_fibre_wider_than_the_pitch_covers_it() {
        let mut free = free(20.0);
        free.winding.fibre.diameter = 0.01;
        let grid = Grid::half_pitch(&free, SectionMesh::default());
        assert!(grid.under_fibre.iter().all(|under| *under));
        assert!((grid.covered() - 1.0).abs() < 1e-14);
    }
}
