use serde::{Deserialize, Serialize};

/// The elastomer tube of a FREE, undeformed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tube {
    /// Length between the plates or caps, m.
    pub length: f64,
    /// Inner radius A, m.
    pub inner_radius: f64,
    /// Wall thickness t = B - A, m.
    pub wall: f64,
}

impl Tube {
    /// Outer radius B = A + t, m: where the fibres lie.
    pub fn outer_radius(&self) -> f64 {
        self.inner_radius + self.wall
    }

    /// Area of the elastomer's cross-section, pi (B^2 - A^2), m^2.
    pub fn wall_area(&self) -> f64 {
        std::f64::consts::PI * (self.outer_radius().powi(2) - self.inner_radius.powi(2))
    }

    /// Second moment of the elastomer's cross-section about a diameter, pi/4 (B^4 - A^4), m^4.
    pub fn second_moment(&self) -> f64 {
        std::f64::consts::FRAC_PI_4 * (self.outer_radius().powi(4) - self.inner_radius.powi(4))
    }
}
