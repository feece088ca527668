use crate::chart_to_pose_jacobian;
use nalgebra::{Matrix3, Vector3, Vector6};
use rom::PoseEvaluation;

/// How the tip's position answers to the pressures at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dexterity {
    /// Yoshikawa's manipulability sqrt(det(J J^T)), m^3/Pa^3, of the Jacobian J (3 x FREEs, m/Pa) of the position; zero where some
    /// direction cannot be gone, as always with fewer than three FREEs.
    pub manipulability: f64,
    /// Greatest over least singular value of J; infinite where J has no rank of three.
    pub condition: f64,
}

impl Dexterity {
    /// Of an evaluation of a model.
    pub fn of(evaluation: &PoseEvaluation) -> Self {
        let to_pose = chart_to_pose_jacobian(&evaluation.chart);
        let squared: Matrix3<f64> = evaluation
            .jacobian
            .iter()
            .map(|column| {
                let moved: Vector3<f64> = (to_pose * Vector6::from(*column)).fixed_rows::<3>(0).into();
                moved * moved.transpose()
            })
            .sum();
        let values = squared.symmetric_eigenvalues();
        let (least, greatest) = (values.min(), values.max());
        // The least eigenvalue is known to rounding of the greatest.
        if least <= 1e-14 * greatest {
            return Dexterity { manipulability: 0.0, condition: f64::INFINITY };
        }
        Dexterity {
            manipulability: squared.determinant().max(0.0).sqrt(),
            condition: (greatest / least).sqrt(),
        }
    }
}
