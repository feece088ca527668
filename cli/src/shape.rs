//! The shape of a module for a viewer: smooth curves between the plates that leave both at right angles. A picture, not a
//! computation: the poses of the plates are the model's, what lies between is drawn.

use actuator::{Module, TipPose};
use record::{Shape, Strand};

/// Points of a curve.
const POINTS: usize = 17;
/// Colours of the FREEs, as in the charts.
const COLOURS: [[f32; 3]; 4] = [[0.0, 0.45, 0.7], [0.84, 0.37, 0.0], [0.0, 0.62, 0.45], [0.8, 0.47, 0.65]];

/// The module with its tip plate at a pose.
pub fn of(module: &Module, pose: &TipPose) -> Shape {
    let strand = |(i, placed): (usize, &actuator::PlacedFree)| {
        let [x, y] = placed.position;
        let start = [x, y, 0.0];
        let offset = pose.rotation * nalgebra::Vector3::from(start);
        let end = pose.position + offset;
        let length = placed.free.tube.length;
        let leave = [0.0, 0.0, length];
        let arrive = pose.rotation * nalgebra::Vector3::from(leave);
        let point = |k: usize| {
            let t = k as f64 / (POINTS - 1) as f64;
            let (t2, t3) = (t * t, t * t * t);
            let weights = [2.0 * t3 - 3.0 * t2 + 1.0, t3 - 2.0 * t2 + t, 3.0 * t2 - 2.0 * t3, t3 - t2];
            std::array::from_fn(|axis| {
                weights[0] * start[axis]
                    + weights[1] * leave[axis]
                    + weights[2] * end[axis]
                    + weights[3] * arrive[axis]
            })
        };
        Strand {
            points: (0..POINTS).map(point).collect(),
            width: 2.0 * placed.free.tube.outer_radius(),
            color: COLOURS[i % COLOURS.len()],
        }
    };
    let reach = |placed: &actuator::PlacedFree| {
        placed.position[0].hypot(placed.position[1]) + placed.free.tube.outer_radius()
    };
    let radius = module.frees.iter().map(reach).fold(0.0, f64::max);
    let thickness = 0.1 * radius;
    Shape {
        strands: module.frees.iter().enumerate().map(strand).collect(),
        plates: vec![
            ([0.0; 3], [1.0, 0.0, 0.0, 0.0], radius, thickness),
            (pose.position.into(), pose.wxyz(), radius, thickness),
        ],
    }
}
