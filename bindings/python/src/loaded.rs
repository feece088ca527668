use evaluator::{FreeEvaluation, OutsideFree, OutsideModule, TipEvaluation, TipModel};
use rom::{FreeModel, Model, effect::Chain};

/// A model as it is evaluated here.
pub struct Loaded {
    /// As its file has it.
    pub model: Model,
    /// The effects that act at rest: without those that remember.
    pub at_rest: Chain,
    /// A module's, with effects.
    pub tip: Option<TipModel<f64, Vec<f64>>>,
}

impl Loaded {
    /// Of a model.
    pub fn new(model: Model) -> Self {
        let effects = model.effects.effects.iter().filter(|effect| !effect.kind.has_memory());
        let at_rest = Chain { effects: effects.cloned().collect() };
        let tip = model.as_module().map(|module| module.tip_model());
        Loaded { model, at_rest, tip }
    }

    /// Pressures in the FREEs (Pa) at commands that are held.
    pub fn supplied(&self, commands: &[f64]) -> Vec<f64> {
        let mut pressures = commands.to_vec();
        // What acts at rest remembers nothing.
        self.at_rest.of(commands.len()).supply(&mut [], 0.0, &mut pressures);
        pressures
    }

    /// Pressures (Pa) that the splines answer at commands that are held.
    pub fn answered(&self, commands: &[f64]) -> Vec<f64> {
        let mut pressures = self.supplied(commands);
        self.at_rest.of(commands.len()).deform(&mut [], 0.0, &mut pressures);
        pressures
    }

    /// Pose of a module's tip at commands that are held.
    pub fn pose(
        &self,
        tip: &TipModel<f64, Vec<f64>>,
        commands: &[f64],
    ) -> Result<TipEvaluation<f64>, OutsideModule<f64>> {
        tip.evaluate(&self.at_rest.of(commands.len()), &mut [], 0.0, &self.supplied(commands))
    }

    /// Deformation of a FREE at a command that is held.
    pub fn deformation(
        &self,
        free: &FreeModel,
        [command, angle, modulus]: [f64; 3],
    ) -> Result<FreeEvaluation<f64>, OutsideFree<f64>> {
        let pressure = self.supplied(&[command])[0];
        free.splines().evaluate_after(&self.at_rest.of(1), &mut [], 0.0, pressure, angle, modulus)
    }
}
