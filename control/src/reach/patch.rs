//! Faces of the box of pressures, cut into simplices whose images fill the reachable set.

use super::ReachError;
use crate::Bounds;
use actuator::grid_places;
use rom::{PoseEvaluation, PoseModel};

/// Most pressures of a face that is cut into simplices: with more of them its simplices are too many.
const MOST_DIMENSIONS: usize = 4;

/// Which pressures of a face are held at a bound: bit `i` at the least, bit `8 + i` at the greatest of FREE `i`; both where the two
/// bounds coincide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Face(pub(super) u16);

impl Face {
    pub(super) const NONE: Face = Face(0);

    pub(super) fn at(pressures: &[f64], bounds: &Bounds) -> Self {
        let held = pressures.iter().zip(bounds.lower.iter().zip(&bounds.upper)).enumerate();
        Face(held.fold(0, |bits, (free, (pressure, (lower, upper)))| {
            bits | u16::from(pressure <= lower) << free | u16::from(pressure >= upper) << (8 + free)
        }))
    }

    pub(super) fn both(self, other: Face) -> Face {
        Face(self.0 & other.0)
    }

    /// Whether the pressure of a FREE is the least.
    pub fn is_least(self, free: usize) -> bool {
        self.0 >> free & 1 == 1
    }

    /// Whether the pressure of a FREE is the greatest.
    pub fn is_greatest(self, free: usize) -> bool {
        self.0 >> (8 + free) & 1 == 1
    }

    /// How many pressures are not at a bound.
    pub fn dimension(self, frees: usize) -> usize {
        frees - (self.0 & 0xff | self.0 >> 8).count_ones() as usize
    }
}

/// A face of the box with an even grid of pressures on it.
pub(super) struct Patch {
    /// FREEs whose pressures vary.
    axes: Vec<usize>,
    /// Pressures of the corner from which they rise, Pa.
    corner: Vec<f64>,
    steps: usize,
    /// Tip position and face of every node, the last axis fastest.
    nodes: Vec<([f64; 3], Face)>,
}

/// All faces that are looked at: the box itself while it has up to four wide sides, else its faces of four.
pub(super) fn patches(bounds: &Bounds, steps: usize) -> Vec<Patch> {
    let wide: Vec<usize> = (0..bounds.lower.len()).filter(|i| bounds.upper[*i] > bounds.lower[*i]).collect();
    let held = wide.len().saturating_sub(MOST_DIMENSIONS);
    let mut found = vec![];
    for choice in 0..1u32 << wide.len() {
        if choice.count_ones() as usize != held {
            continue;
        }
        let (still, axes): (Vec<usize>, Vec<usize>) =
            (0..wide.len()).partition(|place| choice >> place & 1 == 1);
        let axes: Vec<usize> = axes.into_iter().map(|place| wide[place]).collect();
        for sides in 0..1u32 << held {
            let mut corner = bounds.lower.clone();
            for (bit, place) in still.iter().enumerate() {
                if sides >> bit & 1 == 1 {
                    corner[wide[*place]] = bounds.upper[wide[*place]];
                }
            }
            found.push(Patch { axes: axes.clone(), corner, steps, nodes: vec![] });
        }
    }
    found
}

impl Patch {
    /// How many pressures vary on it.
    pub fn dimensions(&self) -> usize {
        self.axes.len()
    }

    fn count(&self) -> usize {
        (self.steps + 1).pow(self.axes.len() as u32)
    }

    fn pressures(&self, node: usize, bounds: &Bounds) -> Vec<f64> {
        let mut pressures = self.corner.clone();
        let places = grid_places(self.axes.iter().map(|_| self.steps + 1), node);
        for (free, place) in self.axes.iter().zip(places) {
            // Its ends are met exactly: they decide what lies on a face.
            pressures[*free] = bounds.step(*free, place, self.steps);
        }
        pressures
    }

    /// Evaluates the model on the grid, `jobs` threads sharing it.
    pub fn fill<M: PoseModel>(
        &mut self,
        make: &(impl Fn() -> M + Sync),
        bounds: &Bounds,
        jobs: usize,
    ) -> Result<(), ReachError> {
        let count = self.count();
        let mut nodes = vec![([0.0; 3], Face::NONE); count];
        let part = count.div_ceil(jobs.max(1));
        let patch = &*self;
        std::thread::scope(|scope| {
            let workers: Vec<_> = nodes
                .chunks_mut(part)
                .enumerate()
                .map(|(chunk, nodes)| {
                    scope.spawn(move || -> Result<(), ReachError> {
                        let model = make();
                        let mut into = PoseEvaluation::new(bounds.lower.len(), 0);
                        for (place, node) in nodes.iter_mut().enumerate() {
                            let pressures = patch.pressures(chunk * part + place, bounds);
                            model.evaluate(&pressures, &mut into)?;
                            let position = into.chart.to_pose().position;
                            *node = (position.into(), Face::at(&pressures, bounds));
                        }
                        Ok(())
                    })
                })
                .collect();
            workers.into_iter().try_for_each(|worker| worker.join().unwrap_or(Err(ReachError::Broken)))
        })?;
        self.nodes = nodes;
        Ok(())
    }

    /// Positions of the nodes.
    pub fn positions(&self) -> impl Iterator<Item = &[f64; 3]> {
        self.nodes.iter().map(|(position, _)| position)
    }

    /// Slices of simplices that can be taken one by one.
    pub fn slices(&self) -> usize {
        if self.axes.len() < 3 { 0 } else { self.steps + 1 }
    }

    /// Tells every simplex of three dimensions of the Freudenthal triangulation whose lowest node lies in a slice: the nodes
    /// `v, v + e(A), v + e(B), v + e(C)` with sets of axes A in B in C. The image of a simplex of four dimensions under the map that is
    /// linear on it is that of its faces of three, so that these fill the image of a box of four sides.
    pub fn simplices(&self, slice: usize, mut tell: impl FnMut([&([f64; 3], Face); 4])) {
        let (side, all) = (self.steps + 1, (1usize << self.axes.len()) - 1);
        let stride: Vec<usize> = (0..self.axes.len()).rev().map(|power| side.pow(power as u32)).collect();
        let offset = |set: usize| -> usize {
            stride.iter().enumerate().filter(|(axis, _)| set >> axis & 1 == 1).map(|(_, step)| step).sum()
        };
        let within = |small: usize, large: usize| small & large == small && small != large;
        let mut chains = vec![];
        for a in 1..=all {
            for b in (1..=all).filter(|b| within(a, *b)) {
                chains.extend((1..=all).filter(|c| within(b, *c)).map(|c| (c, [a, b, c].map(offset))));
            }
        }
        for first in slice * stride[0]..(slice + 1) * stride[0] {
            let ends: usize = (0..self.axes.len())
                .filter(|axis| first / stride[*axis] % side == self.steps)
                .fold(0, |ends, axis| ends | 1 << axis);
            for (reach, [a, b, c]) in &chains {
                if reach & ends == 0 {
                    let node = |offset: usize| &self.nodes[first + offset];
                    tell([node(0), node(*a), node(*b), node(*c)]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(frees: usize) -> Bounds {
        Bounds { lower: vec![0.0; frees], upper: vec![1.0; frees], limit: vec![2.0; frees] }
    }

    #[test]
    fn simplices_are_as_many_as_freudenthal_s() {
        for (frees, steps, expected) in [(3, 1, 6), (3, 2, 48), (2, 3, 0)] {
            let mut patch = patches(&bounds(frees), steps).remove(0);
            patch.nodes = vec![([0.0; 3], Face::NONE); patch.count()];
            let mut count = 0;
            (0..patch.slices()).for_each(|slice| patch.simplices(slice, |_| count += 1));
            assert_eq!(count, expected);
        }
        let mut patch = patches(&bounds(4), 1).remove(0);
        patch.nodes = vec![([0.0; 3], Face::NONE); 16];
        let (mut inside, mut outside) = (0, 0);
        for (node, place) in patch.nodes.iter_mut().zip(0usize..) {
            node.1 = Face((0..4).fold(0, |bits, axis| {
                let at = place >> (3 - axis) & 1;
                bits | 1 << if at == 0 { axis } else { 8 + axis }
            }));
        }
        for slice in 0..patch.slices() {
            patch.simplices(slice, |nodes| {
                let face = nodes.iter().fold(Face(u16::MAX), |face, node| face.both(node.1));
                if face.dimension(4) == 4 { inside += 1 } else { outside += 1 }
            });
        }
        // Of the 24 simplices of four dimensions' five faces each those of eight cubes, six each, lie outside, the others pairwise inside.
        assert_eq!((inside, outside), (36, 48));
    }

    #[test]
    fn many_frees_are_seen_on_faces_of_four() {
        let mut six = bounds(6);
        assert_eq!(patches(&six, 2).len(), 15 * 4);
        six.upper[0] = 0.0;
        // A FREE without room is held for good.
        assert_eq!(patches(&six, 2).len(), 5 * 2);
        assert_eq!(patches(&bounds(4), 2).len(), 1);
    }

    #[test]
    fn a_face_knows_what_holds_it() {
        let face = Face::at(&[0.0, 0.5, 1.0], &bounds(3));
        assert!(face.is_least(0) && face.is_greatest(2) && !face.is_least(1) && !face.is_greatest(1));
        assert_eq!(face.dimension(3), 1);
    }
}
