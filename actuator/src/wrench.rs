use serde::{Deserialize, Serialize};
use std::ops::{Add, Mul, Sub};

/// Force and moment on a rigid plate, about its centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// Force, N.
    pub force: [f64; 3],
    /// Moment about the centre, N m.
    pub moment: [f64; 3],
}

impl Wrench {
    /// Force x, y, z (N), moment x, y, z (N m).
    pub fn to_array(self) -> [f64; 6] {
        let ([fx, fy, fz], [mx, my, mz]) = (self.force, self.moment);
        [fx, fy, fz, mx, my, mz]
    }

    /// The inverse of [`Wrench::to_array`].
    pub fn from_array([fx, fy, fz, mx, my, mz]: [f64; 6]) -> Self {
        Wrench { force: [fx, fy, fz], moment: [mx, my, mz] }
    }

    fn combine(self, other: Wrench, with: impl Fn(f64, f64) -> f64) -> Wrench {
        let (a, b) = (self.to_array(), other.to_array());
        Wrench::from_array(std::array::from_fn(|i| with(a[i], b[i])))
    }
}

impl Add for Wrench {
    type Output = Wrench;

    fn add(self, other: Wrench) -> Wrench {
        self.combine(other, |a, b| a + b)
    }
}

impl Sub for Wrench {
    type Output = Wrench;

    fn sub(self, other: Wrench) -> Wrench {
        self.combine(other, |a, b| a - b)
    }
}

impl Mul<f64> for Wrench {
    type Output = Wrench;

    fn mul(self, factor: f64) -> Wrench {
        Wrench::from_array(self.to_array().map(|value| value * factor))
    }
}

impl std::iter::Sum for Wrench {
    fn sum<I: Iterator<Item = Wrench>>(wrenches: I) -> Wrench {
        wrenches.fold(Wrench::default(), Add::add)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrenches_add_component_by_component() {
        let a = Wrench { force: [1.0, 2.0, 3.0], moment: [4.0, 5.0, 6.0] };
        let b = Wrench::from_array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0]);
        let sum: Wrench = [a, b * 2.0, b].into_iter().sum();
        assert_eq!((sum - a).to_array(), [1.5, 3.0, 4.5, 6.0, 7.5, 9.0]);
        assert_eq!(Wrench::from_array(a.to_array()), a);
    }
}
