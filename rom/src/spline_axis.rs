use crate::SplineError;

/// Greatest degree of the splines.
pub(crate) const DEGREE: usize = 3;

/// One axis of a tensor-product spline: its nodes, and the B-splines that interpolate on them.
///
/// The degree is min(3, nodes - 1). A cubic axis is not-a-knot: its knots are the end nodes (fourfold) and every node between but
/// the second and the last but one, so that as many functions as nodes remain and no slope has to be invented at the ends.
/// Inside, the axis is scaled to u in [0, 1] and every B-spline is kept as one polynomial in u - b per span, b the span's beginning.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineAxis {
    nodes: Vec<f64>,
    degree: usize,
    /// du/dx; zero for an axis of a single node.
    scale: f64,
    /// Distinct knots in u: span `k` lies between `breaks[k]` and `breaks[k + 1]`.
    breaks: Vec<f64>,
    /// `pieces[span][function][power]`; function `f` of span `k` is B-spline `k + f`.
    pieces: Vec<[[f64; DEGREE + 1]; DEGREE + 1]>,
}

impl SplineAxis {
    /// An axis through rising, finite nodes; `axis` is its number in error messages.
    pub fn new(nodes: Vec<f64>, axis: usize) -> Result<Self, SplineError> {
        if nodes.is_empty() {
            return Err(SplineError::EmptyAxis { axis });
        }
        if let Some(index) = nodes.iter().position(|node| !node.is_finite()) {
            return Err(SplineError::NotFinite { what: "node", index });
        }
        let lower = nodes[0];
        let width = nodes[nodes.len() - 1] - lower;
        let scaled: Vec<f64> =
            nodes.iter().map(|node| if nodes.len() == 1 { 0.0 } else { (node - lower) / width }).collect();
        // Nodes so close that they fall together once scaled would make the interpolation singular; a falling axis would look
        // risen once scaled.
        for index in 1..nodes.len() {
            let (before, after) = (nodes[index - 1], nodes[index]);
            let rises = after > before && scaled[index] - scaled[index - 1] > 1e-12;
            if !rises {
                return Err(SplineError::NotRising { axis, before, after });
            }
        }
        let degree = (nodes.len() - 1).min(DEGREE);
        let interior = if degree == DEGREE { &scaled[2..scaled.len() - 2] } else { &[] };
        let mut breaks = vec![0.0];
        breaks.extend_from_slice(interior);
        breaks.push(1.0);
        let mut knots = vec![0.0; degree];
        knots.extend_from_slice(&breaks);
        knots.extend(vec![1.0; degree]);
        let pieces = (0..breaks.len() - 1).map(|span| basis_polynomials(&knots, degree, span)).collect();
        let scale = if degree == 0 { 0.0 } else { 1.0 / width };
        Ok(SplineAxis { nodes, degree, scale, breaks, pieces })
    }

    /// The nodes, rising.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Least and greatest coordinate.
    pub fn range(&self) -> (f64, f64) {
        (self.nodes[0], self.nodes[self.nodes.len() - 1])
    }

    /// Degree of the polynomials.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Index of the span that holds `x`, and the distance from its beginning, scaled.
    fn locate(&self, x: f64) -> (usize, f64) {
        let u = (x - self.nodes[0]) * self.scale;
        let span = self.breaks[1..self.breaks.len() - 1].partition_point(|knot| *knot <= u);
        (span, u - self.breaks[span])
    }

    /// First non-zero B-spline at `x`, the values of the `degree + 1` of them, and their derivatives with respect to x.
    #[inline]
    pub(crate) fn values_and_slopes(&self, x: f64) -> (usize, [f64; DEGREE + 1], [f64; DEGREE + 1]) {
        let (span, s) = self.locate(x);
        let mut values = [0.0; DEGREE + 1];
        let mut slopes = [0.0; DEGREE + 1];
        for (function, [a, b, c, d]) in self.pieces[span].iter().enumerate() {
            values[function] = ((d * s + c) * s + b) * s + a;
            slopes[function] = ((3.0 * d * s + 2.0 * c) * s + b) * self.scale;
        }
        (span, values, slopes)
    }

    /// First non-zero B-spline at `x` and the `order`-th derivatives of the `degree + 1` of them.
    pub(crate) fn derivatives(&self, x: f64, order: usize) -> (usize, [f64; DEGREE + 1]) {
        let (span, s) = self.locate(x);
        let values = self.pieces[span].map(|polynomial| {
            // d^m/ds^m of s^n is n!/(n-m)! s^(n-m).
            let term = |n: usize| ((n - order + 1)..=n).product::<usize>() as f64;
            (order..=DEGREE).rev().fold(0.0, |sum, n| sum * s + term(n) * polynomial[n])
                * self.scale.powi(order as i32)
        });
        (span, values)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_functions_are_a_partition_of_unity() {
        for count in 1..9 {
            let nodes: Vec<f64> = (0..count).map(|i| 3.0 + (i as f64).powf(1.4)).collect();
            let axis = SplineAxis::new(nodes, 0).unwrap();
            let (lower, upper) = axis.range();
            for step in 0..=50 {
                let x = lower + (upper - lower) * step as f64 / 50.0;
                let (first, values, slopes) = axis.values_and_slopes(x);
                // Sums of four numbers of size one: a few units of rounding.
                assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                assert!(slopes.iter().sum::<f64>().abs() < 1e-12);
                assert!(first + axis.degree() < count);
                assert_eq!(axis.derivatives(x, 0), (first, values));
                for (a, b) in axis.derivatives(x, 1).1.iter().zip(slopes) {
                    assert!((a - b).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn bad_nodes_are_named() {
        let message = |nodes: &[f64]| SplineAxis::new(nodes.to_vec(), 2).unwrap_err().to_string();
        assert!(message(&[]).contains("axis 3 has no nodes"));
        assert!(message(&[0.0, 1.0, 1.0]).contains("1 is followed by 1"));
        assert!(message(&[0.0, 2.0, 1.0]).contains("2 is followed by 1"));
        assert!(message(&[2.0, 1.0, 0.0]).contains("2 is followed by 1"));
        assert!(message(&[0.0, f64::NAN]).contains("node 1"));
        assert!(message(&[0.0, f64::INFINITY]).contains("node 1"));
        // A range that overflows leaves no room between the scaled nodes.
        assert!(message(&[-1e308, 0.0, 1e308]).contains("is followed by"));
    }
}
