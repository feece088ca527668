use actuator::FreePath;

/// What a pressure is measured by: states along a path are smooth in the coordinate that it gives, and those of FREEs of other shear
/// moduli can be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PressureUnit {
    /// Limit pressure of the section, Pa. The coordinate of a path is s = 1 - sqrt(1 - p/p_limit), in which states are smooth up
    /// to the limit point.
    Limit(f64),
    /// Another pressure, Pa, of a section without limit pressure, such as its shear modulus. The coordinate is s = p over it.
    Other(f64),
}

impl PressureUnit {
    /// The unit of a section's path, for a rubber of shear modulus `shear_modulus` (Pa).
    pub fn of(section: &FreePath, shear_modulus: f64) -> Self {
        section.limit_pressure().map_or(PressureUnit::Other(shear_modulus), PressureUnit::Limit)
    }

    /// The coordinate s of a pressure (Pa); NaN above a limit pressure.
    pub fn coordinate(self, pressure: f64) -> f64 {
        match self {
            // The section's limit state is known to 1e-10 or so.
            PressureUnit::Limit(limit) if pressure <= limit * (1.0 + 1e-9) => {
                1.0 - (1.0 - pressure / limit).max(0.0).sqrt()
            }
            PressureUnit::Limit(_) => f64::NAN,
            PressureUnit::Other(unit) => pressure / unit,
        }
    }

    /// The pressure (Pa) of a coordinate.
    pub fn pressure(self, s: f64) -> f64 {
        match self {
            PressureUnit::Limit(limit) => limit * (1.0 - (1.0 - s) * (1.0 - s)),
            PressureUnit::Other(unit) => unit * s,
        }
    }

    /// Whether paths in the two units can be compared: both have a limit, or neither.
    pub fn is_like(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }
}
