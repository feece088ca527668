use crate::Real;

/// Greatest degree of the splines.
pub const DEGREE: usize = 3;

/// Numbers that one span of an axis takes: polynomials of [`DEGREE`] for as many B-splines.
const PER_SPAN: usize = (DEGREE + 1) * (DEGREE + 1);

/// One axis of a tensor-product spline: its nodes, and the B-splines that interpolate on them. `R` holds numbers `T`.
///
/// The degree is min(3, nodes - 1). A cubic axis is not-a-knot: its knots are the end nodes (fourfold) and every node between but
/// the second and the last but one, so that as many functions as nodes remain and no slope has to be invented at the ends.
/// On each span every B-spline is kept as one polynomial in s = (x - b)/width, b the span's beginning, width that of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Axis<T, R> {
    nodes: R,
    /// `[span][function][power]`; function `f` of span `k` is B-spline `k + f`.
    pieces: R,
    /// 1/width; zero for an axis of a single node.
    scale: T,
    degree: usize,
}

impl<T: Real, R: AsRef<[T]>> Axis<T, R> {
    /// An axis from its nodes, which must rise, and the polynomials of its spans; `None` where they do not fit each other.
    pub fn new(nodes: R, pieces: R) -> Option<Self> {
        let count = nodes.as_ref().len();
        let degree = count.checked_sub(1)?.min(DEGREE);
        let rising = nodes.as_ref().windows(2).all(|pair| pair[0] < pair[1]);
        let finite = nodes.as_ref().iter().chain(pieces.as_ref()).all(|number| number.is_finite());
        if !rising || !finite || pieces.as_ref().len() != (count - degree).max(1) * PER_SPAN {
            return None;
        }
        let width = nodes.as_ref()[count - 1] - nodes.as_ref()[0];
        let scale = if degree == 0 { T::ZERO } else { T::ONE / width };
        scale.is_finite().then_some(Axis { nodes, pieces, scale, degree })
    }

    /// The nodes, rising.
    pub fn nodes(&self) -> &[T] {
        self.nodes.as_ref()
    }

    /// The polynomials of the spans.
    pub fn pieces(&self) -> &[T] {
        self.pieces.as_ref()
    }

    /// Least and greatest coordinate.
    pub fn range(&self) -> (T, T) {
        let nodes = self.nodes.as_ref();
        (nodes[0], nodes[nodes.len() - 1])
    }

    /// Degree of the polynomials.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Index of the span that holds `x`, s there, and the span's polynomials.
    #[inline]
    fn locate(&self, x: T) -> (usize, T, &[[T; DEGREE + 1]]) {
        let nodes = self.nodes.as_ref();
        // Knots inside a cubic axis: all nodes but two at either end. Other axes have a single span.
        let inner = if self.degree == DEGREE { &nodes[2..nodes.len() - 2] } else { &nodes[..0] };
        let span = inner.partition_point(|knot| *knot <= x);
        let begin = if span == 0 { nodes[0] } else { inner[span - 1] };
        let pieces = &self.pieces.as_ref()[span * PER_SPAN..(span + 1) * PER_SPAN];
        (span, (x - begin) * self.scale, pieces.as_chunks().0)
    }

    /// First non-zero B-spline at `x`, the values of the `degree + 1` of them, and their derivatives with respect to x.
    #[inline]
    pub fn values_and_slopes(&self, x: T) -> (usize, [T; DEGREE + 1], [T; DEGREE + 1]) {
        let (span, s, pieces) = self.locate(x);
        let (two, three) = (T::constant(2.0), T::constant(3.0));
        let mut values = [T::ZERO; DEGREE + 1];
        let mut slopes = [T::ZERO; DEGREE + 1];
        for ((value, slope), [a, b, c, d]) in values.iter_mut().zip(&mut slopes).zip(pieces) {
            *value = ((*d * s + *c) * s + *b) * s + *a;
            *slope = ((three * *d * s + two * *c) * s + *b) * self.scale;
        }
        (span, values, slopes)
    }

    /// First non-zero B-spline at `x` and the `order`-th derivatives of the `degree + 1` of them. On a knot the third derivative is
    /// the one from above.
    pub fn derivatives(&self, x: T, order: usize) -> (usize, [T; DEGREE + 1]) {
        let (span, s, pieces) = self.locate(x);
        let mut values = [T::ZERO; DEGREE + 1];
        for (value, polynomial) in values.iter_mut().zip(pieces) {
            for n in (order..=DEGREE).rev() {
                // d^m/ds^m of s^n is n!/(n-m)! s^(n-m).
                let factor: usize = (n - order + 1..=n).product();
                *value = *value * s + T::constant(factor as f64) * polynomial[n];
            }
            for _ in 0..order {
                *value *= self.scale;
            }
        }
        (span, values)
    }
}
