use crate::rigid_motion::{Frame, exponential_coefficients};
use actuator::PoseChart;
use nalgebra::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};

/// Coordinates of the tip plate: x, y, z in the base frame, bend x, bend y, twist, with rotation
/// `Rz(twist/2) exp(bend) Rz(twist/2)`: the pose chart's rotation, so the twist counts whole turns, and locking a
/// coordinate means the same on every path. Regular while the bend stays below pi (or, with the twist locked, below 2 pi).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plate(pub Vector6<f64>);

/// How the plate's own frame moves with its coordinates.
pub(crate) struct PlateVariation {
    /// xi = first dq.
    pub first: Matrix6<f64>,
    rotation: Matrix3<f64>,
    /// Rotation vectors (own frame) per bend x, bend y, twist.
    turns: [Vector3<f64>; 3],
    /// Second derivatives of the rotation vector, by pairs of bend x, bend y, twist.
    second: [[Vector3<f64>; 3]; 3],
}

fn half_turn(twist: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.5 * twist)
}

impl Plate {
    /// Plate at rest at a height (m).
    pub fn at_height(height: f64) -> Self {
        Plate(Vector6::new(0.0, 0.0, height, 0.0, 0.0, 0.0))
    }

    /// Plate at a pose.
    pub fn at_chart(chart: &PoseChart) -> Self {
        let PoseChart { twist, bend, position } = *chart;
        let [x, y, z] = (half_turn(twist) * Vector3::from(position)).into();
        Plate(Vector6::new(x, y, z, bend[0], bend[1], twist))
    }

    pub fn position(&self) -> Vector3<f64> {
        self.0.fixed_rows::<3>(0).into()
    }

    fn bend(&self) -> Vector3<f64> {
        Vector3::new(self.0[3], self.0[4], 0.0)
    }

    pub fn frame(&self) -> Frame {
        let half = half_turn(self.0[5]);
        let rotation = half * UnitQuaternion::from_scaled_axis(self.bend()) * half;
        Frame { rotation, position: self.position() }
    }

    pub fn chart(&self) -> PoseChart {
        let twist = self.0[5];
        let position = half_turn(-twist) * self.position();
        PoseChart { twist, bend: [self.0[3], self.0[4]], position: position.into() }
    }

    /// Derivative of the chart (order of its array) along a derivative of the coordinates.
    pub fn chart_slope(&self, slope: &Vector6<f64>) -> [f64; 6] {
        let back = half_turn(-self.0[5]);
        let moved: Vector3<f64> = slope.fixed_rows::<3>(0).into();
        let position = back * moved - Vector3::z().cross(&(back * self.position())) * (0.5 * slope[5]);
        [slope[5], slope[3], slope[4], position.x, position.y, position.z]
    }

    pub fn vary(&self) -> PlateVariation {
        let rotation: Matrix3<f64> = self.frame().rotation.to_rotation_matrix().into_inner();
        let back: Matrix3<f64> = half_turn(-self.0[5]).to_rotation_matrix().into_inner();
        let bend = self.bend();
        let [a, b, a1, b1] = exponential_coefficients(bend.norm_squared());
        let (hat, z) = (bend.cross_matrix(), Vector3::z());
        // J_r = 1 - A b^ + B b^^2
        let right = Matrix3::identity() - hat * a + hat * hat * b;
        let normal = rotation.transpose() * z;
        let turns = [back * right * Vector3::x(), back * right * Vector3::y(), (normal + z) * 0.5];
        let mut second = [[Vector3::zeros(); 3]; 3];
        let slope = |i: usize| {
            let unit = Vector3::ith(i, 1.0).cross_matrix();
            let along = 2.0 * bend[i];
            hat * (-a1 * along) - unit * a + hat * hat * (b1 * along) + (unit * hat + hat * unit) * b
        };
        // d2(xi)/dq_i dq_j is the symmetric part of d(turn_j)/dq_i.
        for i in 0..2 {
            for (j, pair) in second[i].iter_mut().take(2).enumerate() {
                *pair = back * (slope(i) * Vector3::ith(j, 1.0) + slope(j) * Vector3::ith(i, 1.0)) * 0.5;
            }
            second[i][2] = (turns[i].cross(&normal) + z.cross(&turns[i])) * -0.25;
            second[2][i] = second[i][2];
        }
        second[2][2] = turns[2].cross(&normal) * -0.5;
        let mut first = Matrix6::zeros();
        first.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation.transpose());
        for (j, turn) in turns.iter().enumerate() {
            first.fixed_view_mut::<3, 1>(3, 3 + j).copy_from(turn);
        }
        PlateVariation { first, rotation, turns, second }
    }
}

impl PlateVariation {
    /// Second derivative in the coordinates of an energy with gradient `g` and second derivative `k` along the plate's own
    /// motions: P^T k P + sum_k g_k d2(xi_k)/dq dq.
    pub fn hessian(&self, g: &Vector6<f64>, k: &Matrix6<f64>) -> Matrix6<f64> {
        let mut hessian = self.first.transpose() * k * self.first;
        let force: Vector3<f64> = g.fixed_rows::<3>(0).into();
        let moment: Vector3<f64> = g.fixed_rows::<3>(3).into();
        for j in 0..3 {
            // log of (shift, rotation w) has the translation shift - w x shift/2.
            let cross = self.rotation * force.cross(&self.turns[j]) * -0.5;
            for i in 0..3 {
                hessian[(i, 3 + j)] += cross[i];
                hessian[(3 + j, i)] += cross[i];
                hessian[(3 + i, 3 + j)] += moment.dot(&self.second[i][j]);
            }
        }
        hessian
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLATES: [[f64; 6]; 3] = [
        [0.0, 0.0, 0.2, 0.0, 0.0, 0.0],
        [0.01, -0.02, 0.2, 0.3, -0.4, 1.1],
        [0.03, 0.02, 0.1, 1.4, 1.2, -8.0],
    ];

    #[test]
    fn variation_matches_the_motion() {
        let g = Vector6::new(0.4, -1.0, 0.3, 0.2, 0.9, -0.5);
        for q in PLATES {
            let plate = Plate(q.into());
            let (vary, start) = (plate.vary(), plate.frame());
            // g . xi(dq) has gradient P^T g and second derivative `hessian(g, 0)`. Step 1e-3 of fourth order: 1e-12, and
            // 1e-16/1e-6 for the second derivatives.
            let h = 1e-3;
            let along = |dq: Vector6<f64>| g.dot(&start.log_to(&Plate(plate.0 + dq).frame()));
            let unit = |i: usize| Vector6::ith(i, h);
            let hessian = vary.hessian(&g, &Matrix6::zeros());
            for i in 0..6 {
                let slope = (along(-unit(i) * 2.0) - 8.0 * along(-unit(i)) + 8.0 * along(unit(i))
                    - along(unit(i) * 2.0))
                    / (12.0 * h);
                assert!((slope - (vary.first.transpose() * g)[i]).abs() < 1e-10);
                for j in 0..6 {
                    let mixed = |s: f64| {
                        (along((unit(i) + unit(j)) * s)
                            - along((unit(i) - unit(j)) * s)
                            - along((unit(j) - unit(i)) * s)
                            + along((unit(i) + unit(j)) * -s))
                            / (4.0 * h * h * s * s)
                    };
                    let difference = (4.0 * mixed(1.0) - mixed(2.0)) / 3.0;
                    assert!(
                        (difference - hessian[(i, j)]).abs() < 1e-7,
                        "{q:?} {i} {j}: {difference} {}",
                        hessian[(i, j)]
                    );
                }
            }
        }
    }

    #[test]
    fn chart_is_the_frames_and_varies_with_it() {
        for q in PLATES {
            let plate = Plate(q.into());
            let frame = plate.frame();
            let pose = plate.chart().to_pose();
            assert!((pose.position - frame.position).amax() < 1e-14);
            assert!(pose.rotation.angle_to(&frame.rotation) < 1e-7);
            assert!((Plate::at_chart(&plate.chart()).0 - plate.0).amax() < 1e-14);
            let slope = Vector6::new(0.3, -0.2, 0.5, 0.7, 0.1, -0.6);
            let h = 1e-5;
            let [ahead, behind] = [h, -h].map(|s| Plate(plate.0 + slope * s).chart().to_array());
            let exact = plate.chart_slope(&slope);
            for k in 0..6 {
                assert!(((ahead[k] - behind[k]) / (2.0 * h) - exact[k]).abs() < 1e-9);
            }
        }
    }
}
