use crate::arrays;
use evaluator::{FreeEvaluation, OutsideFree, OutsideModule, TipEvaluation};
use pyo3::prelude::*;

/// The model has an answer.
pub const OK: u8 = 0;
/// A pressure is outside the domain.
pub const OUTSIDE_PRESSURE: u8 = 1;
/// The pressures are beyond the stable states.
pub const UNSTABLE: u8 = 2;
/// The winding angle is outside the domain.
pub const OUTSIDE_ANGLE: u8 = 3;
/// The shear modulus is outside the domain.
pub const OUTSIDE_MODULUS: u8 = 4;

/// Answers of a module, row after row; NaN where there is none.
#[derive(Default)]
pub struct TipRows {
    positions: Vec<f64>,
    rotations: Vec<f64>,
    jacobians: Vec<f64>,
    status: Vec<u8>,
}

impl TipRows {
    /// Adds a row for a module of `frees` FREEs.
    pub fn push(&mut self, answer: &Result<TipEvaluation<f64>, OutsideModule<f64>>, frees: usize) {
        let (pose, jacobian) = match answer {
            Ok(found) => (found.pose, found.jacobian),
            Err(_) => {
                let none = evaluator::Pose { position: [f64::NAN; 3], rotation: [f64::NAN; 4] };
                (none, [[f64::NAN; 6]; evaluator::MAX_AXES])
            }
        };
        self.positions.extend(pose.position);
        self.rotations.extend(pose.rotation);
        self.jacobians.extend(jacobian[..frees].as_flattened());
        self.status.push(match answer {
            Ok(_) => OK,
            Err(OutsideModule::Pressure { .. }) => OUTSIDE_PRESSURE,
            Err(OutsideModule::Unstable { .. }) => UNSTABLE,
        });
    }

    /// The rows as arrays.
    pub fn arrays(&self, py: Python<'_>, lead: &[usize], frees: usize, jacobian: bool) -> PyResult<Tip> {
        Ok(Tip {
            position_m: arrays::doubles(py, &self.positions, lead, &[3])?.unbind(),
            rotation_wxyz: arrays::doubles(py, &self.rotations, lead, &[4])?.unbind(),
            jacobian: jacobian
                .then(|| arrays::doubles(py, &self.jacobians, lead, &[frees, 6]).map(Bound::unbind))
                .transpose()?,
            status: arrays::bytes(py, &self.status, lead)?.unbind(),
        })
    }
}

/// Answers of a FREE, row after row; NaN where there is none.
#[derive(Default)]
pub struct DeformationRows {
    values: [Vec<f64>; 3],
    jacobians: Vec<f64>,
    status: Vec<u8>,
}

impl DeformationRows {
    /// Adds a row.
    pub fn push(&mut self, answer: &Result<FreeEvaluation<f64>, OutsideFree<f64>>) {
        let none = [f64::NAN; 3];
        let (row, jacobian) = match answer {
            Ok(found) => ([found.axial_stretch, found.expansion, found.twist_per_length], found.jacobian),
            Err(_) => (none, [none; 3]),
        };
        for (values, value) in self.values.iter_mut().zip(row) {
            values.push(value);
        }
        self.jacobians.extend(jacobian.as_flattened());
        self.status.push(match answer {
            Ok(_) => OK,
            Err(OutsideFree::Pressure { .. }) => OUTSIDE_PRESSURE,
            Err(OutsideFree::WindingAngle { .. }) => OUTSIDE_ANGLE,
            Err(OutsideFree::ShearModulus { .. }) => OUTSIDE_MODULUS,
        });
    }

    /// The rows as arrays.
    pub fn arrays(&self, py: Python<'_>, shape: &[usize], jacobian: bool) -> PyResult<Deformation> {
        let [stretch, expansion, twist] = &self.values;
        let array = |values: &[f64]| arrays::doubles(py, values, shape, &[]).map(Bound::unbind);
        Ok(Deformation {
            axial_stretch: array(stretch)?,
            expansion: array(expansion)?,
            twist_per_length_rad_m: array(twist)?,
            jacobian: jacobian
                .then(|| arrays::doubles(py, &self.jacobians, shape, &[3, 3]).map(Bound::unbind))
                .transpose()?,
            status: arrays::bytes(py, &self.status, shape)?.unbind(),
        })
    }
}

/// Poses of a module's tip; NaN where `status` is not `freeact.OK`.
#[pyclass(frozen, get_all, module = "freeact")]
pub struct Tip {
    /// Centre of the tip plate, m, base frame: (..., 3).
    position_m: Py<PyAny>,
    /// Unit quaternion (w, x, y, z) from the plate's frame to the base frame: (..., 4).
    rotation_wxyz: Py<PyAny>,
    /// Rates per Pa of the pressure in each FREE: position (m, base frame), then angular rate (rad, plate's frame): (..., frees, 6).
    /// None unless it was asked for.
    jacobian: Option<Py<PyAny>>,
    /// OK, OUTSIDE_PRESSURE or UNSTABLE: (...).
    status: Py<PyAny>,
}

/// Deformation of a single FREE; NaN where `status` is not `freeact.OK`.
#[pyclass(frozen, get_all, module = "freeact")]
pub struct Deformation {
    /// Length over that at rest.
    axial_stretch: Py<PyAny>,
    /// Outer radius (of equal area) over that at rest.
    expansion: Py<PyAny>,
    /// Twist over the length at rest, rad/m, with the sign of the FREE's hand.
    twist_per_length_rad_m: Py<PyAny>,
    /// [..., input, output]: inputs pressure (Pa), winding angle (rad), shear modulus (Pa); outputs stretch, expansion, twist.
    /// None unless it was asked for.
    jacobian: Option<Py<PyAny>>,
    /// OK, OUTSIDE_PRESSURE, OUTSIDE_ANGLE or OUTSIDE_MODULUS.
    status: Py<PyAny>,
}
