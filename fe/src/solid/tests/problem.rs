use crate::solid::{
    element::{Condensation, ElementLaw, PAIRS, UNKNOWNS, Workspace},
    shape::{NODES, Shape},
};
use nalgebra::{DMatrix, DVector};

use super::noise;

/// Unknown of a small problem: which points it moves, and where to.
pub type Mode = Vec<(usize, [f64; 3])>;

/// A few elements with dense matrices, assembled here and not by the body.
pub struct Problem {
    pub points: Vec<[f64; 3]>,
    pub elements: Vec<[usize; NODES]>,
    pub shapes: Vec<Shape>,
    pub law: ElementLaw,
}

/// Elements of a block, `n` in each direction, and its lines of points.
fn block(n: [usize; 3]) -> (Vec<[usize; NODES]>, [usize; 3]) {
    let lines = n.map(|n| 2 * n + 1);
    let number = |i: usize, j: usize, k: usize| (k * lines[1] + j) * lines[0] + i;
    let mut elements = vec![];
    for k in 0..n[2] {
        for j in 0..n[1] {
            for i in 0..n[0] {
                elements
                    .push(std::array::from_fn(|a| number(2 * i + a % 3, 2 * j + a / 3 % 3, 2 * k + a / 9)));
            }
        }
    }
    (elements, lines)
}

/// Places (i, j, k) of the points of a block.
fn places(lines: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..lines.iter().product()).map(move |p| [p % lines[0], p / lines[0] % lines[1], p / lines[0] / lines[1]])
}

impl Problem {
    /// Elements between points that `at` puts in place, by share (0 to 1) of the block in each direction.
    pub fn mapped(n: [usize; 3], law: ElementLaw, at: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let (elements, lines) = block(n);
        let share = |place: [usize; 3]| std::array::from_fn(|i| place[i] as f64 / (lines[i] - 1) as f64);
        let points = places(lines).map(|place| at(share(place))).collect();
        Self::of(points, elements, law)
    }

    /// A box whose points are shifted at random by up to `distortion` times their distance, those on a face within it: all edges
    /// inside it are curved.
    pub fn shaken_box(n: [usize; 3], size: [f64; 3], distortion: f64, law: ElementLaw) -> Self {
        let (elements, lines) = block(n);
        let point = |(index, place): (usize, [usize; 3])| {
            std::array::from_fn(|i| {
                let spacing = size[i] / (lines[i] - 1) as f64;
                let on_face = place[i] == 0 || place[i] == lines[i] - 1;
                let shift = if on_face { 0.0 } else { distortion * noise(3 * index + i) };
                spacing * (place[i] as f64 + shift)
            })
        };
        Self::of(places(lines).enumerate().map(point).collect(), elements, law)
    }

    fn of(points: Vec<[f64; 3]>, elements: Vec<[usize; NODES]>, law: ElementLaw) -> Self {
        let shapes = elements
            .iter()
            .enumerate()
            .map(|(index, element)| Shape::new(&element.map(|point| points[point]), index).unwrap())
            .collect();
        Problem { points, elements, shapes, law }
    }

    /// Equilibrium of the modes: Newton's method on positions and pressures from given ones. The forces on the modes that are left, in
    /// units of the shear modulus times area.
    pub fn equilibrate(&self, modes: &[Mode], x: &mut [[f64; 3]], q: &mut [[f64; 4]]) -> f64 {
        let mut on: Vec<Vec<(usize, [f64; 3])>> = vec![vec![]; self.points.len()];
        for (index, mode) in modes.iter().enumerate() {
            mode.iter().for_each(|&(point, direction)| on[point].push((index, direction)));
        }
        let (mut work, mut condensation) = (Workspace::default(), Condensation::default());
        let mut left = f64::INFINITY;
        for _ in 0..30 {
            let mut force = DVector::<f64>::zeros(modes.len());
            let mut right = DVector::<f64>::zeros(modes.len());
            let mut tangent = DMatrix::<f64>::zeros(modes.len(), modes.len());
            let mut condensations = vec![];
            let mut mismatch = 0.0f64;
            for ((element, shape), q) in self.elements.iter().zip(&self.shapes).zip(q.iter()) {
                let positions: [f64; UNKNOWNS] = std::array::from_fn(|u| x[element[u % NODES]][u / NODES]);
                work.evaluate(&self.law, shape, &positions, q, &mut condensation, true).unwrap();
                mismatch = mismatch.max(condensation.mismatch[0].abs() / shape.volume());
                let mut condensed = work.residual;
                condensation.condense(&self.law, shape, &mut condensed);
                for a in 0..NODES {
                    for &(m, along) in &on[element[a]] {
                        for i in 0..3 {
                            force[m] += along[i] * work.residual[i * NODES + a];
                            right[m] += along[i] * condensed[i * NODES + a];
                        }
                        for b in 0..NODES {
                            for &(n, across) in &on[element[b]] {
                                tangent[(m, n)] += (0..9)
                                    .map(|ik| {
                                        along[ik / 3] * across[ik % 3] * entry(&work, a, ik / 3, b, ik % 3)
                                    })
                                    .sum::<f64>();
                            }
                        }
                    }
                }
                condensations.push(condensation.clone());
            }
            left = force.amax();
            if left < 1e-13 && mismatch < 1e-14 {
                break;
            }
            let step = tangent.lu().solve(&-right).unwrap();
            let mut moves = vec![[0.0; 3]; x.len()];
            for (moves, on) in moves.iter_mut().zip(&on) {
                for &(m, along) in on {
                    (0..3).for_each(|i| moves[i] += step[m] * along[i]);
                }
            }
            for (((element, shape), condensation), q) in
                self.elements.iter().zip(&self.shapes).zip(&condensations).zip(q.iter_mut())
            {
                let moved = std::array::from_fn(|u| moves[element[u % NODES]][u / NODES]);
                let change = condensation.pressure_step(&self.law, shape, &moved, true);
                q.iter_mut().zip(change).for_each(|(q, change)| *q += change);
            }
            for (x, moves) in x.iter_mut().zip(&moves) {
                (0..3).for_each(|i| x[i] += moves[i]);
            }
        }
        left
    }
}

/// Entry of the condensed tangent between node `a` in direction `i` and node `b` in direction `k`.
fn entry(work: &Workspace, a: usize, i: usize, b: usize, k: usize) -> f64 {
    let (pair, row, column) = if i <= k { ((i, k), a, b) } else { ((k, i), b, a) };
    let block = PAIRS.iter().position(|p| *p == pair).unwrap();
    work.tangent[(block * NODES + column) * NODES + row]
}
