use crate::{OutsideGrid, Real, SplineGrid};

/// A tensor-product B-spline with `OUT` outputs on a grid of 1 to [`crate::MAX_AXES`] axes; see [`crate::Axis`] for degree and knots.
///
/// It is twice continuously differentiable along axes of four nodes and more. `R` holds numbers `T`.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorSpline<T, R, const OUT: usize> {
    grid: SplineGrid<T, R>,
    coefficients: R,
}

impl<T: Real, R: AsRef<[T]>, const OUT: usize> TensorSpline<T, R, OUT> {
    /// A spline from its grid and its coefficients (last axis fastest, the outputs of a node together); `None` where they are not as
    /// many as the nodes ask for, or not finite.
    pub fn new(grid: SplineGrid<T, R>, coefficients: R) -> Option<Self> {
        let expected = grid.node_count().checked_mul(OUT)?;
        let numbers = coefficients.as_ref();
        let sound = numbers.len() == expected && numbers.iter().all(|number| number.is_finite());
        sound.then_some(TensorSpline { grid, coefficients })
    }

    /// The grid.
    pub fn grid(&self) -> &SplineGrid<T, R> {
        &self.grid
    }

    /// The coefficients, last axis fastest.
    #[inline]
    pub fn coefficients(&self) -> &[[T; OUT]] {
        self.coefficients.as_ref().as_chunks().0
    }

    /// Value and `gradient[axis]`, its derivatives along each axis, at a point inside the grid.
    ///
    /// # Panics
    /// When the point or the gradient is not as long as there are axes.
    #[inline]
    pub fn evaluate(
        &self,
        point: &[T],
        value: &mut [T; OUT],
        gradient: &mut [[T; OUT]],
    ) -> Result<(), OutsideGrid<T>> {
        assert_eq!(gradient.len(), self.grid.axes().len(), "a gradient has one row per axis");
        self.grid.locate(point)?.value_and_gradient(self.coefficients(), value, gradient);
        Ok(())
    }

    /// The mixed partial derivative of the given order along each axis (0 = not differentiated); orders above the degree give
    /// zero. On a knot the third derivative is the one from above.
    ///
    /// # Panics
    /// When the point or the orders are not as many as there are axes.
    pub fn partial(&self, point: &[T], orders: &[usize]) -> Result<[T; OUT], OutsideGrid<T>> {
        Ok(self.grid.locate_partial(point, orders)?.value(self.coefficients()))
    }

    /// Second derivatives: `hessian[i * axes + j]` is the one along axes i and j.
    ///
    /// # Panics
    /// When the point is not as long as there are axes, or `hessian` not as long as their square.
    pub fn hessian(&self, point: &[T], hessian: &mut [[T; OUT]]) -> Result<(), OutsideGrid<T>> {
        let count = self.grid.axes().len();
        assert_eq!(hessian.len(), count * count, "a Hessian has an entry per pair of axes");
        for i in 0..count {
            for j in i..count {
                let mut orders = [0; crate::MAX_AXES];
                orders[i] += 1;
                orders[j] += 1;
                let entry = self.partial(point, &orders[..count])?;
                hessian[i * count + j] = entry;
                hessian[j * count + i] = entry;
            }
        }
        Ok(())
    }
}
