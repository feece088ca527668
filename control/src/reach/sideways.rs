use std::f64::consts::TAU;

/// Directions that are looked at.
const DIRECTIONS: usize = 72;

/// Greatest distance from the z axis by direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Sideways([(f64, f64); DIRECTIONS]);

impl Default for Sideways {
    fn default() -> Self {
        Sideways([(f64::NEG_INFINITY, 0.0); DIRECTIONS])
    }
}

impl Sideways {
    /// Each direction (rad from x, counter-clockwise seen from the tip), and there the greatest distance from the z axis and its height
    /// (m); `None` where the set is not met.
    pub fn reaches(&self) -> impl Iterator<Item = (f64, Option<(f64, f64)>)> + '_ {
        let direction = |index: usize| TAU * index as f64 / DIRECTIONS as f64;
        let reach = |reach: (f64, f64)| Some(reach).filter(|(radius, _)| *radius >= 0.0);
        self.0.iter().enumerate().map(move |(index, found)| (direction(index), reach(*found)))
    }

    /// Adds a tetrahedron: the farthest point of its shadow on a half-line lies on an edge.
    pub(super) fn add(&mut self, nodes: [&[f64; 3]; 4]) {
        let farthest = nodes.iter().map(|[x, y, _]| x.hypot(*y)).fold(0.0, f64::max);
        if self.0.iter().all(|(radius, _)| *radius > farthest) {
            return;
        }
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let (a, b) = (nodes[i], nodes[j]);
            let (from, to) = (a[1].atan2(a[0]), b[1].atan2(b[0]));
            // From the first end the shorter way round to the other.
            let turn = (to - from + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
            let (first, last) = if turn < 0.0 { (from + turn, from) } else { (from, from + turn) };
            let step = TAU / DIRECTIONS as f64;
            // A direction along the edge's end, but for rounding, counts.
            let (first, last) = ((first / step - 1e-9).ceil() as i64, (last / step + 1e-9).floor() as i64);
            for index in first..=last {
                let (sine, cosine) = (index as f64 * step).sin_cos();
                let (beside_a, beside_b) = (cosine * a[1] - sine * a[0], cosine * b[1] - sine * b[0]);
                let part = if beside_a == beside_b { 0.0 } else { beside_a / (beside_a - beside_b) };
                let part = part.clamp(0.0, 1.0);
                let at: [f64; 3] = std::array::from_fn(|axis| a[axis] + part * (b[axis] - a[axis]));
                self.meet(
                    index.rem_euclid(DIRECTIONS as i64) as usize,
                    (cosine * at[0] + sine * at[1], at[2]),
                );
            }
        }
    }

    pub(super) fn join(&mut self, other: &Sideways) {
        other.0.iter().enumerate().for_each(|(index, reach)| self.meet(index, *reach));
    }

    /// The farther; of equals the higher, so that the order does not matter.
    fn meet(&mut self, index: usize, found: (f64, f64)) {
        let farther = |a: (f64, f64), b: (f64, f64)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).is_gt();
        if farther(found, self.0[index]) {
            self.0[index] = found;
        }
    }
}
