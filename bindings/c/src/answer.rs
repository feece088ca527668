//! What a model answers, in the structures of `freeact.h`.

use crate::{Code, Model};
use bytemuck::Pod;
use evaluator::{FreeEvaluation, MAX_AXES, Real, TipEvaluation};

/// Tip pose and derivatives: `freeact_pose_f64` and `freeact_pose_f32`.
#[repr(C)]
pub struct Pose<T> {
    position_m: [T; 3],
    rotation_wxyz: [T; 4],
    jacobian: [[T; 6]; MAX_AXES],
    answered_pa: [T; MAX_AXES],
}

/// Deformation and derivatives: `freeact_deformation_f64` and `freeact_deformation_f32`.
#[repr(C)]
pub struct Deformation<T> {
    axial_stretch: T,
    expansion: T,
    twist_per_length_rad_m: T,
    jacobian: [[T; 3]; 3],
}

/// Refuses a step that time cannot make.
fn check_step<T: Real>(step: T) -> Result<(), Code> {
    if !step.is_finite() {
        Err(Code::NotFinite)
    } else if step < T::ZERO {
        Err(Code::NegativeStep)
    } else {
        Ok(())
    }
}

impl<T: Real + Pod> Model<T> {
    /// Numbers of memory that the effects need.
    pub fn memory(&self) -> usize {
        self.image().effects.chain().memory()
    }

    /// Commands to pressures in the FREEs, in place.
    pub fn supply(&self, memory: &mut [T], step: T, pressures: &mut [T]) -> Result<(), Code> {
        check_step(step)?;
        self.image().effects.chain().supply(memory, step, pressures);
        Ok(())
    }

    /// Pressures read to pressures in the FREEs, in place.
    pub fn unread(&self, pressures: &mut [T]) {
        self.image().effects.chain().unread_pressures(pressures);
    }

    /// Tip pose at pressures in the FREEs.
    pub fn tip(&self, memory: &mut [T], step: T, pressures: &[T]) -> Result<Pose<T>, Code> {
        check_step(step)?;
        let TipEvaluation { pose, jacobian, answered } =
            self.module()?.evaluate(&self.image().effects.chain(), memory, step, pressures)?;
        let (position_m, rotation_wxyz) = (pose.position, pose.rotation);
        Ok(Pose { position_m, rotation_wxyz, jacobian, answered_pa: answered })
    }

    /// Deformation of a FREE at a pressure in it, a winding angle and a shear modulus.
    pub fn deformation(
        &self,
        memory: &mut [T],
        step: T,
        [pressure, angle, modulus]: [T; 3],
    ) -> Result<Deformation<T>, Code> {
        check_step(step)?;
        let chain = self.image().effects.chain();
        let FreeEvaluation { axial_stretch, expansion, twist_per_length, jacobian } =
            self.free()?.evaluate_after(&chain, memory, step, pressure, angle, modulus)?;
        Ok(Deformation { axial_stretch, expansion, twist_per_length_rad_m: twist_per_length, jacobian })
    }

    /// How far every pressure may change at once, Pa.
    pub fn clearance(&self, pressures: &[T]) -> Result<T, Code> {
        Ok(self.module()?.splines.clearance(pressures))
    }

    /// Error bars of position (m) and rotation (rad).
    pub fn error_bars(&self, pressures: &[T]) -> Result<[T; 2], Code> {
        self.module()?.splines.error_bars(pressures).ok_or(Code::NoErrorBars)
    }

    /// Greatest pressure (Pa) of a FREE at a winding angle and a shear modulus.
    pub fn greatest_pressure(&self, angle: T, modulus: T) -> Result<T, Code> {
        Ok(self.free()?.greatest_pressure(angle, modulus)?)
    }
}
