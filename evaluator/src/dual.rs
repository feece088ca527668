use crate::Real;
use core::{
    cmp::Ordering,
    ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign},
};

/// A number with its derivatives with respect to `N` others: `a + sum_k a_k e_k`, `e_i e_j = 0`.
///
/// What is computed in it comes out with exact first derivatives. An effect whose memory is kept in such numbers carries
/// the derivatives of its past along. Numbers are compared by their value alone; where two branches meet, the derivative is
/// that of the branch taken.
#[derive(Clone, Copy, Debug)]
pub struct Dual<T, const N: usize> {
    /// The value.
    pub value: T,
    /// Its derivatives.
    pub slopes: [T; N],
}

impl<T: Real, const N: usize> Dual<T, N> {
    /// The `k`-th of the numbers that is differentiated by.
    pub fn variable(value: T, k: usize) -> Self {
        let mut slopes = [T::ZERO; N];
        slopes[k] = T::ONE;
        Dual { value, slopes }
    }

    /// A number that depends on none of them.
    pub fn fixed(value: T) -> Self {
        Dual { value, slopes: [T::ZERO; N] }
    }

    /// f(self) from the value of f and of its derivative there.
    fn chain(self, value: T, slope: T) -> Self {
        Dual { value, slopes: self.slopes.map(|of_self| slope * of_self) }
    }

    fn combine(self, other: Self, value: T, by_self: T, by_other: T) -> Self {
        let mut slopes = self.slopes;
        for (into, of_other) in slopes.iter_mut().zip(other.slopes) {
            *into = by_self * *into + by_other * of_other;
        }
        Dual { value, slopes }
    }
}

impl<T: Real, const N: usize> From<T> for Dual<T, N> {
    fn from(value: T) -> Self {
        Self::fixed(value)
    }
}

impl<T: Real, const N: usize> Default for Dual<T, N> {
    fn default() -> Self {
        Self::fixed(T::ZERO)
    }
}

impl<T: Real, const N: usize> PartialEq for Dual<T, N> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: Real, const N: usize> PartialOrd for Dual<T, N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<T: Real, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, T::ONE, T::ONE)
    }
}

impl<T: Real, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, T::ONE, -T::ONE)
    }
}

impl<T: Real, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}

impl<T: Real, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let (quotient, inverse) = (self.value / other.value, T::ONE / other.value);
        self.combine(other, quotient, inverse, -quotient * inverse)
    }
}

impl<T: Real, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -T::ONE)
    }
}

impl<T: Real, const N: usize> AddAssign for Dual<T, N> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real, const N: usize> SubAssign for Dual<T, N> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Real, const N: usize> MulAssign for Dual<T, N> {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<T: Real, const N: usize> Real for Dual<T, N> {
    const ZERO: Self = Dual { value: T::ZERO, slopes: [T::ZERO; N] };
    const ONE: Self = Dual { value: T::ONE, slopes: [T::ZERO; N] };

    const ROUNDING: Self = Dual { value: T::ROUNDING, slopes: [T::ZERO; N] };

    fn to_f64(self) -> f64 {
        self.value.to_f64()
    }

    fn constant(value: f64) -> Self {
        Self::fixed(T::constant(value))
    }

    /// The slope at nought is infinite, as that of the root is.
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, T::constant(0.5) / root)
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }

    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }

    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }

    fn is_finite(self) -> bool {
        self.value.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_agrees_with_differences() {
        fn function<T: Real>(x: T, y: T) -> T {
            let mut sum = (x * y).sin() / (y + T::ONE) - (-x).exp() * (x + y).sqrt();
            sum += x.cos();
            sum -= y;
            sum *= x;
            sum.greater(T::constant(-50.0)).lesser(T::constant(50.0))
        }
        let (x, y, h) = (0.7f64, 1.3f64, 1e-6);
        let dual = function(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
        assert_eq!(dual.value, function(x, y));
        let differences = [
            (function(x + h, y) - function(x - h, y)) / (2.0 * h),
            (function(x, y + h) - function(x, y - h)) / (2.0 * h),
        ];
        for (slope, difference) in dual.slopes.into_iter().zip(differences) {
            assert!((slope - difference).abs() < 1e-9, "{slope} {difference}");
        }
    }

    #[test]
    fn what_is_not_a_number_loses_to_what_is() {
        assert_eq!((f64::NAN.greater(1.0), 1.0f64.greater(f64::NAN)), (1.0, 1.0));
        assert_eq!((f64::NAN.lesser(1.0), 1.0f64.lesser(f64::NAN)), (1.0, 1.0));
    }
}
