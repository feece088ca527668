//! Conversions at the edge of the program: files speak kPa, mm and degrees, the inside speaks SI and radians.

/// Pascals in a kilopascal.
pub const KPA: f64 = 1e3;
/// Pascals in a megapascal.
pub const MPA: f64 = 1e6;
/// Metres in a millimetre.
pub const MM: f64 = 1e-3;
/// Kilograms in a gram.
pub const GRAM: f64 = 1e-3;
/// Radians in a degree.
pub const DEG: f64 = std::f64::consts::PI / 180.0;
/// Standard gravity, m/s^2.
pub const STANDARD_GRAVITY: f64 = 9.806_65;
