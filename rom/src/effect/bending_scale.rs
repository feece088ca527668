//! How far a module bends for a given imbalance of its FREEs, against the base model: moment arms, the FREEs' grip on each other and on the
//! plates. Bend and sideways position of the pose chart are scaled by `1 + g`; the height follows as that of an arc of constant curvature,
//! `z -> z c((1 + g) b)/c(b)` with `b` the bend and `c(b) = sin(b)/b` the height of an arc over its length.
//!
//! The direction of bending, twist and stretch are left alone. No state.

use super::Parameter;
use actuator::PoseChart;

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

/// Height over length of an arc of a bend (rad).
fn height(bend: f64) -> f64 {
    // The series where the quotient would lose digits: the next term is bend^4/120.
    if bend.abs() < 1e-4 { 1.0 - bend * bend / 6.0 } else { bend.sin() / bend }
}

/// The chart of the module that bends more.
pub(super) fn chart(values: &[f64], chart: &PoseChart) -> PoseChart {
    let factor = 1.0 + values[0];
    let bend = chart.bend[0].hypot(chart.bend[1]);
    let [x, y, z] = chart.position;
    PoseChart {
        twist: chart.twist,
        bend: chart.bend.map(|bend| factor * bend),
        position: [factor * x, factor * y, z * height(factor * bend) / height(bend)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_bent_further_keeps_its_length() {
        let length = 0.175;
        let arc = |bend: f64| PoseChart {
            twist: 0.3,
            bend: [0.0, bend],
            position: [length * (1.0 - bend.cos()) / bend, 0.0, length * bend.sin() / bend],
        };
        let bent = chart(&[0.5], &arc(0.2));
        assert!((bent.bend[1] - 0.3).abs() < 1e-15);
        assert!((bent.position[2] - arc(0.3).position[2]).abs() < 1e-15);
        // Sideways the chart is scaled evenly; an arc's own law differs by the next order of the bend, (0.3^2 - 0.2^2)/12 here.
        assert!((bent.position[0] / arc(0.3).position[0] - 1.0).abs() < 5e-3);
    }

    #[test]
    fn a_straight_module_stays_straight() {
        let straight = PoseChart { twist: 1.0, bend: [0.0; 2], position: [0.0, 0.0, 0.18] };
        assert_eq!(chart(&[0.4], &straight), straight);
    }
}
