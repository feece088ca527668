use crate::{Closest, SolidState, tip_plate::Plate};
use actuator::{ModuleState, PoseChart, Wrench};
use std::fmt;

/// Where every point of a module of solids is, and the pressures.
#[derive(Clone)]
pub struct SolidShape {
    pub(super) plate: Plate,
    /// Each FREE in its own frame, whose origin is where its axis meets the base plate.
    pub(super) frees: Vec<SolidState>,
    /// Gauge pressures, Pa.
    pub(super) pressures: Vec<f64>,
}

impl SolidShape {
    /// Tip pose in the chart that does not wrap.
    pub fn chart(&self) -> PoseChart {
        self.plate.chart()
    }

    /// Gauge pressures, Pa.
    pub fn pressures(&self) -> &[f64] {
        &self.pressures
    }

    /// Each FREE in its own frame, whose origin is where its axis meets the base plate.
    pub fn frees(&self) -> &[SolidState] {
        &self.frees
    }
}

impl fmt::Debug for SolidShape {
    /// The tip only: a hundred thousand numbers would bury an error's message.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut fields = f.debug_struct("SolidShape");
        fields.field("chart", &self.chart()).field("pressures", &self.pressures).finish_non_exhaustive()
    }
}

/// A converged equilibrium of a module of solids.
#[derive(Clone, Debug)]
pub struct SolidEquilibrium {
    /// The shape; what further states are continued from.
    pub shape: SolidShape,
    /// Pose, slope with respect to payload mass (per kg), stability, residual.
    pub state: ModuleState,
    /// Energy of the FREEs (strain energy minus pressure times enclosed volume) minus the work of weights and tip load, J.
    pub energy: f64,
    /// d(chart)/d(pressure) of each FREE, per Pa.
    pub pressure_jacobian: Vec<[f64; 6]>,
    /// Where two FREEs are nearest to each other; `None` of a single one.
    pub closest: Option<Closest>,
}

/// A module of solids whose plate is held in a pose.
#[derive(Clone, Debug)]
pub struct HeldPlate {
    /// The shape; what further ones are continued from.
    pub shape: SolidShape,
    /// What each FREE gives to the plate, about its centre, in the base frame: minus the gradient of its energy, its own weight among
    /// it, that of plate and payload not.
    pub wrenches: Vec<Wrench>,
    /// Change of these with the pressure of each FREE while the plate stays where it is, per Pa.
    pub wrench_slopes: Vec<Wrench>,
    /// Negative eigenvalues of the FREEs' tangents: 0 = none of them has buckled between the plates.
    pub negative_pivots: u32,
    /// Relative residual of the equilibrium.
    pub residual: f64,
    /// Energy, as that of an equilibrium, J.
    pub energy: f64,
}
