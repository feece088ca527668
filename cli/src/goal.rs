//! What `solve` and `track` need of a model: the module, the pressures that may be used, the pose at given pressures.

use crate::{
    failure::Failure,
    tip_model::{self, TipModel},
    values::Values,
};
use actuator::units::KPA;
use control::Bounds;
use rom::{Model, ModuleModel, PoseModel, effect::Chain};
use std::path::Path;

/// The module of a model, ready to be steered.
pub struct Steered<'m> {
    name: &'m str,
    module: &'m ModuleModel,
    effects: &'m Chain,
}

/// The module of a model; `path` is for messages.
pub fn module_of<'m>(model: &'m Model, path: &Path) -> Result<Steered<'m>, Failure> {
    match model.as_module() {
        Some(module) => {
            let left_out = tip_model::left_out(&model.effects);
            if !left_out.is_empty() {
                eprintln!(
                    "{}: {} left out, as a pose that is held does not depend on it",
                    path.display(),
                    left_out.join(", ")
                );
            }
            Ok(Steered { name: &model.provenance.description_name, module, effects: &model.effects })
        }
        None => Err(Failure::usage(format!(
            "{}: is the model of a single FREE, which has no tip pose to steer; give the model of a module",
            path.display()
        ))),
    }
}

impl<'m> Steered<'m> {
    /// Pressures to pose.
    pub fn tip(&self) -> TipModel<'m> {
        TipModel::new(self.module, self.effects)
    }

    /// Its name.
    pub fn name(&self) -> &str {
        self.name
    }

    /// What 95 of 100 errors of the base model's position (m) and rotation (rad) stay below around these pressures (Pa); `None` where the
    /// model was made without states to judge it by.
    pub fn error_bars(&self, pressures: &[f64]) -> Option<[f64; 2]> {
        let mut answered = pressures.to_vec();
        tip_model::deform(&tip_model::at_rest(self.effects), &mut answered);
        self.module.splines().error_bars(&answered)
    }

    /// How much (Pa) every pressure that the base model answers to may change at once without leaving its domain; negative outside.
    pub fn clearance(&self, pressures: &[f64]) -> f64 {
        let mut answered = pressures.to_vec();
        tip_model::deform(&tip_model::at_rest(self.effects), &mut answered);
        self.module.splines().clearance(&answered)
    }

    /// The module.
    pub fn module(&self) -> &'m actuator::Module {
        self.module.module()
    }

    /// Reference length of the module, m.
    pub fn length(&self) -> f64 {
        self.module.module().length()
    }

    /// Greatest rate of a pressure, Pa/s.
    pub fn pressure_rate(&self) -> f64 {
        self.module.limits().pressure_rate
    }

    /// Pressures that may be used, with a margin (Pa) to limit pressures beyond the model's own.
    pub fn bounds(&self, margin: f64) -> Result<Bounds, Failure> {
        let tip = self.tip();
        let bounds = Bounds::new(tip.domain(), self.module.limits(), &tip.limit_pressures(), margin);
        bounds.map_err(|error| Failure::refused(error.to_string()))
    }
}

/// Pressures given on the command line, Pa: one per FREE.
pub fn pressures(given: Option<&Values>, frees: usize, flag: &str) -> Result<Option<Vec<f64>>, Failure> {
    match given {
        None => Ok(None),
        Some(values) if values.0.len() == frees => Ok(Some(values.0.iter().map(|kpa| kpa * KPA).collect())),
        Some(values) => Err(Failure::usage(format!(
            "{flag}: {} pressures for {frees} FREEs; give one each, as in {flag} {}",
            values.0.len(),
            vec!["10"; frees].join(",")
        ))),
    }
}
