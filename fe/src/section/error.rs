/// Pressure and shape at which a solve stood, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whereabouts {
    /// Gauge pressure, Pa.
    pub pressure: f64,
    /// Axial stretch.
    pub axial_stretch: f64,
    /// Twist per reference length of the right-handed winding, rad/m.
    pub twist_per_length: f64,
}

impl std::fmt::Display for Whereabouts {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            out,
            "{:.4} kPa, stretch {:.5}, twist {:.4} rad/m",
            1e-3 * self.pressure,
            self.axial_stretch,
            self.twist_per_length
        )
    }
}

/// Why the section has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SectionError {
    /// A number of the FREE, of the mesh or of the request is outside what the section can represent.
    #[error("{field} is {value}, but {requirement}")]
    Invalid {
        /// Which number.
        field: &'static str,
        /// Its value, SI.
        value: f64,
        /// What would be accepted.
        requirement: &'static str,
    },
    /// Newton's method found no equilibrium, or only unstable ones, even by the shortest steps allowed.
    #[error(
        "no stable equilibrium found towards {target} (relative residual {residual:.1e}); the last good state is at {last_good}. \
         Ask for less pressure or deformation, or refine the mesh"
    )]
    NotConverged {
        /// What was asked for.
        target: Whereabouts,
        /// Relative residual where the iteration gave up; NaN when an element was turned inside out,
        /// tiny when the equilibrium there is unstable.
        residual: f64,
        /// The nearest state in equilibrium.
        last_good: Whereabouts,
    },
}
