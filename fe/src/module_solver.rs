use crate::{Equilibrium, RodError, RodModule, SolidEquilibrium, SolidModule, SolidModuleError};
use actuator::{MapParameter, ModuleState, PAYLOAD_STEP, PoseChart, payload_curvature};

/// Why a module has no state to show.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ModuleError {
    /// As rods.
    #[error(transparent)]
    Rods(#[from] RodError),
    /// As solids.
    #[error(transparent)]
    Solids(#[from] SolidModuleError),
}

/// A module that finds its equilibria one from the other, as rods or as solids.
pub trait ModuleSolver {
    /// What it finds; what the next one is followed from.
    type Found: Clone + Send + Sync;

    /// Parameters whose slopes its states carry, the payload first. A bending stiffness of their own, for a factor to act on, only rods have:
    /// in a solid it follows from rubber and fibres.
    const PARAMETERS: &'static [MapParameter];

    /// Equilibrium without pressure under weights and tip load.
    ///
    /// # Errors
    /// [`ModuleError`] where there is none.
    fn rest(&mut self) -> Result<Self::Found, ModuleError>;

    /// Equilibrium at the pressures (Pa), followed from another one.
    ///
    /// # Errors
    /// [`ModuleError`] where the path ends before.
    fn solve_from(&mut self, start: &Self::Found, pressures: &[f64]) -> Result<Self::Found, ModuleError>;

    /// Pose, slopes, stability, residual.
    fn state<'a>(&self, found: &'a Self::Found) -> &'a ModuleState;

    /// Tip pose with a further mass (kg) on the plate of an equilibrium.
    ///
    /// # Errors
    /// [`ModuleError`] where it cannot carry it.
    fn loaded(&mut self, start: &Self::Found, payload: f64) -> Result<PoseChart, ModuleError>;

    /// Parameters of the states of [`ModuleSolver::map_state`].
    fn map_parameters() -> Vec<MapParameter> {
        Self::PARAMETERS.iter().copied().chain([MapParameter::PayloadCurvature]).collect()
    }

    /// The state as it stands in a map: with how its pose departs from its slope at a payload.
    ///
    /// # Errors
    /// [`ModuleError`] where it cannot carry the payload.
    fn map_state(&mut self, found: &Self::Found) -> Result<ModuleState, ModuleError> {
        let step = PAYLOAD_STEP;
        let heavy = self.loaded(found, step)?.to_array();
        let mut state = self.state(found).clone();
        let (light, slope) = (state.chart.to_array(), state.slopes[0]);
        state
            .slopes
            .push(std::array::from_fn(|k| (heavy[k] - light[k] - slope[k] * step) / payload_curvature(step)));
        Ok(state)
    }
}

impl ModuleSolver for RodModule {
    type Found = Equilibrium;

    const PARAMETERS: &'static [MapParameter] = &[MapParameter::Payload, MapParameter::BendingStiffness];

    fn rest(&mut self) -> Result<Equilibrium, ModuleError> {
        Ok(RodModule::rest(self)?)
    }

    fn solve_from(&mut self, start: &Equilibrium, pressures: &[f64]) -> Result<Equilibrium, ModuleError> {
        Ok(RodModule::solve_from(self, start, pressures)?)
    }

    fn state<'a>(&self, found: &'a Equilibrium) -> &'a ModuleState {
        &found.state
    }

    fn loaded(&mut self, start: &Equilibrium, payload: f64) -> Result<PoseChart, ModuleError> {
        Ok(RodModule::loaded(self, start, payload)?)
    }
}

impl ModuleSolver for SolidModule {
    type Found = SolidEquilibrium;

    const PARAMETERS: &'static [MapParameter] = &[MapParameter::Payload];

    fn rest(&mut self) -> Result<SolidEquilibrium, ModuleError> {
        Ok(SolidModule::rest(self)?)
    }

    fn solve_from(
        &mut self,
        start: &SolidEquilibrium,
        pressures: &[f64],
    ) -> Result<SolidEquilibrium, ModuleError> {
        Ok(SolidModule::solve_from(self, &start.shape, pressures)?)
    }

    fn state<'a>(&self, found: &'a SolidEquilibrium) -> &'a ModuleState {
        &found.state
    }

    fn loaded(&mut self, start: &SolidEquilibrium, payload: f64) -> Result<PoseChart, ModuleError> {
        Ok(SolidModule::loaded(self, &start.shape, payload)?)
    }
}
