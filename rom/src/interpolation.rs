//! Interpolation on tensor-product splines: from the values at the nodes to the coefficients that the evaluator sums.

use evaluator::{Axis, DEGREE, MAX_AXES};
use nalgebra::DMatrix;

/// An axis that owns its numbers.
pub type SplineAxis = Axis<f64, Vec<f64>>;
/// A grid that owns its numbers.
pub type SplineGrid = evaluator::SplineGrid<f64, Vec<f64>>;
/// A spline that owns its numbers.
pub type TensorSpline<const OUT: usize> = evaluator::TensorSpline<f64, Vec<f64>, OUT>;

/// Why a spline cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Fewer than one or more than [`MAX_AXES`] axes, or more nodes than can be counted.
    #[error("a spline has 1 to {MAX_AXES} axes of a countable number of nodes, not {count}")]
    Axes {
        /// Number of axes asked for.
        count: usize,
    },
    /// An axis without nodes.
    #[error("axis {} has no nodes", axis + 1)]
    EmptyAxis {
        /// Which axis.
        axis: usize,
    },
    /// Nodes must rise, by more than a millionth of a millionth of the axis.
    #[error("the nodes of axis {} must rise, but {before} is followed by {after}", axis + 1)]
    NotRising {
        /// Which axis.
        axis: usize,
        /// A node.
        before: f64,
        /// The node that follows it.
        after: f64,
    },
    /// The table does not fit the axes.
    #[error("the axes have {expected} nodes in all, but the table has {found} entries")]
    Count {
        /// Product of the axes' node counts.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// Nodes so badly spaced that rounding leaves no interpolation.
    #[error("the nodes of axis {} are too unevenly spaced to interpolate on", axis + 1)]
    Spacing {
        /// Which axis.
        axis: usize,
    },
    /// A number that is not finite.
    #[error("{what} {index} is not a finite number")]
    NotFinite {
        /// What the number is.
        what: &'static str,
        /// Its place.
        index: usize,
    },
}

/// An axis through rising, finite nodes; `index` is its number in error messages.
pub fn axis(nodes: Vec<f64>, index: usize) -> Result<SplineAxis, SplineError> {
    if nodes.is_empty() {
        return Err(SplineError::EmptyAxis { axis: index });
    }
    if let Some(place) = nodes.iter().position(|node| !node.is_finite()) {
        return Err(SplineError::NotFinite { what: "node", index: place });
    }
    let lower = nodes[0];
    let width = nodes[nodes.len() - 1] - lower;
    let scaled: Vec<f64> =
        nodes.iter().map(|node| if nodes.len() == 1 { 0.0 } else { (node - lower) / width }).collect();
    // Nodes so close that they fall together once scaled would make the interpolation singular; a falling axis would look
    // risen once scaled.
    for place in 1..nodes.len() {
        let (before, after) = (nodes[place - 1], nodes[place]);
        let rises = after > before && scaled[place] - scaled[place - 1] > 1e-12;
        if !rises {
            return Err(SplineError::NotRising { axis: index, before, after });
        }
    }
    let degree = (nodes.len() - 1).min(DEGREE);
    let mut knots = vec![0.0; degree + 1];
    knots.extend_from_slice(if degree == DEGREE { &scaled[2..scaled.len() - 2] } else { &[] });
    knots.extend(vec![1.0; degree + 1]);
    let spans = (nodes.len() - degree).max(1);
    let pieces = (0..spans).flat_map(|span| basis_polynomials(&knots, degree, span)).flatten().collect();
    SplineAxis::new(nodes, pieces).ok_or(SplineError::Spacing { axis: index })
}

/// The B-splines that live on a span, as polynomials in u - b (b the span's beginning), by the Cox-de Boor recursion
/// N[i,d] = (u - t[i])/(t[i+d] - t[i]) N[i,d-1] + (t[i+d+1] - u)/(t[i+d+1] - t[i+1]) N[i+1,d-1].
fn basis_polynomials(knots: &[f64], degree: usize, span: usize) -> [[f64; DEGREE + 1]; DEGREE + 1] {
    let last = degree + span;
    let begin = knots[last];
    let mut lower = vec![[0.0; DEGREE + 1]; degree + 2];
    // lower[f] is N[last - d + f, d]; one place more, which stays zero.
    lower[0][0] = 1.0;
    for d in 1..=degree {
        let mut raised = vec![[0.0; DEGREE + 1]; degree + 2];
        for (f, polynomial) in raised.iter_mut().enumerate().take(d + 1) {
            let i = last - d + f;
            if f > 0 {
                let width = knots[i + d] - knots[i];
                add_product(polynomial, &lower[f - 1], (begin - knots[i]) / width, 1.0 / width);
            }
            if f < d {
                let width = knots[i + d + 1] - knots[i + 1];
                add_product(polynomial, &lower[f], (knots[i + d + 1] - begin) / width, -1.0 / width);
            }
        }
        lower = raised;
    }
    let mut result = [[0.0; DEGREE + 1]; DEGREE + 1];
    result[..=degree].copy_from_slice(&lower[..=degree]);
    result
}

/// Adds `(constant + slope s) * factor(s)` to `polynomial`.
fn add_product(polynomial: &mut [f64; DEGREE + 1], factor: &[f64; DEGREE + 1], constant: f64, slope: f64) {
    for power in 0..=DEGREE {
        polynomial[power] += constant * factor[power];
        if power > 0 {
            polynomial[power] += slope * factor[power - 1];
        }
    }
}

/// A grid on the nodes of its axes.
pub fn grid(nodes: Vec<Vec<f64>>) -> Result<SplineGrid, SplineError> {
    let count = nodes.len();
    let axes = nodes
        .into_iter()
        .enumerate()
        .map(|(index, nodes)| axis(nodes, index))
        .collect::<Result<Vec<_>, _>>()?;
    SplineGrid::new(axes).ok_or(SplineError::Axes { count })
}

/// Coefficients, outputs of a node together, of the spline that takes the given values at the nodes of a grid (last axis fastest). It
/// reproduces polynomials of its degree in each coordinate.
pub fn coefficients<const OUT: usize>(
    grid: &SplineGrid,
    mut table: Vec<[f64; OUT]>,
) -> Result<Vec<f64>, SplineError> {
    check_table(grid, &table, "value of table entry")?;
    // A tensor product is interpolated axis by axis: replace every line of values by the line of its coefficients.
    for (index, (axis, stride)) in grid.axes().iter().zip(grid.strides()).enumerate() {
        let size = axis.nodes().len();
        let mut collocation = DMatrix::zeros(size, size);
        for (row, node) in axis.nodes().iter().enumerate() {
            let (first, values, _) = axis.values_and_slopes(*node);
            for function in 0..=axis.degree() {
                collocation[(row, first + function)] = values[function];
            }
        }
        let factors = collocation.lu();
        let lines: Vec<usize> = (0..grid.node_count()).filter(|entry| (entry / stride) % size == 0).collect();
        let mut right = DMatrix::zeros(size, lines.len() * OUT);
        for (column, start) in lines.iter().enumerate() {
            for row in 0..size {
                for output in 0..OUT {
                    right[(row, column * OUT + output)] = table[start + row * stride][output];
                }
            }
        }
        // In exact arithmetic it is regular: each node lies in the support of its own function (Schoenberg and Whitney).
        if !factors.solve_mut(&mut right) {
            return Err(SplineError::Spacing { axis: index });
        }
        for (column, start) in lines.iter().enumerate() {
            for row in 0..size {
                for output in 0..OUT {
                    table[start + row * stride][output] = right[(row, column * OUT + output)];
                }
            }
        }
    }
    check_table(grid, &table, "coefficient")?;
    Ok(table.into_flattened())
}

/// Whether a table has an entry per node and only finite numbers.
pub fn check_table<const OUT: usize>(
    grid: &SplineGrid,
    table: &[[f64; OUT]],
    what: &'static str,
) -> Result<(), SplineError> {
    if table.len() != grid.node_count() {
        return Err(SplineError::Count { expected: grid.node_count(), found: table.len() });
    }
    match table.iter().position(|entry| entry.iter().any(|value| !value.is_finite())) {
        Some(index) => Err(SplineError::NotFinite { what, index }),
        None => Ok(()),
    }
}

/// The spline that takes the values of the table (last axis fastest) at the nodes.
pub fn interpolate<const OUT: usize>(
    nodes: Vec<Vec<f64>>,
    table: Vec<[f64; OUT]>,
) -> Result<TensorSpline<OUT>, SplineError> {
    let grid = grid(nodes)?;
    let coefficients = coefficients(&grid, table)?;
    Ok(TensorSpline::new(grid, coefficients).expect("coefficients are as many as the grid's nodes"))
}

/// A spline from its nodes and coefficients.
pub fn from_coefficients<const OUT: usize>(
    nodes: Vec<Vec<f64>>,
    coefficients: Vec<f64>,
) -> Result<TensorSpline<OUT>, SplineError> {
    let grid = grid(nodes)?;
    let (rows, rest) = coefficients.as_chunks::<OUT>();
    if !rest.is_empty() {
        return Err(SplineError::Count { expected: (rows.len() + 1) * OUT, found: coefficients.len() });
    }
    check_table(&grid, rows, "coefficient")?;
    Ok(TensorSpline::new(grid, coefficients).expect("the coefficients were checked"))
}

#[cfg(test)]
mod tests;
