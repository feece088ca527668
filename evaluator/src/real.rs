use core::{
    fmt::Debug,
    ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign},
};

/// A number that models are evaluated in: `f32`, `f64`, or one that carries derivatives ([`crate::Dual`]).
///
/// The functions are those of `libm`, so that every machine and every build gives the same bits.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Nought.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// The nearest number to a constant of double precision.
    fn constant(value: f64) -> Self;
    /// Relative error that a unit's conversion there and back may leave.
    const ROUNDING: Self;
    /// The value in double precision.
    fn to_f64(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Sine, of radians.
    fn sin(self) -> Self;
    /// Cosine, of radians.
    fn cos(self) -> Self;
    /// Whether it is neither infinite nor not a number.
    fn is_finite(self) -> bool;

    /// The greater; the other where one is not a number.
    fn greater(self, other: Self) -> Self {
        if other > self || self.partial_cmp(&self).is_none() { other } else { self }
    }

    /// The lesser; the other where one is not a number.
    fn lesser(self, other: Self) -> Self {
        if other < self || self.partial_cmp(&self).is_none() { other } else { self }
    }
}

impl Real for f64 {
    const ZERO: f64 = 0.0;
    const ONE: f64 = 1.0;
    const ROUNDING: f64 = 1e-9;
    fn to_f64(self) -> f64 {
        self
    }
    fn constant(value: f64) -> f64 {
        value
    }
    fn sqrt(self) -> f64 {
        libm::sqrt(self)
    }
    fn exp(self) -> f64 {
        libm::exp(self)
    }
    fn sin(self) -> f64 {
        libm::sin(self)
    }
    fn cos(self) -> f64 {
        libm::cos(self)
    }
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

impl Real for f32 {
    const ZERO: f32 = 0.0;
    const ONE: f32 = 1.0;
    const ROUNDING: f32 = 1e-6;
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn constant(value: f64) -> f32 {
        value as f32
    }
    fn sqrt(self) -> f32 {
        libm::sqrtf(self)
    }
    fn exp(self) -> f32 {
        libm::expf(self)
    }
    fn sin(self) -> f32 {
        libm::sinf(self)
    }
    fn cos(self) -> f32 {
        libm::cosf(self)
    }
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
}
