use super::{equilibrium::Configuration, module::RodModule, path::Loads};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Where the surfaces of two FREEs of a module are nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The FREEs.
    pub frees: [usize; 2],
    /// Distance between their surfaces, m: of their centrelines, less both outer radii there. Negative where they overlap: rods do not push
    /// each other away.
    pub gap: f64,
    /// Reference distance from the base at which they are so near, m.
    pub along: [f64; 2],
}

/// Longest piece of a centreline that is taken as straight, over the outer radius: on a circle of four outer radii the arc leaves
/// it by 0.5 % of the radius.
const PIECE: f64 = 0.4;

/// A FREE as a row of straight pieces.
pub(super) struct Tube {
    /// Ends of the pieces, m.
    points: Vec<Vector3<f64>>,
    /// Outer radius of each piece, m.
    radii: Vec<f64>,
    /// Reference length of a piece, m.
    piece: f64,
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

impl RodModule {
    /// Centrelines and outer radii of all FREEs. The rubber keeps its volume: with V enclosed per reference length,
    /// `b^2 = V/(pi lambda) + (B^2 - A^2)/lambda`. Caps, which hold the tube narrow at its ends, are left out.
    pub(super) fn tubes(&self, shape: &Configuration, loads: &Loads) -> Vec<Tube> {
        let frame = shape.plate.frame();
        let mut tubes: Vec<(usize, Tube)> = vec![];
        for (chain, inner) in self.chains(loads.part).iter().zip(&shape.inner) {
            for member in &chain.members {
                let free = self.module.frees[member.free].free.tube;
                let (inside, outside) = (free.inner_radius, free.outer_radius());
                let count = (member.law.length / (PIECE * outside)).ceil().clamp(1.0, 100.0);
                let frames: Vec<_> = chain.frames(inner, &frame).map(|node| member.frame(&node)).collect();
                let mut tube = Tube { points: vec![], radii: vec![], piece: member.law.length / count };
                tube.points.extend(frames.first().map(|first| first.position));
                for pair in frames.windows(2) {
                    let step = pair[0].log_to(&pair[1]);
                    let [stretch, twist] = member.law.strain(&step);
                    let volume = member.law.section.volume(loads.pressures[member.free], stretch, twist);
                    let wall = outside * outside - inside * inside;
                    let radius = ((volume / PI + wall).max(0.0) / stretch.abs()).sqrt();
                    for place in 1..=count as usize {
                        tube.points.push(pair[0].moved(&(step * (place as f64 / count))).position);
                        tube.radii.push(radius);
                    }
                }
                tubes.push((member.free, tube));
            }
        }
        tubes.sort_by_key(|(free, _)| *free);
        tubes.into_iter().map(|(_, tube)| tube).collect()
    }

    /// The nearest two FREEs; `None` of a single one.
    pub(super) fn closest(&self, shape: &Configuration, loads: &Loads) -> Option<Closest> {
        let tubes = self.tubes(shape, loads);
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
#[path = "contact_tests.rs"]
mod tests;
