use super::{newton::SolidSolver, state::SolidState};
use nalgebra::Vector3;

/// What a state looks like: cap to cap, and over the middle 20 % of the length, away from the caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation {
    /// Height of the cap over the base per reference length.
    pub stretch_total: f64,
    /// Axial stretch of the middle.
    pub stretch_mid: f64,
    /// Twist from base to cap per reference length, rad/m, counter-clockwise seen from the tip looking back.
    pub twist_total: f64,
    /// Twist per reference length of the middle, rad/m.
    pub twist_mid: f64,
    /// Radius of the bore of equal area in the middle over its reference.
    pub bore_mid: f64,
    /// Outer radius of equal area in the middle over its reference: b/B.
    pub expansion_mid: f64,
    /// Least and greatest distance of an outer node from the axis in the middle, over B: valley and crest.
    pub outer_range_mid: [f64; 2],
}

impl SolidSolver {
    /// Measures a state. Twist and radii are taken about the planes' middles along z: meant for FREEs that stay about straight.
    pub fn deformation(&self, state: &SolidState) -> Deformation {
        let grid = &self.body.grid;
        let tube = self.body.specimen.tube;
        let [ni, nj, nk] = grid.lines;
        let own = if grid.sectors > 1 { nj - 1 } else { nj };
        let middle = |positions: &[[f64; 3]], k: usize| -> Vector3<f64> {
            let sum: Vector3<f64> =
                positions[k * ni * nj..(k + 1) * ni * nj].iter().map(|at| Vector3::from(*at)).sum();
            let mean = sum / (ni * nj) as f64;
            if grid.sectors > 1 { Vector3::new(0.0, 0.0, mean.z) } else { mean }
        };
        let middles: Vec<Vector3<f64>> = (0..nk).map(|k| middle(&state.positions, k)).collect();
        let arm = |positions: &[[f64; 3]], center: Vector3<f64>, i: usize, j: usize, k: usize| {
            let at = positions[grid.point(i, j, k) as usize];
            [at[0] - center.x, at[1] - center.y]
        };
        // Mean turn of each plane against the one below it.
        let turns: Vec<f64> = (1..nk)
            .map(|k| {
                let mut sum = 0.0;
                for j in 0..own {
                    for i in 0..ni {
                        let between = |positions: &[[f64; 3]], low: Vector3<f64>, high: Vector3<f64>| {
                            let [x, y] = arm(positions, low, i, j, k - 1);
                            let [u, v] = arm(positions, high, i, j, k);
                            (x * v - y * u).atan2(x * u + y * v)
                        };
                        let none = Vector3::zeros();
                        sum += between(&state.positions, middles[k - 1], middles[k])
                            - between(&grid.points, none, none);
                    }
                }
                sum / (own * ni) as f64
            })
            .collect();
        let height = |k: usize| grid.points[k * ni * nj][2];
        let (low, high) = (
            (0..nk).rev().find(|&k| height(k) <= 0.4 * tube.length * (1.0 + 1e-9)).unwrap_or(0),
            (0..nk).find(|&k| height(k) >= 0.6 * tube.length * (1.0 - 1e-9)).unwrap_or(nk - 1),
        );
        let span = height(high) - height(low);
        let [mut bore, mut reference_bore, mut area, mut reference_area] = [0.0; 4];
        let mut range = [f64::INFINITY, 0.0f64];
        for (k, center) in middles.iter().enumerate().take(high + 1).skip(low) {
            for j in 0..own {
                let [x, y] = arm(&state.positions, *center, ni - 1, j, k);
                range = [range[0].min(x.hypot(y)), range[1].max(x.hypot(y))];
            }
            for element in 0..grid.elements[1] {
                // Points crowd under the fibres, in the valleys: a mean over points would say too little.
                let line = |positions: &[[f64; 3]], center: Vector3<f64>, i: usize| {
                    area_under([0, 1, 2].map(|n| arm(positions, center, i, 2 * element + n, k)))
                };
                bore += line(&state.positions, *center, 0);
                reference_bore += line(&grid.points, Vector3::zeros(), 0);
                area += line(&state.positions, *center, ni - 1);
                reference_area += line(&grid.points, Vector3::zeros(), ni - 1);
            }
        }
        let outer = tube.outer_radius() + self.body.specimen.coat.map_or(0.0, |coat| coat.thickness);
        Deformation {
            stretch_total: state.cap.z / tube.length,
            stretch_mid: (middles[high].z - middles[low].z) / span,
            twist_total: turns.iter().sum::<f64>() / tube.length,
            twist_mid: turns[low..high].iter().sum::<f64>() / span,
            bore_mid: (bore / reference_bore).sqrt(),
            expansion_mid: (area / reference_area).sqrt(),
            outer_range_mid: range.map(|radius| radius / outer),
        }
    }
}

/// Area between the origin and the parabola through three points: `1/2 integral (x dy - y dx)`.
fn area_under([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    (4.0 * cross(a, b) + 4.0 * cross(b, c) - cross(a, c)) / 6.0
}
