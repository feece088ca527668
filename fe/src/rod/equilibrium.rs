use super::{motion::Frame, plate::Plate};
use actuator::{ModuleState, PoseChart};
use std::fmt;

/// Where every cross-section of a module is.
#[derive(Clone)]
pub struct Configuration {
    pub(super) plate: Plate,
    /// Inner nodes of each FREE, from the base up.
    pub(super) inner: Vec<Vec<Frame>>,
}

impl Configuration {
    /// Tip pose in the chart that does not wrap.
    pub fn chart(&self) -> PoseChart {
        self.plate.chart()
    }
}

impl fmt::Debug for Configuration {
    /// The tip only: hundreds of numbers would bury an error's message.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Configuration").field("chart", &self.chart()).finish_non_exhaustive()
    }
}

/// A converged equilibrium.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Gauge pressures, Pa.
    pub pressures: Vec<f64>,
    /// The shape; what further states are continued from.
    pub configuration: Configuration,
    /// Pose, slopes with respect to payload mass (per kg) and bending stiffness factor, stability, residual.
    pub state: ModuleState,
    /// Energy of the FREEs (strain energy minus pressure times enclosed volume) minus the work of weights and tip load, J.
    pub energy: f64,
    /// d(chart)/d(pressure) of each FREE, per Pa.
    pub pressure_jacobian: Vec<[f64; 6]>,
}

/// Why a module has no equilibrium to show.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RodError {
    /// The solver was set up with something that cannot be.
    #[error("{what}: {value}; {remedy}")]
    Setup {
        /// The setting.
        what: &'static str,
        /// What it was.
        value: f64,
        /// What to do.
        remedy: &'static str,
    },
    /// Another number of pressures or laws than of FREEs, or a pressure that is not finite.
    #[error("{given} {what} for {needed} FREEs; give one finite number or law for each FREE")]
    Count {
        /// What was counted.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many FREEs there are.
        needed: usize,
    },
    /// Newton's method did not converge however short the step.
    #[error(
        "no equilibrium found on the way to {} kPa: the path from rest ends at {} kPa (residual {residual:.1e}); a limit pressure or a sharp buckling is near",
        in_kpa(goal),
        in_kpa(reached)
    )]
    NoEquilibrium {
        /// Pressures asked for, Pa.
        goal: Vec<f64>,
        /// Pressures of the last equilibrium on the way, Pa.
        reached: Vec<f64>,
        /// Least relative residual of the failed step.
        residual: f64,
        /// Shape of the last equilibrium on the way.
        last: Box<Configuration>,
    },
    /// A section is stretched or twisted beyond what its law was made for.
    #[error("FREE {} at {:.2} kPa is stretched to {axial_stretch:.4} and twisted by {twist_per_length:.2} rad/m (right-handed), outside its section law (which ends at the FREE's own limit pressure); stay below these pressures", free + 1, pressure / 1e3)]
    OutsideSectionLaw {
        /// Index of the FREE.
        free: usize,
        /// Its pressure, Pa.
        pressure: f64,
        /// Stretch of the element.
        axial_stretch: f64,
        /// Twist per length of the element, as a right-handed winding, rad/m.
        twist_per_length: f64,
        /// Shape of the equilibrium, which is not to be trusted.
        last: Box<Configuration>,
    },
}

fn in_kpa(pressures: &[f64]) -> String {
    let words: Vec<String> = pressures.iter().map(|p| format!("{:.3}", p / 1e3)).collect();
    format!("({})", words.join(", "))
}
