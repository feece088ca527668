use crate::{MAX_AXES, Real, SplineGrid};

/// Linear interpolation between the nodes of a grid, axis by axis, of a table with `OUT` numbers a node (last axis fastest). A
/// coordinate outside counts as the nearest inside.
///
/// # Panics
/// When the point or the table is not of the grid.
pub fn multilinear<T: Real, R: AsRef<[T]>, const OUT: usize>(
    grid: &SplineGrid<T, R>,
    table: &[[T; OUT]],
    point: &[T],
) -> [T; OUT] {
    let axes = grid.axes();
    assert_eq!(point.len(), axes.len(), "a point has one coordinate per axis");
    let mut shares = [T::ZERO; MAX_AXES];
    let mut first = 0;
    for (((axis, stride), x), share) in axes.iter().zip(grid.strides()).zip(point).zip(&mut shares) {
        let nodes = axis.nodes();
        if let [lower, .., upper] = *nodes {
            let inside = x.greater(lower).lesser(upper);
            let below = nodes[1..nodes.len() - 1].partition_point(|node| *node <= inside);
            *share = (inside - nodes[below]) / (nodes[below + 1] - nodes[below]);
            first += below * stride;
        }
    }
    let mut sum = [T::ZERO; OUT];
    for corner in 0..1usize << axes.len() {
        let (mut weight, mut place) = (T::ONE, first);
        for (axis, (stride, share)) in grid.strides().iter().zip(shares).enumerate() {
            let above = corner >> axis & 1 == 1;
            weight *= if above { share } else { T::ONE - share };
            place += if above { *stride } else { 0 };
        }
        // Where nothing is asked of a neighbour there may be none.
        if weight > T::ZERO {
            for (into, value) in sum.iter_mut().zip(table[place]) {
                *into += weight * value;
            }
        }
    }
    sum
}
