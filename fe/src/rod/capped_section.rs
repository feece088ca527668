use crate::{CapEffect, CapTable, SectionLaw, SectionResponse};
use nalgebra::{Matrix2, Vector2};
use std::sync::Arc;

/// The law of a FREE of finite length between its caps, per reference length of all of it: of mean stretch and mean twist, where
/// the section's law is that of a tube far from caps.
///
/// Tube and caps bear the same force and torque f = (N, M). With the section's enthalpy Phi and the caps' complementary energy G
/// ([`CapEffect`]), the strains s = (lambda, tau) far from the caps and the mean ones s' of a FREE of length L belong together by
///
/// `s' = s + u(f)/L`, `u = dG/df`, `f = dPhi/ds`,
///
/// and the enthalpy per length is `Phi(s) + f.(s' - s) - G(f)/L`, whose derivative by s' is f: force, torque and a symmetric
/// stiffness come from one energy, and the compliance is `C + (d^2 G/df^2)/L`. What the caps do is spread over the length: force and torque
/// hardly change along a FREE, and how far a tip moves and turns is all that is known of its ends.
///
/// Bending is not in it: [`crate::BendingLaw`]s know their ends.
#[derive(Clone)]
pub struct CappedSection {
    far: Arc<dyn SectionLaw>,
    caps: Arc<CapTable>,
    /// m.
    length: f64,
    outer_radius: f64,
}

/// Error of s, relative to one in stretch and to one over the outer radius in twist, that is put in to first order: what is left of the
/// energy is its square.
const TOLERANCE: f64 = 1e-7;
const MOST_STEPS: usize = 40;

/// The section and its caps at one pressure.
struct InSeries<'a> {
    law: &'a CappedSection,
    caps: CapEffect,
    pressure: f64,
}

/// At some s: s + u/L - s', its derivative by s, the section's answer and G/L.
struct Tried {
    off: Vector2<f64>,
    slope: Matrix2<f64>,
    own: SectionResponse,
    caps_energy: f64,
}

fn stiffness(of: &SectionResponse) -> Matrix2<f64> {
    Matrix2::from_row_iterator(of.stiffness.into_iter().flatten())
}

impl InSeries<'_> {
    fn tried(&self, at: Vector2<f64>, mean: Vector2<f64>) -> Tried {
        let share = 1.0 / self.law.length;
        let own = self.law.far.respond(self.pressure, at.x, at.y);
        let caps = self.caps.at(own.force, own.torque);
        let compliance = Matrix2::from_row_iterator(caps.compliance.into_iter().flatten());
        Tried {
            off: at + Vector2::from(caps.ends) * share - mean,
            slope: Matrix2::identity() + compliance * stiffness(&own) * share,
            own,
            caps_energy: caps.energy * share,
        }
    }

    fn size(&self, off: &Vector2<f64>) -> f64 {
        off.x.abs().max(off.y.abs() * self.law.outer_radius)
    }

    /// The strains far from the caps and the answer of the whole, by Newton's method with steps shortened until they help; `None` where there
    /// is none.
    fn found(&self, mean: Vector2<f64>) -> Option<(Vector2<f64>, SectionResponse)> {
        let mut at = mean;
        let mut tried = self.tried(at, mean);
        for _ in 0..MOST_STEPS {
            let back = tried.slope.try_inverse()?;
            let step = -(back * tried.off);
            if self.size(&tried.off) < TOLERANCE {
                // F(s) = Phi + f.(s' - s) - G/L has dF/ds = -K off: where off is zero it is F - off.K step/2, and f changes by K step.
                let own = stiffness(&tried.own);
                let force = Vector2::new(tried.own.force, tried.own.torque);
                let change = own * step;
                // (C + D/L)^-1 = K (1 + D K/L)^-1, also where K has no inverse.
                let whole = own * back;
                let whole = (whole + whole.transpose()) * 0.5;
                let response = SectionResponse {
                    energy: tried.own.energy + force.dot(&(mean - at))
                        - tried.caps_energy
                        - 0.5 * tried.off.dot(&change),
                    force: force.x + change.x,
                    torque: force.y + change.y,
                    stiffness: [[whole[(0, 0)], whole[(0, 1)]], [whole[(1, 0)], whole[(1, 1)]]],
                };
                return Some((at + step, response));
            }
            let mut part = 1.0;
            tried = loop {
                let next = self.tried(at + step * part, mean);
                // Where the section has no answer, that is no number, and not less either.
                if self.size(&next.off) < self.size(&tried.off) {
                    break next;
                }
                part *= 0.5;
                if part < 1e-3 {
                    return None;
                }
            };
            at += step * part;
        }
        None
    }
}

impl CappedSection {
    /// The law of a FREE of a length (m) and an outer radius (m): what its section does far from caps, and what the caps do.
    pub fn new(far: Arc<dyn SectionLaw>, caps: Arc<CapTable>, [length, outer_radius]: [f64; 2]) -> Self {
        CappedSection { far, caps, length, outer_radius }
    }

    fn found(&self, pressure: f64, stretch: f64, twist: f64) -> Option<(Vector2<f64>, SectionResponse)> {
        let series = InSeries { law: self, caps: self.caps.at(pressure), pressure };
        series.found(Vector2::new(stretch, twist))
    }
}

impl SectionLaw for CappedSection {
    /// Where the section or the caps have no answer, every number of the response is NaN.
    fn respond(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> SectionResponse {
        let nan = f64::NAN;
        let none = SectionResponse { energy: nan, force: nan, torque: nan, stiffness: [[nan; 2]; 2] };
        self.found(pressure, axial_stretch, twist_per_length).map_or(none, |(_, response)| response)
    }

    fn covers(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> bool {
        let found = self.found(pressure, axial_stretch, twist_per_length);
        found.is_some_and(|(far, _)| self.far.covers(pressure, far.x, far.y))
    }

    /// That of a tube without caps at these strains: what tells how thick a FREE is leaves their narrowing out.
    fn volume(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> f64 {
        self.far.volume(pressure, axial_stretch, twist_per_length)
    }
}

#[cfg(test)]
#[path = "capped_section_tests.rs"]
mod tests;
