use crate::{Axis, DEGREE, Real};
use core::{array, fmt};

/// Greatest number of axes of a spline.
pub const MAX_AXES: usize = 8;

/// A point outside the box of a spline's nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutsideGrid<T> {
    /// Which coordinate.
    pub axis: usize,
    /// Its value.
    pub value: T,
    /// First node.
    pub lower: T,
    /// Last node.
    pub upper: T,
}

impl<T: fmt::Display> fmt::Display for OutsideGrid<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let OutsideGrid { axis, value, lower, upper } = self;
        write!(f, "coordinate {} is {value}, outside {lower} to {upper}", axis + 1)
    }
}

impl<T: fmt::Debug + fmt::Display> core::error::Error for OutsideGrid<T> {}

/// The axes of a table and where its entries stand, last axis fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineGrid<T, R> {
    axes: [Axis<T, R>; MAX_AXES],
    strides: [usize; MAX_AXES],
    dimension: usize,
    node_count: usize,
}

/// The B-splines of one axis at a point.
#[derive(Clone, Copy, Debug, Default)]
struct AxisBasis<T> {
    /// Place of the first coefficient, along this axis alone.
    offset: usize,
    stride: usize,
    functions: usize,
    values: [T; DEGREE + 1],
    slopes: [T; DEGREE + 1],
}

/// The B-splines of all axes at a point: what every table on the same grid shares.
#[derive(Clone, Copy, Debug)]
pub struct PointBasis<T> {
    axes: [AxisBasis<T>; MAX_AXES],
    dimension: usize,
}

impl<T: Real, R: AsRef<[T]> + Default> SplineGrid<T, R> {
    /// A grid of 1 to [`MAX_AXES`] axes; `None` for another number, or where the nodes are too many to count.
    pub fn new(axes: impl IntoIterator<Item = Axis<T, R>>) -> Option<Self> {
        let mut given = axes.into_iter();
        let mut dimension = 0;
        let axes = array::from_fn(|_| {
            let axis = given.next();
            dimension += usize::from(axis.is_some());
            axis.unwrap_or_default()
        });
        if dimension == 0 || given.next().is_some() {
            return None;
        }
        let mut strides = [1; MAX_AXES];
        let mut node_count = 1usize;
        for (stride, axis) in strides[..dimension].iter_mut().zip(&axes).rev() {
            *stride = node_count;
            node_count = node_count.checked_mul(axis.nodes().len())?;
        }
        Some(SplineGrid { axes, strides, dimension, node_count })
    }
}

impl<T: Real, R: AsRef<[T]>> SplineGrid<T, R> {
    /// The axes.
    pub fn axes(&self) -> &[Axis<T, R>] {
        &self.axes[..self.dimension]
    }

    /// Distance in a table between neighbours along each axis.
    pub fn strides(&self) -> &[usize] {
        &self.strides[..self.dimension]
    }

    /// Number of nodes in all, which is also the number of coefficients.
    pub fn node_count(&self) -> usize {
        self.node_count
    }

    /// The first coordinate that lies outside, or is not a number.
    ///
    /// # Panics
    /// When the point does not have one coordinate per axis.
    pub fn check(&self, point: &[T]) -> Result<(), OutsideGrid<T>> {
        assert_eq!(point.len(), self.dimension, "a point has one coordinate per axis");
        for (index, (axis, value)) in self.axes().iter().zip(point).enumerate() {
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
    #[inline]
    pub fn locate(&self, point: &[T]) -> Result<PointBasis<T>, OutsideGrid<T>> {
        self.check(point)?;
        let mut basis = PointBasis { axes: [AxisBasis::default(); MAX_AXES], dimension: self.dimension };
        for (axis, (into, x)) in basis.axes.iter_mut().zip(point).enumerate() {
            *into = self.along(axis, *x);
        }
        Ok(basis)
    }

    /// The B-splines of one axis.
    #[inline]
    fn along(&self, axis: usize, x: T) -> AxisBasis<T> {
        let stride = self.strides[axis];
        let (first, values, slopes) = self.axes[axis].values_and_slopes(x);
        let functions = self.axes[axis].degree() + 1;
        AxisBasis { offset: first * stride, stride, functions, values, slopes }
    }

    /// Value and gradient of one table at a point inside, with room for no more axes than the point has.
    ///
    /// # Panics
    /// When the point, the gradient or the coefficients are not the grid's.
    #[inline]
    pub(crate) fn value_and_gradient<const AXES: usize, const OUT: usize>(
        &self,
        coefficients: &[[T; OUT]],
        point: &[T; AXES],
        value: &mut [T; OUT],
        gradient: &mut [[T; OUT]],
    ) -> Result<(), OutsideGrid<T>> {
        self.check(point)?;
        let axes: [AxisBasis<T>; AXES] = array::from_fn(|axis| self.along(axis, point[axis]));
        contract(&axes, coefficients, 0, value, gradient);
        Ok(())
    }

    /// As [`SplineGrid::locate`], of the mixed partial derivative of the given order along each axis (0 = not differentiated): its
    /// values are what [`PointBasis::value`] sums.
    ///
    /// # Panics
    /// When the point or the orders are not as many as there are axes.
    pub fn locate_partial(&self, point: &[T], orders: &[usize]) -> Result<PointBasis<T>, OutsideGrid<T>> {
        assert_eq!(orders.len(), self.dimension, "there is one order per axis");
        let mut basis = self.locate(point)?;
        for (((axis, x), order), into) in self.axes().iter().zip(point).zip(orders).zip(&mut basis.axes) {
            into.values = axis.derivatives(*x, *order).1;
        }
        Ok(basis)
    }
}

#[inline]
fn add_scaled<T: Real, const OUT: usize>(into: &mut [T; OUT], factor: T, from: &[T; OUT]) {
    for (sum, value) in into.iter_mut().zip(from) {
        *sum += factor * *value;
    }
}

impl<T: Real> PointBasis<T> {
    /// Value of the spline with these coefficients, and `gradient[axis]` = its derivatives along each axis.
    ///
    /// # Panics
    /// When the coefficients are not those of the basis's grid, or `gradient` is not as long as there are axes.
    #[inline]
    pub fn value_and_gradient<const OUT: usize>(
        &self,
        coefficients: &[[T; OUT]],
        value: &mut [T; OUT],
        gradient: &mut [[T; OUT]],
    ) {
        contract(&self.axes[..self.dimension], coefficients, 0, value, gradient);
    }

    /// Value alone of the spline with these coefficients.
    ///
    /// # Panics
    /// When the coefficients are not those of the basis's grid.
    #[inline]
    pub fn value<const OUT: usize>(&self, coefficients: &[[T; OUT]]) -> [T; OUT] {
        contract_value(&self.axes[..self.dimension], coefficients, 0)
    }
}

/// Functions of a cubic axis on a span.
const CUBIC: usize = DEGREE + 1;

#[inline(always)]
fn sum_entries<T: Real, const OUT: usize>(axis: &AxisBasis<T>, entries: &[[T; OUT]]) -> ([T; OUT], [T; OUT]) {
    let (mut value, mut slope) = ([T::ZERO; OUT], [T::ZERO; OUT]);
    for ((entry, b), db) in entries.iter().zip(axis.values).zip(axis.slopes) {
        add_scaled(&mut value, b, entry);
        add_scaled(&mut slope, db, entry);
    }
    (value, slope)
}

/// Value and slope along the last axis, whose coefficients are contiguous.
#[inline(always)]
fn line<T: Real, const OUT: usize>(
    axis: &AxisBasis<T>,
    coefficients: &[[T; OUT]],
    start: usize,
) -> ([T; OUT], [T; OUT]) {
    let entries = &coefficients[start..start + axis.functions];
    // Of a length that is known when it is compiled, the sums stay in registers.
    match entries.first_chunk::<CUBIC>() {
        Some(cubic) => sum_entries(axis, cubic),
        None => sum_entries(axis, entries),
    }
}

/// Value and slopes along the two last axes.
#[inline(always)]
fn plane<T: Real, const OUT: usize>(
    [first, last]: [&AxisBasis<T>; 2],
    coefficients: &[[T; OUT]],
    start: usize,
) -> [[T; OUT]; 3] {
    let mut sums = [[T::ZERO; OUT]; 3];
    for (function, (b, db)) in first.values.into_iter().zip(first.slopes).take(first.functions).enumerate() {
        let (value, slope) = line(last, coefficients, start + function * first.stride);
        add_scaled(&mut sums[0], b, &value);
        add_scaled(&mut sums[1], db, &value);
        add_scaled(&mut sums[2], b, &slope);
    }
    sums
}

/// Value and slopes along the three last axes; nearly all of the time goes here.
#[inline]
fn volume<T: Real, const OUT: usize>(
    [first, second, last]: [&AxisBasis<T>; 3],
    coefficients: &[[T; OUT]],
    start: usize,
) -> [[T; OUT]; 4] {
    let mut sums = [[T::ZERO; OUT]; 4];
    for (function, (b, db)) in first.values.into_iter().zip(first.slopes).take(first.functions).enumerate() {
        let [value, by_second, by_last] =
            plane([second, last], coefficients, start + function * first.stride);
        add_scaled(&mut sums[0], b, &value);
        add_scaled(&mut sums[1], db, &value);
        add_scaled(&mut sums[2], b, &by_second);
        add_scaled(&mut sums[3], b, &by_last);
    }
    sums
}

/// Sums over the axes from the last to the first: v = sum_j B_j v_j, dv/dx = sum_j B'_j v_j, and the derivatives along later
/// axes are summed like values. All partial sums are on the stack.
fn contract<T: Real, const OUT: usize>(
    axes: &[AxisBasis<T>],
    coefficients: &[[T; OUT]],
    offset: usize,
    value: &mut [T; OUT],
    gradient: &mut [[T; OUT]],
) {
    match axes {
        [] => *value = coefficients[offset],
        [axis] => (*value, gradient[0]) = line(axis, coefficients, offset + axis.offset),
        [first, last] => {
            let sums = plane([first, last], coefficients, offset + first.offset + last.offset);
            *value = sums[0];
            gradient.copy_from_slice(&sums[1..]);
        }
        [first, second, last] => {
            let start = offset + first.offset + second.offset + last.offset;
            let sums = volume([first, second, last], coefficients, start);
            *value = sums[0];
            gradient.copy_from_slice(&sums[1..]);
        }
        [axis, rest @ ..] => {
            *value = [T::ZERO; OUT];
            gradient.fill([T::ZERO; OUT]);
            let mut inner = [T::ZERO; OUT];
            let mut inner_gradient = [[T::ZERO; OUT]; MAX_AXES];
            let inner_gradient = &mut inner_gradient[..rest.len()];
            for function in 0..axis.functions {
                let from = offset + axis.offset + function * axis.stride;
                contract(rest, coefficients, from, &mut inner, inner_gradient);
                add_scaled(value, axis.values[function], &inner);
                add_scaled(&mut gradient[0], axis.slopes[function], &inner);
                for (into, from) in gradient[1..].iter_mut().zip(inner_gradient.iter()) {
                    add_scaled(into, axis.values[function], from);
                }
            }
        }
    }
}

fn contract_value<T: Real, const OUT: usize>(
    axes: &[AxisBasis<T>],
    coefficients: &[[T; OUT]],
    offset: usize,
) -> [T; OUT] {
    let mut value = [T::ZERO; OUT];
    let Some((axis, rest)) = axes.split_first() else { return coefficients[offset] };
    let start = offset + axis.offset;
    for function in 0..axis.functions {
        let inner = contract_value(rest, coefficients, start + function * axis.stride);
        add_scaled(&mut value, axis.values[function], &inner);
    }
    value
}
