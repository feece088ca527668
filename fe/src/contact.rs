//! Where the FREEs of a module are nearest to each other, or overlap.

use nalgebra::Vector3;

/// Where the surfaces of two FREEs of a module are nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The FREEs.
    pub frees: [usize; 2],
    /// Distance between their surfaces, m: of their centrelines, less both outer radii there. Negative where they overlap: nothing pushes
    /// them apart.
    pub gap: f64,
    /// Reference distance from the base at which they are so near, m.
    pub along: [f64; 2],
}

/// A FREE as a row of straight pieces.
pub(crate) struct Tube {
    /// Ends of the pieces, m.
    pub points: Vec<Vector3<f64>>,
    /// Outer radius of each piece, m.
    pub radii: Vec<f64>,
    /// Reference length of a piece, m.
    pub piece: f64,
}

/// Least distance of two straight pieces, and where on each (0 to 1) it is.
fn between([a, b]: [Vector3<f64>; 2], [c, d]: [Vector3<f64>; 2]) -> (f64, [f64; 2]) {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let to_other = |s: f64| ((vw + s * uv) / vv).clamp(0.0, 1.0);
    let to_own = |t: f64| ((t * uv - uw) / uu).clamp(0.0, 1.0);
    let divisor = uu * vv - uv * uv;
    let crossing = if divisor > 1e-12 * uu * vv { (uv * vw - vv * uw) / divisor } else { 0.0 };
    // The nearest of an inner pair and of those with one end fixed.
    let (t, s) = (to_other(crossing.clamp(0.0, 1.0)), to_own(to_other(crossing.clamp(0.0, 1.0))));
    let pairs = [[s, t], [0.0, to_other(0.0)], [1.0, to_other(1.0)], [to_own(0.0), 0.0], [to_own(1.0), 1.0]];
    let distance = |[s, t]: [f64; 2]| (w + u * s - v * t).norm();
    let best = pairs.into_iter().min_by(|x, y| distance(*x).total_cmp(&distance(*y))).unwrap_or([s, t]);
    (distance(best), best)
}

impl Tube {
    fn pieces(&self) -> impl Iterator<Item = ([Vector3<f64>; 2], f64)> {
        self.points.windows(2).map(|pair| [pair[0], pair[1]]).zip(self.radii.iter().copied())
    }

    /// Least gap to another tube and the places along both.
    pub fn nearest(&self, other: &Tube) -> (f64, [f64; 2]) {
        let mut found = (f64::INFINITY, [0.0; 2]);
        for (i, (own, radius)) in self.pieces().enumerate() {
            for (k, (their, other_radius)) in other.pieces().enumerate() {
                let reach = 0.5 * ((own[1] - own[0]).norm() + (their[1] - their[0]).norm());
                let middles = 0.5 * (own[0] + own[1] - their[0] - their[1]).norm();
                let radii = radius + other_radius;
                if middles - reach - radii < found.0 {
                    let (distance, [s, t]) = between(own, their);
                    if distance - radii < found.0 {
                        let along = [(i as f64 + s) * self.piece, (k as f64 + t) * other.piece];
                        found = (distance - radii, along);
                    }
                }
            }
        }
        found
    }
}

impl Closest {
    /// The nearest two FREEs; `None` of a single one.
    pub(crate) fn of(tubes: &[Tube]) -> Option<Self> {
        let pairs = (0..tubes.len()).flat_map(|i| (0..i).map(move |k| [k, i]));
        pairs
            .map(|frees| {
                let (gap, along) = tubes[frees[0]].nearest(&tubes[frees[1]]);
                Closest { frees, gap, along }
            })
            .min_by(|a, b| a.gap.total_cmp(&b.gap))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_pieces_are_as_near_as_said() {
        let v = Vector3::new;
        // Crossing, end to side, end to end, and side by side.
        let cases = [
            ([v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)], [v(0.5, -1.0, 2.0), v(0.5, 1.0, 2.0)], 2.0),
            ([v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)], [v(0.5, 3.0, 0.0), v(0.7, 9.0, 1.0)], 3.0),
            ([v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)], [v(4.0, 4.0, 0.0), v(9.0, 9.0, 0.0)], 5.0),
            ([v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0)], [v(0.3, 0.4, 0.9), v(0.3, 0.4, 2.0)], 0.5),
        ];
        for (one, other, distance) in cases {
            for (a, b) in [(one, other), (other, one), ([one[1], one[0]], other)] {
                assert!((between(a, b).0 - distance).abs() < 1e-14, "{a:?} {b:?}: {:?}", between(a, b));
            }
        }
    }

    /// Two circular arcs that bend towards each other: the polylines' gap falls to the arcs' with the square of the pieces.
    #[test]
    fn polylines_become_their_arcs() {
        let gap = |pieces: usize| {
            let arc = |side: f64| Tube {
                points: (0..=pieces)
                    .map(|i| 1.7 * i as f64 / pieces as f64 - 0.75)
                    .map(|angle| Vector3::new(side * (2.0 - angle.cos()), 0.0, angle.sin()))
                    .collect(),
                radii: vec![0.25; pieces],
                piece: 1.7 / pieces as f64,
            };
            let (gap, along) = arc(1.0).nearest(&arc(-1.0));
            assert!((along[0] - 0.75).abs() < 0.501 * 1.7 / pieces as f64);
            gap - 1.5
        };
        // The nearest place is in the middle of a piece both times.
        let [coarse, fine] = [17, 51].map(gap);
        assert!(
            ((coarse / fine).ln() / 3f64.ln() - 2.0).abs() < 0.01 && fine.abs() < 1e-3,
            "{coarse} {fine}"
        );
    }
}
