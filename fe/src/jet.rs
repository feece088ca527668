use nalgebra::{Matrix3, Vector3};
use std::ops::{Add, Mul, Sub};

/// A number that carries its first and second derivatives with respect to three variables.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    pub value: f64,
    pub gradient: Vector3<f64>,
    pub hessian: Matrix3<f64>,
}

impl Jet {
    pub fn constant(value: f64) -> Self {
        Jet { value, gradient: Vector3::zeros(), hessian: Matrix3::zeros() }
    }

    /// The `index`-th variable at `value`.
    pub fn variable(value: f64, index: usize) -> Self {
        let mut gradient = Vector3::zeros();
        gradient[index] = 1.0;
        Jet { value, gradient, hessian: Matrix3::zeros() }
    }

    /// f(self), given f, f', f'' at its value.
    pub fn compose(self, [f, slope, curvature]: [f64; 3]) -> Self {
        Jet {
            value: f,
            gradient: self.gradient * slope,
            hessian: self.hessian * slope + self.gradient * self.gradient.transpose() * curvature,
        }
    }

    /// self^exponent.
    pub fn powf(self, exponent: f64) -> Self {
        let power = self.value.powf(exponent);
        let slope = exponent * power / self.value;
        self.compose([power, slope, (exponent - 1.0) * slope / self.value])
    }

    /// e^self.
    pub fn exp(self) -> Self {
        let power = self.value.exp();
        self.compose([power; 3])
    }

    /// Hyperbolic tangent.
    pub fn tanh(self) -> Self {
        let t = self.value.tanh();
        let slope = 1.0 - t * t;
        self.compose([t, slope, -2.0 * t * slope])
    }

    /// A bounded stand-in for the variable: x/sqrt(1 + (x/2)^2), within -2 to 2.
    pub fn saturated(self) -> Self {
        let x = self.value;
        let root = 1.0 / (1.0 + 0.25 * x * x).sqrt();
        self.compose([x * root, root.powi(3), -0.75 * x * root.powi(5)])
    }

    /// f(x, y), given f, f_x, f_y, f_xx, f_xy, f_yy at their values.
    pub fn compose2(x: Jet, y: Jet, [f, fx, fy, fxx, fxy, fyy]: [f64; 6]) -> Self {
        let [xx, xy, yy] = [
            x.gradient * x.gradient.transpose(),
            x.gradient * y.gradient.transpose(),
            y.gradient * y.gradient.transpose(),
        ];
        Jet {
            value: f,
            gradient: x.gradient * fx + y.gradient * fy,
            hessian: x.hessian * fx + y.hessian * fy + xx * fxx + (xy + xy.transpose()) * fxy + yy * fyy,
        }
    }
}

impl Add for Jet {
    type Output = Jet;
    fn add(self, other: Jet) -> Jet {
        Jet {
            value: self.value + other.value,
            gradient: self.gradient + other.gradient,
            hessian: self.hessian + other.hessian,
        }
    }
}

impl Sub for Jet {
    type Output = Jet;
    fn sub(self, other: Jet) -> Jet {
        self + other * -1.0
    }
}

impl Mul for Jet {
    type Output = Jet;
    fn mul(self, other: Jet) -> Jet {
        let cross = self.gradient * other.gradient.transpose();
        Jet {
            value: self.value * other.value,
            gradient: self.gradient * other.value + other.gradient * self.value,
            hessian: self.hessian * other.value + other.hessian * self.value + cross + cross.transpose(),
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Jet;
    fn mul(self, factor: f64) -> Jet {
        Jet { value: self.value * factor, gradient: self.gradient * factor, hessian: self.hessian * factor }
    }
}
