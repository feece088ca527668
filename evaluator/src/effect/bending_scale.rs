//! How far a module bends for a given imbalance of its FREEs, against the base model: moment arms, the FREEs' grip on each other and on the
//! plates. Bend and sideways position of the pose chart are scaled by `1 + g`; the height follows as that of an arc of constant curvature,
//! `z -> z c((1 + g) b)/c(b)` with `b` the bend and `c(b) = sin(b)/b` the height of an arc over its length.
//!
//! The direction of bending, twist and stretch are left alone. No state.

use super::Parameter;
use crate::Real;

/// `change`: g, without unit.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    name: "change",
    unit: 1.0,
    neutral: 0.0,
    start: 0.0,
    lower: -0.8,
    upper: 3.0,
    scale: 0.05,
}];

/// Height over length of an arc of a squared bend (rad^2): sin(b)/b.
fn height<T: Real>(square: T) -> T {
    // Up to a tenth of a radian by the series in b^2, whose next term is below 1e-17.
    if square < T::constant(1e-2) {
        let terms = [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0];
        terms.into_iter().rev().fold(T::ZERO, |sum, term| sum * square + T::constant(term))
    } else {
        let bend = square.sqrt();
        bend.sin() / bend
    }
}

/// The chart (twist, bend x, bend y; x, y, z) of the module that bends more.
pub(super) fn chart<T: Real, D: Real + From<T>>(values: &[T], [twist, bx, by, x, y, z]: [D; 6]) -> [D; 6] {
    let factor = D::from(T::ONE + values[0]);
    let square = bx * bx + by * by;
    let height = z * height(factor * factor * square) / height(square);
    [twist, factor * bx, factor * by, factor * x, factor * y, height]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_bent_further_keeps_its_length() {
        let length = 0.175;
        let arc =
            |bend: f64| [0.3, 0.0, bend, length * (1.0 - bend.cos()) / bend, 0.0, length * bend.sin() / bend];
        let bent = chart(&[0.5], arc(0.2));
        assert!((bent[2] - 0.3).abs() < 1e-15);
        assert!((bent[5] - arc(0.3)[5]).abs() < 1e-15);
        // Sideways the chart is scaled evenly; an arc's own law differs by the next order of the bend, (0.3^2 - 0.2^2)/12 here.
        assert!((bent[3] / arc(0.3)[3] - 1.0).abs() < 5e-3);
    }

    #[test]
    fn a_straight_module_stays_straight() {
        let straight = [1.0, 0.0, 0.0, 0.0, 0.0, 0.18];
        assert_eq!(chart(&[0.4], straight), straight);
    }

    #[test]
    fn series_and_closed_form_meet() {
        for square in [9.999e-3, 1.0001e-2] {
            let bend = f64::sqrt(square);
            assert!((height(square) - bend.sin() / bend).abs() < 1e-15);
        }
    }
}
