use crate::{SplineAxis, spline_axis::DEGREE};
use nalgebra::DMatrix;

/// Greatest number of axes of a spline.
pub const MAX_AXES: usize = 8;

/// Why a spline cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Fewer than one or more than [`MAX_AXES`] axes.
    #[error("a spline has 1 to {MAX_AXES} axes, not {count}")]
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

/// A point outside the box of a spline's nodes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("coordinate {} is {value}, outside {lower} to {upper}", axis + 1)]
pub struct OutsideGrid {
    /// Which coordinate.
    pub axis: usize,
    /// Its value.
    pub value: f64,
    /// First node.
    pub lower: f64,
    /// Last node.
    pub upper: f64,
}

/// The axes of a table and where its entries stand, last axis fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineGrid {
    axes: Vec<SplineAxis>,
    strides: Vec<usize>,
    count: usize,
}

/// The B-splines of one axis at a point.
#[derive(Clone, Copy, Debug, Default)]
struct AxisBasis {
    /// Place of the first coefficient, along this axis alone.
    offset: usize,
    stride: usize,
    functions: usize,
    values: [f64; DEGREE + 1],
    slopes: [f64; DEGREE + 1],
}

/// The B-splines of all axes at a point: what every table on the same grid shares.
#[derive(Clone, Copy, Debug)]
pub struct PointBasis {
    axes: [AxisBasis; MAX_AXES],
    count: usize,
}

impl SplineGrid {
    /// A grid on the nodes of its axes.
    pub fn new(nodes: Vec<Vec<f64>>) -> Result<Self, SplineError> {
        if nodes.is_empty() || nodes.len() > MAX_AXES {
            return Err(SplineError::Axes { count: nodes.len() });
        }
        let axes = nodes
            .into_iter()
            .enumerate()
            .map(|(axis, nodes)| SplineAxis::new(nodes, axis))
            .collect::<Result<Vec<_>, _>>()?;
        let mut strides = vec![1; axes.len()];
        let mut count = 1usize;
        for (stride, axis) in strides.iter_mut().zip(&axes).rev() {
            *stride = count;
            count = count.saturating_mul(axis.nodes().len());
        }
        Ok(SplineGrid { axes, strides, count })
    }

    /// The axes.
    pub fn axes(&self) -> &[SplineAxis] {
        &self.axes
    }

    /// Number of nodes in all, which is also the number of coefficients.
    pub fn node_count(&self) -> usize {
        self.count
    }

    /// The first coordinate that lies outside, or is not a number.
    ///
    /// # Panics
    /// When the point does not have one coordinate per axis.
    pub fn check(&self, point: &[f64]) -> Result<(), OutsideGrid> {
        assert_eq!(point.len(), self.axes.len(), "a point has one coordinate per axis");
        for (index, (axis, value)) in self.axes.iter().zip(point).enumerate() {
            let (lower, upper) = axis.range();
            if !(lower <= *value && *value <= upper) {
                return Err(OutsideGrid { axis: index, value: *value, lower, upper });
            }
        }
        Ok(())
    }

    /// The B-splines at a point inside, to be used with any table on this grid.
    ///
    /// # Panics
    /// When the point does not have one coordinate per axis.
    pub fn locate(&self, point: &[f64]) -> Result<PointBasis, OutsideGrid> {
        self.check(point)?;
        let mut basis = PointBasis { axes: [AxisBasis::default(); MAX_AXES], count: point.len() };
        for (((axis, stride), x), into) in self.axes.iter().zip(&self.strides).zip(point).zip(&mut basis.axes)
        {
            let (first, values, slopes) = axis.values_and_slopes(*x);
            *into = AxisBasis {
                offset: first * stride,
                stride: *stride,
                functions: axis.degree() + 1,
                values,
                slopes,
            };
        }
        Ok(basis)
    }

    /// Coefficients of the spline that takes the given values at the nodes.
    pub fn interpolate<const OUT: usize>(
        &self,
        mut table: Vec<[f64; OUT]>,
    ) -> Result<Vec<[f64; OUT]>, SplineError> {
        self.check_table(&table, "value of table entry")?;
        // A tensor product is interpolated axis by axis: replace every line of values by the line of its coefficients.
        for (index, (axis, stride)) in self.axes.iter().zip(&self.strides).enumerate() {
            let size = axis.nodes().len();
            let mut collocation = DMatrix::zeros(size, size);
            for (row, node) in axis.nodes().iter().enumerate() {
                let (first, values, _) = axis.values_and_slopes(*node);
                for function in 0..=axis.degree() {
                    collocation[(row, first + function)] = values[function];
                }
            }
            let factors = collocation.lu();
            let lines: Vec<usize> = (0..self.count).filter(|entry| (entry / stride) % size == 0).collect();
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
        self.check_table(&table, "coefficient")?;
        Ok(table)
    }

    /// Whether a table has an entry per node and only finite numbers.
    pub(crate) fn check_table<const OUT: usize>(
        &self,
        table: &[[f64; OUT]],
        what: &'static str,
    ) -> Result<(), SplineError> {
        if table.len() != self.count {
            return Err(SplineError::Count { expected: self.count, found: table.len() });
        }
        match table.iter().position(|entry| entry.iter().any(|value| !value.is_finite())) {
            Some(index) => Err(SplineError::NotFinite { what, index }),
            None => Ok(()),
        }
    }
}

impl PointBasis {
    /// Value of the spline with these coefficients, and `gradient[axis]` = its derivatives along each axis.
    ///
    /// # Panics
    /// When the coefficients are not those of the basis's grid, or `gradient` is not as long as there are axes.
    #[inline]
    pub fn value_and_gradient<const OUT: usize>(
        &self,
        coefficients: &[[f64; OUT]],
        value: &mut [f64; OUT],
        gradient: &mut [[f64; OUT]],
    ) {
        contract(&self.axes[..self.count], coefficients, 0, value, gradient);
    }

    /// Value alone of the spline with these coefficients.
    ///
    /// # Panics
    /// When the coefficients are not those of the basis's grid.
    #[inline]
    pub fn value<const OUT: usize>(&self, coefficients: &[[f64; OUT]]) -> [f64; OUT] {
        contract_value(&self.axes[..self.count], coefficients, 0)
    }
}

fn add_scaled<const OUT: usize>(into: &mut [f64; OUT], factor: f64, from: &[f64; OUT]) {
    for output in 0..OUT {
        into[output] += factor * from[output];
    }
}

/// Sums over the axes from the last to the first: v = sum_j B_j v_j, dv/dx = sum_j B'_j v_j, and the derivatives along later
/// axes are summed like values. All partial sums are on the stack.
fn contract<const OUT: usize>(
    axes: &[AxisBasis],
    coefficients: &[[f64; OUT]],
    offset: usize,
    value: &mut [f64; OUT],
    gradient: &mut [[f64; OUT]],
) {
    let (axis, rest) = axes.split_first().expect("a basis has at least one axis");
    let start = offset + axis.offset;
    *value = [0.0; OUT];
    gradient.fill([0.0; OUT]);
    if rest.is_empty() {
        // The last axis is contiguous; nearly all of the time goes here.
        let line = &coefficients[start..start + axis.functions];
        let mut slope = [0.0; OUT];
        for ((entry, b), db) in line.iter().zip(axis.values).zip(axis.slopes) {
            add_scaled(value, b, entry);
            add_scaled(&mut slope, db, entry);
        }
        gradient[0] = slope;
        return;
    }
    let mut inner = [0.0; OUT];
    let mut inner_gradient = [[0.0; OUT]; MAX_AXES];
    let inner_gradient = &mut inner_gradient[..rest.len()];
    for function in 0..axis.functions {
        contract(rest, coefficients, start + function * axis.stride, &mut inner, inner_gradient);
        add_scaled(value, axis.values[function], &inner);
        add_scaled(&mut gradient[0], axis.slopes[function], &inner);
        for (into, from) in gradient[1..].iter_mut().zip(inner_gradient.iter()) {
            add_scaled(into, axis.values[function], from);
        }
    }
}

fn contract_value<const OUT: usize>(
    axes: &[AxisBasis],
    coefficients: &[[f64; OUT]],
    offset: usize,
) -> [f64; OUT] {
    let mut value = [0.0; OUT];
    let Some((axis, rest)) = axes.split_first() else { return coefficients[offset] };
    let start = offset + axis.offset;
    for function in 0..axis.functions {
        let inner = contract_value(rest, coefficients, start + function * axis.stride);
        add_scaled(&mut value, axis.values[function], &inner);
    }
    value
}

/// A tensor-product B-spline with `OUT` outputs on a grid of 1 to [`MAX_AXES`] axes; see [`SplineAxis`] for degree and knots.
///
/// It passes through its table, reproduces polynomials of its degree in each coordinate, and is twice continuously
/// differentiable along axes of four nodes and more.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorSpline<const OUT: usize> {
    grid: SplineGrid,
    coefficients: Vec<[f64; OUT]>,
}

impl<const OUT: usize> TensorSpline<OUT> {
    /// The spline that takes the values of the table (last axis fastest) at the nodes.
    pub fn interpolate(nodes: Vec<Vec<f64>>, table: Vec<[f64; OUT]>) -> Result<Self, SplineError> {
        let grid = SplineGrid::new(nodes)?;
        let coefficients = grid.interpolate(table)?;
        Ok(TensorSpline { grid, coefficients })
    }

    /// A spline from its nodes and coefficients.
    pub fn from_coefficients(
        nodes: Vec<Vec<f64>>,
        coefficients: Vec<[f64; OUT]>,
    ) -> Result<Self, SplineError> {
        let grid = SplineGrid::new(nodes)?;
        grid.check_table(&coefficients, "coefficient")?;
        Ok(TensorSpline { grid, coefficients })
    }

    /// The grid.
    pub fn grid(&self) -> &SplineGrid {
        &self.grid
    }

    /// The coefficients, last axis fastest.
    pub fn coefficients(&self) -> &[[f64; OUT]] {
        &self.coefficients
    }

    /// Value and `gradient[axis]`, its derivatives along each axis, at a point inside the grid. Allocates nothing.
    ///
    /// # Panics
    /// When the point or the gradient is not as long as there are axes.
    pub fn evaluate(
        &self,
        point: &[f64],
        value: &mut [f64; OUT],
        gradient: &mut [[f64; OUT]],
    ) -> Result<(), OutsideGrid> {
        assert_eq!(gradient.len(), self.grid.axes.len(), "a gradient has one row per axis");
        self.grid.locate(point)?.value_and_gradient(&self.coefficients, value, gradient);
        Ok(())
    }

    /// The mixed partial derivative of the given order along each axis (0 = not differentiated); orders above the degree give
    /// zero. On a knot the third derivative is the one from above.
    ///
    /// # Panics
    /// When the point or the orders are not as many as there are axes.
    pub fn partial(&self, point: &[f64], orders: &[usize]) -> Result<[f64; OUT], OutsideGrid> {
        assert_eq!(orders.len(), self.grid.axes.len(), "there is one order per axis");
        let mut basis = self.grid.locate(point)?;
        for (((axis, x), order), into) in self.grid.axes.iter().zip(point).zip(orders).zip(&mut basis.axes) {
            into.values = axis.derivatives(*x, *order).1;
        }
        Ok(basis.value(&self.coefficients))
    }
}

#[cfg(test)]
mod tests;
