use crate::SplineGrid;
use actuator::grid_places;

/// The part of a grid on which the finite elements found stable states: the cells that have one at every corner.
pub(crate) struct StableRegion {
    stable: Vec<bool>,
    /// Lower corner and whether it is inside, of every cell.
    cells: Vec<(Vec<usize>, bool)>,
}

/// Steps of the conjugate gradients that continue a table; far more than they take.
const STEPS: usize = 2000;
/// Residual at which they end, as a share of the first.
const TOLERANCE: f64 = 1e-12;

impl StableRegion {
    /// The region of a grid whose nodes (last axis fastest) are stable or not.
    pub fn new(grid: &SplineGrid, stable: Vec<bool>) -> Self {
        let along = |len: usize| len.max(2) - 1;
        let count = |axis: &crate::SplineAxis| along(axis.nodes().len());
        let total: usize = grid.axes().iter().map(count).product();
        let cells = (0..total)
            .map(|cell| {
                let corner = grid_places(grid.axes().iter().map(count), cell);
                let inside = corners(grid, &corner).all(|node| stable[node]);
                (corner, inside)
            })
            .collect();
        StableRegion { stable, cells }
    }

    /// Whether any cell is inside.
    pub fn has_cell(&self) -> bool {
        self.cells.iter().any(|(_, inside)| *inside)
    }

    /// The nodes without a stable state.
    pub fn outside(&self) -> impl Iterator<Item = usize> {
        self.stable.iter().enumerate().filter(|(_, stable)| !**stable).map(|(node, _)| node)
    }

    /// Of each node how much (Pa) every pressure may change at once before a cell without is met, negative inside such cells; empty where
    /// all nodes are stable.
    pub fn clearance(&self, grid: &SplineGrid) -> Vec<f64> {
        if self.stable.iter().all(|stable| *stable) {
            return Vec::new();
        }
        let axes = grid.axes();
        let sides = |corner: &[usize]| -> Vec<(f64, f64)> {
            let side = |(axis, place): (&crate::SplineAxis, &usize)| {
                (axis.nodes()[*place], axis.nodes()[(place + 1).min(axis.nodes().len() - 1)])
            };
            axes.iter().zip(corner).map(side).collect()
        };
        let cells: Vec<_> = self.cells.iter().map(|(corner, inside)| (sides(corner), *inside)).collect();
        (0..grid.node_count())
            .map(|node| {
                let places = grid_places(axes.iter().map(|axis| axis.nodes().len()), node);
                let at: Vec<f64> =
                    places.iter().zip(axes).map(|(place, axis)| axis.nodes()[*place]).collect();
                let (mut to_outside, mut to_inside) = (f64::INFINITY, f64::INFINITY);
                for (cell, inside) in &cells {
                    let off = |(x, (lower, upper)): (&f64, &(f64, f64))| (lower - x).max(x - upper);
                    let distance = at.iter().zip(cell).map(off).fold(0.0, f64::max);
                    let nearest = if *inside { &mut to_inside } else { &mut to_outside };
                    *nearest = nearest.min(distance);
                }
                // A node on the boundary belongs to cells of both kinds.
                if to_outside > 0.0 { to_outside } else { -to_inside }
            })
            .collect()
    }

    /// The table with numbers at the nodes that have none: those that make the sum of all squared third differences along the axes
    /// least (of lower order on axes of fewer than four nodes), so that the splines run on smoothly over the boundary.
    pub fn continued(&self, grid: &SplineGrid, table: &[Option<[f64; 6]>]) -> Vec<[f64; 6]> {
        let mut values: Vec<[f64; 6]> = table.iter().map(|entry| entry.unwrap_or_default()).collect();
        let unknown: Vec<usize> = self.outside().collect();
        if unknown.is_empty() {
            return values;
        }
        let stencils = stencils(grid);
        for output in 0..6 {
            let mut x: Vec<f64> = values.iter().map(|entry| entry[output]).collect();
            minimise(&stencils, &self.stable, &mut x);
            for node in &unknown {
                values[*node][output] = x[*node];
            }
        }
        values
    }
}

/// Nodes at the corners of a cell.
fn corners(grid: &SplineGrid, corner: &[usize]) -> impl Iterator<Item = usize> {
    let (axes, strides) = (grid.axes(), grid.strides());
    let base: usize = corner.iter().zip(strides).map(|(place, stride)| place * stride).sum();
    (0..1usize << axes.len()).map(move |bits| {
        let step = |axis: usize| if axes[axis].nodes().len() > 1 { strides[axis] } else { 0 };
        base + (0..axes.len()).map(|axis| (bits >> axis & 1) * step(axis)).sum::<usize>()
    })
}

/// The scaled differences along every line of a grid: first node, step to the next, weights.
struct Stencil {
    first: usize,
    stride: usize,
    weights: Vec<f64>,
}

fn stencils(grid: &SplineGrid) -> Vec<Stencil> {
    let mut stencils = Vec::new();
    for (axis, stride) in grid.axes().iter().zip(grid.strides()) {
        let nodes = axis.nodes();
        let order = 3.min(nodes.len() - 1);
        let mean = (nodes[nodes.len() - 1] - nodes[0]) / nodes.len().max(2) as f64;
        for node in 0..grid.node_count() {
            let place = node / stride % nodes.len();
            if order == 0 || place + order >= nodes.len() {
                continue;
            }
            // Divided difference: sum of f_i over the product of (x_i - x_j), j other than i.
            let group = &nodes[place..=place + order];
            let weights = group
                .iter()
                .map(|x| {
                    let product: f64 = group.iter().filter(|y| *y != x).map(|y| (x - y) / mean).product();
                    1.0 / product
                })
                .collect();
            stencils.push(Stencil { first: node, stride: *stride, weights });
        }
    }
    stencils
}

/// Gradient of half the sum of squared differences, at the unknown nodes; zero elsewhere.
fn gradient(stencils: &[Stencil], known: &[bool], x: &[f64]) -> Vec<f64> {
    let mut gradient = vec![0.0; x.len()];
    for Stencil { first, stride, weights } in stencils {
        let difference: f64 = weights.iter().enumerate().map(|(k, w)| w * x[first + k * stride]).sum();
        for (k, weight) in weights.iter().enumerate() {
            gradient[first + k * stride] += weight * difference;
        }
    }
    for (value, known) in gradient.iter_mut().zip(known) {
        if *known {
            *value = 0.0;
        }
    }
    gradient
}

/// Conjugate gradients over the unknown nodes.
fn minimise(stencils: &[Stencil], known: &[bool], x: &mut [f64]) {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut residual: Vec<f64> = gradient(stencils, known, x).into_iter().map(|g| -g).collect();
    let mut direction = residual.clone();
    let mut square = dot(&residual, &residual);
    let enough = TOLERANCE * TOLERANCE * square;
    for _ in 0..STEPS {
        if square <= enough || square == 0.0 {
            return;
        }
        let image = gradient(stencils, known, &direction);
        let curvature = dot(&direction, &image);
        if curvature <= 0.0 {
            return;
        }
        let step = square / curvature;
        for ((x, r), (d, i)) in x.iter_mut().zip(&mut residual).zip(direction.iter().zip(&image)) {
            *x += step * d;
            *r -= step * i;
        }
        let next = dot(&residual, &residual);
        for (d, r) in direction.iter_mut().zip(&residual) {
            *d = r + next / square * *d;
        }
        square = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpolation::grid;

    fn square() -> SplineGrid {
        grid(vec![vec![0.0, 1.0, 2.0, 4.0, 5.0], vec![0.0, 1.0, 2.0, 3.0, 5.0]]).unwrap()
    }

    /// All nodes but those at and above (place, place) on both axes.
    fn corner_missing(from: usize) -> Vec<bool> {
        (0..25).map(|node| node / 5 < from || node % 5 < from).collect()
    }

    #[test]
    fn a_parabola_is_continued_as_it_is() {
        let grid = square();
        let stable = corner_missing(3);
        let function = |node: usize| {
            let (x, y) = (grid.axes()[0].nodes()[node / 5], grid.axes()[1].nodes()[node % 5]);
            let value = 1.0 + x - 0.5 * y * y + 0.25 * x * x + x * y + 0.1 * x * x * y;
            [value, -value, 0.0, x, y, 2.0]
        };
        let table: Vec<_> =
            stable.iter().enumerate().map(|(k, stable)| stable.then(|| function(k))).collect();
        let region = StableRegion::new(&grid, stable);
        assert_eq!(region.outside().collect::<Vec<_>>(), [18, 19, 23, 24]);
        for (node, values) in region.continued(&grid, &table).into_iter().enumerate() {
            for (value, exact) in values.into_iter().zip(function(node)) {
                assert!((value - exact).abs() < 1e-8, "{node}: {value} for {exact}");
            }
        }
    }

    #[test]
    fn clearance_is_the_distance_to_the_nearest_cell_without() {
        let grid = square();
        let region = StableRegion::new(&grid, corner_missing(3));
        assert!(region.has_cell());
        let clearance = region.clearance(&grid);
        // The cells without begin at (2, 2).
        assert_eq!(clearance[0], 2.0);
        assert_eq!(clearance[2 * 5 + 2], 0.0);
        assert_eq!(clearance[4 * 5 + 1], 1.0);
        assert_eq!(clearance[4 * 5], 2.0);
        // At (5, 5): three to x = 2.
        assert_eq!(clearance[24], -3.0);
        assert!(StableRegion::new(&grid, vec![true; 25]).clearance(&grid).is_empty());
        assert!(!StableRegion::new(&grid, corner_missing(1)).has_cell());
    }
}
