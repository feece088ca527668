use crate::{
    MAX_AXES, ModuleSplines, OutsideModule, Pose, Real, chart,
    effect::{Chain, Effect},
};

/// What a slope of a module's map is along. The numbers stand in images: they never change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadParameter {
    /// Mass m carried at the plate, kg, beyond the described one.
    Payload = 1,
    /// How the pose departs from that slope as m grows, by the factor m^2/(1 + |m|/M), kg^2.
    PayloadCurvature = 2,
    /// Factor on the bending stiffness, minus one.
    BendingStiffness = 3,
}

impl LoadParameter {
    /// The parameter of a number in an image.
    pub fn from_number(number: u32) -> Option<Self> {
        [Self::Payload, Self::PayloadCurvature, Self::BendingStiffness]
            .into_iter()
            .find(|parameter| *parameter as u32 == number)
    }
}

/// Greatest number of parameters that a module's splines have slopes along.
pub const MAX_PARAMETERS: usize = 8;

/// A module's splines with what effects need beyond them: pressures to tip pose as it is read.
#[derive(Clone, Debug, PartialEq)]
pub struct TipModel<T, R> {
    /// The splines.
    pub splines: ModuleSplines<T, R>,
    /// What the splines' slopes are along, in order; `None` for what this version does not know.
    pub parameters: [Option<LoadParameter>; MAX_PARAMETERS],
    /// Mass (kg) that stretches and straightens the described module already.
    pub hanging_mass: T,
    /// The mass M (kg) of [`LoadParameter::PayloadCurvature`].
    pub payload_step: T,
}

/// Tip pose and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipEvaluation<T> {
    /// The pose as it is read.
    pub pose: Pose<T>,
    /// `jacobian[free]` = the pose's rate per Pa of the pressure in a FREE: position (m), then the angular rate in the plate's frame (rad).
    /// What an effect remembers of the past is held fixed.
    pub jacobian: [[T; 6]; MAX_AXES],
    /// The pressures (Pa) that the splines answered, after the effects: those at which clearance and error bars are to be looked up.
    pub answered: [T; MAX_AXES],
}

impl<T: Real, R: AsRef<[T]>> TipModel<T, R> {
    /// The tip pose at the end of `step` seconds at these pressures in the FREEs (Pa); the effects' memory goes on with it.
    ///
    /// # Errors
    /// Where the model has no answer; the memory has then gone on all the same.
    ///
    /// # Panics
    /// When there are not as many pressures as FREEs, or `memory` is shorter than [`Chain::memory`].
    pub fn evaluate<'e, I>(
        &self,
        chain: &Chain<I>,
        memory: &mut [T],
        step: T,
        pressures: &[T],
    ) -> Result<TipEvaluation<T>, OutsideModule<T>>
    where
        T: 'e,
        I: Iterator<Item = Effect<'e, T>> + Clone,
    {
        let frees = self.splines.domain().len();
        let (mut answered, mut gains) = ([T::ZERO; MAX_AXES], [T::ONE; MAX_AXES]);
        answered[..frees].copy_from_slice(pressures);
        chain.deform_with_gains(memory, step, &mut answered[..frees], &mut gains[..frees]);
        let loads = chain.loads(self.hanging_mass);
        let weight = loads.mass.greater(-loads.mass);
        let curvature = loads.mass * loads.mass / (T::ONE + weight / self.payload_step);
        let mut factors = [T::ZERO; MAX_PARAMETERS];
        for (factor, parameter) in factors.iter_mut().zip(self.parameters) {
            *factor = match parameter {
                Some(LoadParameter::Payload) => loads.mass,
                Some(LoadParameter::PayloadCurvature) => curvature,
                Some(LoadParameter::BendingStiffness) => loads.bending_stiffness,
                None => T::ZERO,
            };
        }
        let factors = &factors[..self.splines.parameters()];
        let (mut chart, mut by_pressure) = ([T::ZERO; 6], [[T::ZERO; 6]; MAX_AXES]);
        self.splines.evaluate_loaded(&answered[..frees], factors, &mut chart, &mut by_pressure[..frees])?;
        let bent = chain.bend(chart::variables(chart));
        let (pose, columns) = chart::split(&chain.read_pose(&chart::pose(bent)));
        let mut jacobian = [[T::ZERO; 6]; MAX_AXES];
        for ((row, slopes), gain) in jacobian.iter_mut().zip(by_pressure).zip(gains) {
            for (column, slope) in columns.iter().zip(slopes) {
                for (sum, rate) in row.iter_mut().zip(column) {
                    *sum += gain * slope * *rate;
                }
            }
        }
        Ok(TipEvaluation { pose, jacobian, answered })
    }
}
