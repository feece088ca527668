use super::pivots::InvertedBlock;
use actuator::{Module, units::STANDARD_GRAVITY};
use nalgebra::{Matrix6, Vector3, Vector6};

/// A constant load on the tip plate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TipLoad {
    /// Force on the plate's centre in the base frame, N.
    pub force: [f64; 3],
    /// Moments that do work on bend x, bend y and twist of the pose chart, N m: in a plane motion the moment about that axis.
    /// (A moment of constant direction in space would have no energy.)
    pub moment: [f64; 3],
}

/// What acts on a module's tip plate beside its FREEs, and which of its coordinates may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GuidedPlate {
    /// Generalised forces on the coordinates: weight of plate and payload, tip load.
    pub load: Vector6<f64>,
    /// Those of a further kilogram of payload.
    pub load_per_payload: Vector6<f64>,
    /// Coordinates that may move.
    pub free: [bool; 6],
}

impl GuidedPlate {
    pub fn new(module: &Module, tip_load: &TipLoad) -> Self {
        let gravity = Vector3::from(module.base.gravity) * STANDARD_GRAVITY;
        let load_per_payload = Vector6::new(gravity.x, gravity.y, gravity.z, 0.0, 0.0, 0.0);
        let ([fx, fy, fz], [mx, my, mz]) = (tip_load.force, tip_load.moment);
        let mass = module.tip.plate_mass + module.tip.payload;
        let load = load_per_payload * mass + Vector6::new(fx, fy, fz, mx, my, mz);
        GuidedPlate { load, load_per_payload, free: module.tip.free_dof }
    }

    /// Generalised forces on the coordinates when a part of all acts, and a further payload (kg) is on the plate.
    pub fn acting(&self, part: f64, payload: f64) -> Vector6<f64> {
        (self.load + self.load_per_payload * payload) * part
    }

    /// Zero in the coordinates that are held.
    pub fn free_part(&self, mut vector: Vector6<f64>) -> Vector6<f64> {
        for (value, free) in vector.iter_mut().zip(self.free) {
            if !free {
                *value = 0.0;
            }
        }
        vector
    }

    /// Inverse and negative pivots of a second derivative of the energy with the held coordinates taken out; `None` where it is singular.
    pub fn inverted(&self, hessian: &Matrix6<f64>) -> Option<InvertedBlock> {
        let mut hessian = *hessian;
        for (i, free) in self.free.into_iter().enumerate() {
            if !free {
                hessian.row_mut(i).fill(0.0);
                hessian.column_mut(i).fill(0.0);
                hessian[(i, i)] = 1.0;
            }
        }
        InvertedBlock::new(&hessian)
    }
}
