use crate::{Dual, Real};

/// Position and rotation of the tip plate in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T> {
    /// Position of the plate's centre, m.
    pub position: [T; 3],
    /// Unit quaternion (w, x, y, z) from the plate's frame to the base frame.
    pub rotation: [T; 4],
}

impl<T: Real> Pose<T> {
    /// This motion after `inner`: where a frame placed by `inner` in this frame stands in the frame this one stands in.
    pub fn compose(&self, inner: &Pose<T>) -> Pose<T> {
        let turned = rotate(self.rotation, inner.position);
        let mut position = self.position;
        for (sum, by) in position.iter_mut().zip(turned) {
            *sum += by;
        }
        Pose { position, rotation: product(self.rotation, inner.rotation) }
    }
}

/// Product of two quaternions (w, x, y, z).
pub(crate) fn product<T: Real>([w, x, y, z]: [T; 4], [a, b, c, d]: [T; 4]) -> [T; 4] {
    [
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    ]
}

/// A vector turned by a unit quaternion: v + 2 w (u x v) + 2 u x (u x v).
fn rotate<T: Real>([w, i, j, k]: [T; 4], [x, y, z]: [T; 3]) -> [T; 3] {
    let two = T::constant(2.0);
    let [a, b, c] = [two * (j * z - k * y), two * (k * x - i * z), two * (i * y - j * x)];
    [x + w * a + j * c - k * b, y + w * b + k * a - i * c, z + w * c + i * b - j * a]
}

/// cos(t/2) and sin(t/2)/t of a squared angle t^2 (rad^2), smooth at nought.
pub(crate) fn half_angle<T: Real>(square: T) -> (T, T) {
    // Up to a tenth of a radian by the series in t^2, whose next terms are below 1e-17.
    if square < T::constant(1e-2) {
        let series = |terms: [f64; 5]| {
            terms.into_iter().rev().fold(T::ZERO, |sum, term| sum * square + T::constant(term))
        };
        (
            series([1.0, -1.0 / 8.0, 1.0 / 384.0, -1.0 / 46_080.0, 1.0 / 10_321_920.0]),
            series([0.5, -1.0 / 48.0, 1.0 / 3840.0, -1.0 / 645_120.0, 1.0 / 185_794_560.0]),
        )
    } else {
        let angle = square.sqrt();
        let half = T::constant(0.5) * angle;
        (half.cos(), half.sin() / angle)
    }
}

/// The pose of a chart (twist, bend x, bend y, rad; x, y, z, m): `R = Rz(twist/2) exp([bend_x, bend_y, 0]x) Rz(twist/2)`,
/// `position = Rz(twist/2) (x, y, z)`. The chart does not wrap: twist counts whole turns.
///
/// As a quaternion R is (cos(b/2) cos(t/2), sin(b/2) bend/b, cos(b/2) sin(t/2)), b = |bend|, t = twist.
pub fn pose<T: Real>([twist, bend_x, bend_y, x, y, z]: [T; 6]) -> Pose<T> {
    let half = T::constant(0.5) * twist;
    let (cosine, sine) = (half.cos(), half.sin());
    let (w, per_angle) = half_angle(bend_x * bend_x + bend_y * bend_y);
    Pose {
        position: [cosine * x - sine * y, sine * x + cosine * y, z],
        rotation: [w * cosine, per_angle * bend_x, per_angle * bend_y, w * sine],
    }
}

/// A pose in dual numbers as a pose and its derivatives: `columns[k]` is the one with respect to the number `k`, the position's rate (m)
/// and then the angular rate in the plate's frame, `R^T dR = [omega]x` (rad).
pub fn split<T: Real, const N: usize>(dual: &Pose<Dual<T, N>>) -> (Pose<T>, [[T; 6]; N]) {
    let rotation = dual.rotation.map(|number| number.value);
    let [w, x, y, z] = rotation;
    let two = T::constant(2.0);
    let mut columns = [[T::ZERO; 6]; N];
    for (k, column) in columns.iter_mut().enumerate() {
        // omega = 2 conj(q) dq, whose scalar part is nought.
        let rate = product([w, -x, -y, -z], dual.rotation.map(|number| number.slopes[k]));
        let [px, py, pz] = dual.position.map(|number| number.slopes[k]);
        *column = [px, py, pz, two * rate[1], two * rate[2], two * rate[3]];
    }
    (Pose { position: dual.position.map(|number| number.value), rotation }, columns)
}

/// The numbers of a chart, each differentiated by itself.
pub fn variables<T: Real>(chart: [T; 6]) -> [Dual<T, 6>; 6] {
    core::array::from_fn(|k| Dual::variable(chart[k], k))
}

/// The pose of a chart and its derivatives with respect to the chart's numbers, see `split`.
pub fn pose_jacobian<T: Real>(chart: [T; 6]) -> (Pose<T>, [[T; 6]; 6]) {
    split(&pose(variables(chart)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Charts with more than a turn, no bend, a small and a large bend.
    const CHARTS: [[f64; 6]; 5] = [
        [7.5, 0.4, -0.9, 0.02, -0.03, 0.17],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.175],
        [-3.1, 1e-3, 2e-3, 0.01, 0.0, 0.18],
        [1.0, -2.1, 1.4, 0.05, 0.06, 0.02],
        [2.0, 0.0999, 0.0, 0.05, 0.06, 0.02],
    ];

    #[test]
    fn derivatives_are_those_of_differences() {
        for chart in CHARTS {
            let (here, columns) = pose_jacobian(chart);
            assert_eq!(here, pose(chart));
            let length: f64 = here.rotation.iter().map(|number| number * number).sum();
            assert!((length - 1.0).abs() < 1e-14);
            for (k, column) in columns.iter().enumerate() {
                let at = |by: f64| {
                    let mut moved = chart;
                    moved[k] += by;
                    pose(moved)
                };
                let (h, [w, x, y, z]) = (1e-6, here.rotation);
                let (ahead, behind) = (at(h), at(-h));
                for ((after, before), expected) in ahead.position.iter().zip(behind.position).zip(column) {
                    assert!(((after - before) / (2.0 * h) - expected).abs() < 1e-9);
                }
                let change: [f64; 4] =
                    core::array::from_fn(|i| (ahead.rotation[i] - behind.rotation[i]) / (2.0 * h));
                let rate = product([w, -x, -y, -z], change);
                assert!(rate[0].abs() < 1e-9);
                for (angular, expected) in rate[1..].iter().zip(&column[3..]) {
                    assert!((2.0 * angular - expected).abs() < 1e-8, "{chart:?} {k}");
                }
            }
        }
    }

    #[test]
    fn series_and_closed_form_meet() {
        for square in [9.999e-3, 1.0001e-2] {
            let (cosine, sine) = half_angle(square);
            let angle = libm::sqrt(square);
            assert!((cosine - libm::cos(0.5 * angle)).abs() < 1e-15);
            assert!((sine - libm::sin(0.5 * angle) / angle).abs() < 1e-15);
        }
    }

    #[test]
    fn a_frame_in_a_frame_is_where_both_motions_bring_it() {
        // A quarter turn about x, then the plate's own z axis points along -y.
        let root = libm::sqrt(0.5);
        let turned = Pose { position: [0.01, 0.0, 0.0], rotation: [root, root, 0.0, 0.0] };
        let moved = turned.compose(&pose([0.0, 0.0, 0.0, 0.0, 0.0, 0.175]));
        for (value, expected) in moved.position.into_iter().zip([0.01, -0.175, 0.0]) {
            assert!((value - expected).abs() < 1e-15);
        }
        assert_eq!(moved.rotation, turned.rotation);
    }
}
