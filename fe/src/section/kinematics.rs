use crate::material::{Answer, Tangent, flat};
use nalgebra::Matrix3;

/// Unknowns of an element: r, phi, w at nine nodes, then lambda and psi.
pub(crate) const UNKNOWNS: usize = 29;
/// Where lambda stands among them; psi follows.
pub(crate) const STRETCH: usize = 27;
/// Rows of an element's stiffness, padded to whole vector registers.
pub(crate) type Rows<const N: usize> = [[f64; 32]; N];

/// What the deformation depends on at a point: r, r_R, r_eta, phi_R, phi_eta, w_R, w_eta, lambda, psi.
pub(crate) type Local = [f64; 9];

/// A quadrature point with the shape functions of its element.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Reference radius R.
    pub radius: f64,
    /// Reference volume (or angle, on an edge) that the point stands for.
    pub weight: f64,
    /// Shape functions N.
    pub values: [f64; 9],
    /// dN/dR.
    pub by_radius: [f64; 9],
    /// dN/deta.
    pub by_angle: [f64; 9],
    /// Functions of the pressure field: 1 and the two coordinates in the element, -1 to 1.
    pub linear: [f64; 3],
}

impl Point {
    /// Local unknowns from those of the element.
    pub fn local(&self, unknowns: &[f64; UNKNOWNS]) -> Local {
        let mut local = [0.0; 9];
        for node in 0..9 {
            let [r, phi, w] = [unknowns[3 * node], unknowns[3 * node + 1], unknowns[3 * node + 2]];
            local[0] += self.values[node] * r;
            local[1] += self.by_radius[node] * r;
            local[2] += self.by_angle[node] * r;
            local[3] += self.by_radius[node] * phi;
            local[4] += self.by_angle[node] * phi;
            local[5] += self.by_radius[node] * w;
            local[6] += self.by_angle[node] * w;
        }
        local[7] = unknowns[STRETCH];
        local[8] = unknowns[STRETCH + 1];
        local
    }

    /// Adds a gradient by the local unknowns to one by the element's.
    pub fn add_gradient(&self, gradient: &Local, into: &mut [f64; UNKNOWNS]) {
        for node in 0..9 {
            let (n, nr, na) = (self.values[node], self.by_radius[node], self.by_angle[node]);
            into[3 * node] += n * gradient[0] + nr * gradient[1] + na * gradient[2];
            into[3 * node + 1] += nr * gradient[3] + na * gradient[4];
            into[3 * node + 2] += nr * gradient[5] + na * gradient[6];
        }
        into[STRETCH] += gradient[7];
        into[STRETCH + 1] += gradient[8];
    }

    /// Adds a Hessian by the local unknowns to one by the element's (lower triangle and some of the rest).
    pub fn add_hessian(&self, hessian: &[[f64; 9]; 9], into: &mut Rows<UNKNOWNS>) {
        // half = hessian B, with B the 9 x 29 matrix that takes the element's unknowns to the local ones.
        let mut half: Rows<9> = [[0.0; 32]; 9];
        for (row, h) in half.iter_mut().zip(hessian) {
            for node in 0..9 {
                let (n, nr, na) = (self.values[node], self.by_radius[node], self.by_angle[node]);
                row[3 * node] = n * h[0] + nr * h[1] + na * h[2];
                row[3 * node + 1] = nr * h[3] + na * h[4];
                row[3 * node + 2] = nr * h[5] + na * h[6];
            }
            row[STRETCH] = h[7];
            row[STRETCH + 1] = h[8];
        }
        for node in 0..9 {
            let (n, nr, na) = (self.values[node], self.by_radius[node], self.by_angle[node]);
            for j in 0..32 {
                into[3 * node][j] += n * half[0][j] + nr * half[1][j] + na * half[2][j];
                into[3 * node + 1][j] += nr * half[3][j] + na * half[4][j];
                into[3 * node + 2][j] += nr * half[5][j] + na * half[6][j];
            }
        }
        for j in 0..32 {
            into[STRETCH][j] += half[7][j];
            into[STRETCH + 1][j] += half[8][j];
        }
    }
}

/// Deformation gradient of x = (r, Theta + psi Z + phi, lambda Z + w) with r, phi, w functions of R and eta = Theta - k Z.
///
/// At fixed R and Theta, d/dZ = -k d/deta; in the cylindrical frames of the reference and of the deformed point the rows are
///   r:     r_R,     r_eta/R,           -k r_eta
///   theta: r phi_R, r (1 + phi_eta)/R, r (psi - k phi_eta)
///   z:     w_R,     w_eta/R,           lambda - k w_eta.
pub(crate) fn deformation_gradient(y: &Local, radius: f64, turn: f64) -> Matrix3<f64> {
    let &[r, r_r, r_a, phi_r, phi_a, w_r, w_a, stretch, twist] = y;
    Matrix3::new(
        r_r,
        r_a / radius,
        -turn * r_a,
        r * phi_r,
        r * (1.0 + phi_a) / radius,
        r * (twist - turn * phi_a),
        w_r,
        w_a / radius,
        stretch - turn * w_a,
    )
}

/// Where the non-zero entries of dF/dy (column by column of y) begin.
const COLUMN: [usize; 10] = [0, 3, 4, 6, 7, 9, 10, 12, 13, 14];

/// Gradient and Hessian by the local unknowns of an energy whose derivatives by F are `stress` and `tangent`.
pub(crate) fn pull_back(y: &Local, radius: f64, turn: f64, answer: &Answer) -> (Local, [[f64; 9]; 9]) {
    let &[r, _, _, phi_r, phi_a, _, _, _, twist] = y;
    let inverse = radius.recip();
    // dF/dy: (index of F, derivative).
    let entries: [(usize, f64); 14] = [
        (flat(1, 0), phi_r),
        (flat(1, 1), (1.0 + phi_a) * inverse),
        (flat(1, 2), twist - turn * phi_a),
        (flat(0, 0), 1.0),
        (flat(0, 1), inverse),
        (flat(0, 2), -turn),
        (flat(1, 0), r),
        (flat(1, 1), r * inverse),
        (flat(1, 2), -turn * r),
        (flat(2, 0), 1.0),
        (flat(2, 1), inverse),
        (flat(2, 2), -turn),
        (flat(2, 2), 1.0),
        (flat(1, 2), r),
    ];
    let stress = |index: usize| answer.stress[(index / 3, index % 3)];
    let mut gradient = [0.0; 9];
    let mut half = [[0.0; 9]; 9];
    for j in 0..9 {
        for &(index, derivative) in &entries[COLUMN[j]..COLUMN[j + 1]] {
            gradient[j] += derivative * stress(index);
            // The tangent is symmetric: its column is its row, and columns lie together.
            for (entry, value) in half[j].iter_mut().zip(answer.tangent.column(index).iter()) {
                *entry += derivative * value;
            }
        }
    }
    let mut hessian = [[0.0; 9]; 9];
    for i in 0..9 {
        for j in 0..9 {
            for &(index, derivative) in &entries[COLUMN[j]..COLUMN[j + 1]] {
                hessian[i][j] += derivative * half[i][index];
            }
        }
    }
    // F is bilinear in r and the derivatives of phi (and psi).
    let (p0, p1, p2) = (answer.stress[(1, 0)], answer.stress[(1, 1)], answer.stress[(1, 2)]);
    for (j, value) in [(3, p0), (4, p1 * inverse - turn * p2), (8, p2)] {
        hessian[0][j] += value;
        hessian[j][0] += value;
    }
    (gradient, hessian)
}

/// Cofactor of F, the derivative of det F.
pub(crate) fn cofactor(f: &Matrix3<f64>) -> Matrix3<f64> {
    let column = |j: usize| f.column(j).into_owned();
    let (a, b, c) = (column(0), column(1), column(2));
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}

/// Adds `factor` times the second derivatives of det F.
pub(crate) fn add_determinant_tangent(f: &Matrix3<f64>, factor: f64, tangent: &mut Tangent) {
    // d2 det/dF_ij dF_kl = sum over m, n of e_ikm e_jln F_mn.
    const NEXT: [usize; 3] = [1, 2, 0];
    for i in 0..3 {
        for j in 0..3 {
            for (k, sign_k) in [(NEXT[i], 1.0), (NEXT[NEXT[i]], -1.0)] {
                for (l, sign_l) in [(NEXT[j], 1.0), (NEXT[NEXT[j]], -1.0)] {
                    tangent[(flat(i, j), flat(k, l))] += factor * sign_k * sign_l * f[(3 - i - k, 3 - j - l)];
                }
            }
        }
    }
}

/// Volume enclosed by a surface of the section per reference length and per angle eta, with gradient and Hessian.
///
/// By the flux of r e_r/2, whose divergence is one and which does not cross the ends: with theta_Theta = 1 + phi_eta,
/// theta_Z = psi - k phi_eta, z_Theta = w_eta, z_Z = lambda - k w_eta the volume is r^2/2 times
/// theta_Theta z_Z - theta_Z z_Theta = lambda (1 + phi_eta) - (k + psi) w_eta.
pub(crate) fn enclosed_volume(y: &Local, turn: f64) -> (f64, Local, [[f64; 9]; 9]) {
    let &[r, _, _, _, phi_a, _, w_a, stretch, twist] = y;
    let (around, slope, half) = (1.0 + phi_a, turn + twist, 0.5 * r * r);
    let area = stretch * around - slope * w_a;
    let gradient = [r * area, 0.0, 0.0, 0.0, half * stretch, 0.0, -half * slope, half * around, -half * w_a];
    let mut hessian = [[0.0; 9]; 9];
    hessian[0][0] = area;
    let mut set = |i: usize, j: usize, value: f64| {
        hessian[i][j] = value;
        hessian[j][i] = value;
    };
    set(0, 4, r * stretch);
    set(0, 6, -r * slope);
    set(0, 7, r * around);
    set(0, 8, -r * w_a);
    set(4, 7, half);
    set(6, 8, -half);
    (half * area, gradient, hessian)
}

/// Stretch of the fibre through a point of the outer surface (R = 1), with gradient and Hessian.
///
/// Along a fibre eta, r, phi and w do not change: stretch^2 = (r^2 (k + psi)^2 + lambda^2)/(k^2 + 1).
pub(crate) fn fibre_stretch(y: &Local, turn: f64) -> (f64, Local, [[f64; 9]; 9]) {
    let (r, stretch, slope) = (y[0], y[7], turn + y[8]);
    let rest = 1.0 + turn * turn;
    let s = ((r * r * slope * slope + stretch * stretch) / rest).sqrt();
    // s^2 = q: ds = dq/(2 s), d2s = d2q/(2 s) - dq dq/(4 s^3).
    let mut gradient = [0.0; 9];
    gradient[0] = r * slope * slope / (rest * s);
    gradient[7] = stretch / (rest * s);
    gradient[8] = r * r * slope / (rest * s);
    let mut hessian = [[0.0; 9]; 9];
    for i in [0, 7, 8] {
        for j in [0, 7, 8] {
            let second = match (i, j) {
                (0, 0) => slope * slope,
                (7, 7) => 1.0,
                (8, 8) => r * r,
                (0, 8) | (8, 0) => 2.0 * r * slope,
                _ => 0.0,
            };
            hessian[i][j] = second / (rest * s) - gradient[i] * gradient[j] / s;
        }
    }
    (s, gradient, hessian)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Hyperelastic, NeoHookean};

    const TURN: f64 = 1.7;
    const Y: Local = [1.1, 0.9, 0.2, 0.1, -0.15, 0.3, 0.25, 1.2, -0.4];

    fn check(what: &str, function: impl Fn(&Local) -> (f64, Local, [[f64; 9]; 9])) {
        let step = 1e-5;
        let (_, gradient, hessian) = function(&Y);
        for j in 0..9 {
            let shifted = |by: f64| {
                let mut y = Y;
                y[j] += by;
                function(&y)
            };
            let ((up, up_gradient, _), (down, down_gradient, _)) = (shifted(step), shifted(-step));
            // Central differences: truncation and rounding both near 1e-10.
            assert!(((up - down) / (2.0 * step) - gradient[j]).abs() < 1e-8, "{what}: gradient {j}");
            for i in 0..9 {
                let slope = (up_gradient[i] - down_gradient[i]) / (2.0 * step);
                assert!((slope - hessian[i][j]).abs() < 1e-8, "{what}: Hessian {i} {j}");
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        check("volume", |y| enclosed_volume(y, TURN));
        check("fibre", |y| fibre_stretch(y, TURN));
        check("neo-Hookean", |y| {
            let answer = NeoHookean { shear_modulus: 1.0 }.answer(&deformation_gradient(y, 0.9, TURN));
            let (gradient, hessian) = pull_back(y, 0.9, TURN, &answer);
            (answer.energy, gradient, hessian)
        });
        check("determinant", |y| {
            let f = deformation_gradient(y, 0.9, TURN);
            let mut tangent = Tangent::zeros();
            add_determinant_tangent(&f, 1.0, &mut tangent);
            let answer = Answer { energy: f.determinant(), stress: cofactor(&f), tangent };
            let (gradient, hessian) = pull_back(y, 0.9, TURN, &answer);
            (answer.energy, gradient, hessian)
        });
    }

    #[test]
    fn gradient_of_the_motion_is_that_of_cartesian_coordinates() {
        // The motion itself, differentiated in Cartesian space, turned into the two cylindrical frames.
        let fields = |radius: f64, eta: f64| {
            let r = radius * 1.1 + 0.05 * radius * (2.0 * eta).sin();
            let phi = 0.1 * radius * eta.cos();
            let w = 0.2 * radius * radius * eta.sin();
            (r, phi, w)
        };
        let (stretch, twist) = (1.2, -0.4);
        let motion = |x: nalgebra::Vector3<f64>| {
            let (radius, theta) = (x.x.hypot(x.y), x.y.atan2(x.x));
            let (r, phi, w) = fields(radius, theta - TURN * x.z);
            let angle = theta + twist * x.z + phi;
            nalgebra::Vector3::new(r * angle.cos(), r * angle.sin(), stretch * x.z + w)
        };
        let (radius, theta, z) = (0.9f64, 0.5f64, 0.3);
        let x = nalgebra::Vector3::new(radius * theta.cos(), radius * theta.sin(), z);
        let step = 1e-5;
        let cartesian = Matrix3::from_columns(&std::array::from_fn::<_, 3, _>(|j| {
            let mut shift = nalgebra::Vector3::zeros();
            shift[j] = step;
            (motion(x + shift) - motion(x - shift)) / (2.0 * step)
        }));
        let eta = theta - TURN * z;
        let by = |h: f64, g: f64| {
            let ((r1, p1, w1), (r0, p0, w0)) = (fields(radius + h, eta + g), fields(radius - h, eta - g));
            let d = 2.0 * (h + g);
            [(r1 - r0) / d, (p1 - p0) / d, (w1 - w0) / d]
        };
        let ([r_r, phi_r, w_r], [r_a, phi_a, w_a]) = (by(step, 0.0), by(0.0, step));
        let (r, phi, _) = fields(radius, eta);
        let y = [r, r_r, r_a, phi_r, phi_a, w_r, w_a, stretch, twist];
        let frame = |angle: f64| nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), angle);
        let expected = frame(theta + twist * z + phi).inverse() * cartesian * frame(theta).matrix();
        assert!((deformation_gradient(&y, radius, TURN) - expected).abs().max() < 1e-9);
    }
}
