use crate::material::{Hyperelastic, Rubber};
use nalgebra::{Matrix3, Vector3};

/// How a specimen of incompressible rubber is loaded; l is the stretch along the load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LoadingMode {
    /// A bar: stretches l, l^(-1/2), l^(-1/2).
    Uniaxial,
    /// A sheet drawn alike both ways (l > 1), or a button pressed (l^-2 < 1): l, l, l^-2.
    Equibiaxial,
    /// A wide, short strip, which cannot draw in ("pure shear"): l, 1, 1/l.
    Planar,
}

impl LoadingMode {
    /// All of them.
    pub const ALL: [LoadingMode; 3] = [LoadingMode::Uniaxial, LoadingMode::Equibiaxial, LoadingMode::Planar];

    /// The name in files: uniaxial, equibiaxial, planar.
    pub fn name(self) -> &'static str {
        match self {
            LoadingMode::Uniaxial => "uniaxial",
            LoadingMode::Equibiaxial => "equibiaxial",
            LoadingMode::Planar => "planar",
        }
    }

    /// Principal stretches at the stretch l; the third is that of the free side.
    pub fn stretches(self, l: f64) -> [f64; 3] {
        match self {
            LoadingMode::Uniaxial => [l, l.sqrt().recip(), l.sqrt().recip()],
            LoadingMode::Equibiaxial => [l, l, (l * l).recip()],
            LoadingMode::Planar => [l, 1.0, l.recip()],
        }
    }
}

/// A measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestPoint {
    /// How the specimen was loaded.
    pub mode: LoadingMode,
    /// Stretch along the load; below 1 in compression.
    pub stretch: f64,
    /// Nominal stress, force over undeformed area, Pa; negative in compression.
    pub stress: f64,
}

/// Nominal stress (Pa) along the load at a stretch, the free side without stress: P11 - P33 l3/l1. NaN where the rubber cannot
/// be stretched so far.
pub fn nominal_stress(rubber: &Rubber, mode: LoadingMode, stretch: f64) -> f64 {
    let [l1, l2, l3] = mode.stretches(stretch);
    let stress = rubber.first_piola_kirchhoff_stress(&Matrix3::from_diagonal(&Vector3::new(l1, l2, l3)));
    stress[(0, 0)] - stress[(2, 2)] * l3 / l1
}
