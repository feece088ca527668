use super::{SectionError, SectionSolver};
use actuator::Wrench;

/// What a FREE gives to plates that hold its ends at a stretch and a twist, far from its caps: its blocked force and torque.
///
/// They act on the tip's plate, along and about z: a positive force pushes it away from the base, a torque turns it like a positive
/// twist. In the limit of threads that do not stretch, on a tube that is not yet deformed, they are by virtual work
/// `F dl + M dphi = p dV` with `V = pi z (l^2 - z^2)/theta^2` inside a thread of length l that rises by z and turns by theta,
/// whatever an incompressible wall is made of and however thick it is:
/// `F = p pi B^2 (1 - 2 cot^2 g)` and `M = -p 2 pi B^3 cot g` for a right-handed winding, with g its angle **from the axis** and B its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockedSection {
    /// Gauge pressure, Pa.
    pub pressure: f64,
    /// Force and torque on the tip's plate: `-dPhi/dlambda` and `-dPhi/dtau`.
    pub wrench: Wrench,
    /// Their change with the pressure, per Pa, ends held.
    pub slope: Wrench,
}

impl SectionSolver {
    /// Blocked force and torque at a pressure (Pa), stretch and twist per reference length (rad/m), with the sign of the FREE's own hand.
    ///
    /// # Errors
    /// As of [`SectionSolver::respond`].
    pub fn blocked(
        &mut self,
        pressure: f64,
        axial_stretch: f64,
        twist_per_length: f64,
    ) -> Result<BlockedSection, SectionError> {
        let hand = self.free().winding.handedness.sign();
        let (response, slopes) = self.answer(pressure, axial_stretch, hand * twist_per_length)?;
        let along = |force: f64, torque: f64| Wrench {
            force: [0.0, 0.0, -force],
            moment: [0.0, 0.0, -hand * torque],
        };
        Ok(BlockedSection {
            pressure,
            wrench: along(response.force, response.torque),
            slope: along(slopes[0], slopes[1]),
        })
    }
}
