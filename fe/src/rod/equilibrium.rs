use super::{
    chain::{Chain, Condensed},
    module::RodModule,
    path::Loads,
};
use crate::{
    NoEquilibrium,
    contact::Closest,
    rigid_motion::Frame,
    tip_plate::{Plate, in_kpa},
};
use actuator::{ModuleState, PoseChart, Wrench};
use nalgebra::{Vector3, Vector6};
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
    /// The two FREEs whose surfaces are nearest; `None` of a single FREE.
    pub closest: Option<Closest>,
    /// What each FREE gives to the tip plate, about the plate's centre, in the base frame: minus the gradient of its energy, its own
    /// weight among it, that of plate and payload not. With spacers the FREEs act together: one wrench for all.
    pub wrenches: Vec<Wrench>,
    /// Change of these with the pressure of each FREE while the plate stays where it is, per Pa.
    pub wrench_slopes: Vec<Wrench>,
}

impl Equilibrium {
    /// The error of one whose tangent has no factors.
    pub(super) fn without_factors(&self) -> RodError {
        NoEquilibrium::there(&self.pressures, f64::INFINITY, self.configuration.clone()).into()
    }
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
    #[error(transparent)]
    NoEquilibrium(#[from] NoEquilibrium<Configuration>),
    /// A tip that is bent further than the chart of poses reaches.
    #[error("the module at {} kPa comes to rest with its tip bent by {:.0} deg, beyond the 180 deg that a pose can tell (and where FREEs and plates would meet); stay below these pressures", in_kpa(pressures), bend.to_degrees())]
    BentOver {
        /// Pressures, Pa.
        pressures: Vec<f64>,
        /// The bend, rad.
        bend: f64,
        /// Its shape, whose pose is not to be trusted.
        last: Box<Configuration>,
    },
    /// A section is stretched or twisted beyond what its law was made for.
    #[error("FREE {} at {:.2} kPa is stretched to {axial_stretch:.4} and twisted by {twist_per_length:.2} rad/m (right-handed), outside its section law; stay below these pressures", free + 1, pressure / 1e3)]
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

impl RodModule {
    /// Checks a converged shape and takes its derivatives.
    pub(super) fn finish(&self, shape: Configuration, loads: &Loads) -> Result<Equilibrium, RodError> {
        let chains = self.chains(loads.part);
        let frame = shape.plate.frame();
        for (chain, inner) in chains.iter().zip(&shape.inner) {
            let frames: Vec<Frame> = chain.frames(inner, &frame).collect();
            for (member, pair) in
                chain.members.iter().flat_map(|m| frames.windows(2).map(move |pair| (m, pair)))
            {
                let between = member.frame(&pair[0]).log_to(&member.frame(&pair[1]));
                let [axial_stretch, twist_per_length] = member.law.strain(&between);
                let (free, pressure) = (member.free, loads.pressures[member.free]);
                if !self.laws[free].section.covers(pressure, axial_stretch, twist_per_length) {
                    let last = Box::new(shape);
                    return Err(RodError::OutsideSectionLaw {
                        free,
                        pressure,
                        axial_stretch,
                        twist_per_length,
                        last,
                    });
                }
            }
        }
        let singular = || NoEquilibrium::there(&loads.pressures, f64::INFINITY, shape.clone());
        let system = self.assemble(&chains, &shape, loads, true).ok_or_else(singular)?;
        let factored = self.factorise(&chains, &shape, &system).ok_or_else(singular)?;
        let slope =
            |load: Vector6<f64>| shape.plate.chart_slope(&-(factored.inverse * self.tip.free_part(load)));
        let column = |index: usize, chain: &Condensed| -> Vector6<f64> {
            factored.plate.first.transpose() * chain.columns.column(index)
        };
        let slopes = [
            slope(-self.tip.load_per_payload),
            slope(factored.condensed.iter().map(|chain| column(Chain::BENDING_COLUMN, chain)).sum()),
        ];
        let mut pressure_jacobian = vec![[0.0; 6]; self.laws.len()];
        let mut wrench_slopes = vec![Wrench::default(); self.laws.len()];
        // The gradient is that for motions of the plate in its own directions; what the FREEs give is minus it.
        let on_plate = |gradient: Vector6<f64>| {
            let turned = |first: usize| -(frame.rotation * Vector3::from(gradient.fixed_rows::<3>(first)));
            Wrench { force: turned(0).into(), moment: turned(3).into() }
        };
        for (chain, condensed) in chains.iter().zip(&factored.condensed) {
            for (place, member) in chain.members.iter().enumerate() {
                let by_pressure = Chain::pressure_column(place);
                pressure_jacobian[member.free] = slope(column(by_pressure, condensed));
                wrench_slopes[member.free] = on_plate(condensed.columns.column(by_pressure).into());
            }
        }
        let given = factored.condensed.iter().map(|chain| on_plate(chain.columns.column(0).into()));
        let wrenches = given.collect();
        let closest = self.closest(&shape, loads);
        let state = ModuleState {
            chart: shape.chart(),
            slopes: slopes.to_vec(),
            negative_pivots: factored.negative,
            residual: system.residual,
            gap: closest.map(|closest| closest.gap),
        };
        Ok(Equilibrium {
            pressures: loads.pressures.clone(),
            configuration: shape,
            state,
            energy: system.energy,
            pressure_jacobian,
            closest,
            wrenches,
            wrench_slopes,
        })
    }
}
