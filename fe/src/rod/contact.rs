use super::{equilibrium::Configuration, module::RodModule, path::Loads};
use crate::contact::{Closest, Tube};
use std::f64::consts::PI;

/// Longest piece of a centreline that is taken as straight, over the outer radius: on a circle of four outer radii the arc leaves
/// it by 0.5 % of the radius.
const PIECE: f64 = 0.4;

impl Configuration {
    /// Centreline of each FREE at its nodes from the base to the tip, m, base frame.
    pub fn centrelines(&self, of: &RodModule) -> Vec<Vec<[f64; 3]>> {
        let frame = self.plate.frame();
        let mut lines: Vec<(usize, Vec<[f64; 3]>)> = vec![];
        for (chain, inner) in of.chains(1.0).iter().zip(&self.inner) {
            for member in &chain.members {
                let nodes = chain.frames(inner, &frame).map(|node| member.frame(&node).position.into());
                lines.push((member.free, nodes.collect()));
            }
        }
        lines.sort_by_key(|(free, _)| *free);
        lines.into_iter().map(|(_, line)| line).collect()
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
        Closest::of(&self.tubes(shape, loads))
    }
}

#[cfg(test)]
#[path = "contact_tests.rs"]
mod tests;
