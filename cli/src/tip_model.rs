//! A module's model as steering sees it: pressures to tip pose, with the effects that were found, standing still.

use actuator::PoseChart;
use identify::{Mechanics, ModuleMechanics, Seen};
use rom::{
    ModuleModel, OutOfDomain, PoseEvaluation, PoseModel,
    effect::{Chain, EffectKind},
};
use std::cell::RefCell;

/// Step of the differences that give the derivatives where effects act, Pa: large against rounding, small against curvature.
const STEP: f64 = 20.0;
/// Pressures sought beyond the base model's greatest, as a share of it: a stiffer rubber takes more.
const BEYOND: f64 = 2.0;

/// A module's model with the effects that act at rest. Effects with a memory (lag, hysteresis, creep) are left out: a pose that is
/// held is sought, on the middle between loading and unloading.
pub struct TipModel<'m> {
    module: &'m ModuleModel,
    chain: Chain,
    domain: Vec<(f64, f64)>,
    room: RefCell<(PoseEvaluation, identify::Response)>,
}

/// The effects of a chain that act at rest.
pub fn at_rest(chain: &Chain) -> Chain {
    let effects = chain.effects.iter().filter(|effect| !effect.kind.has_memory());
    Chain { effects: effects.cloned().collect() }
}

/// Commands as pressures that the base model is to answer, Pa, in place.
pub fn deform(chain: &Chain, pressures: &mut [f64]) {
    // Nothing that is left has a memory, so that every call begins at rest.
    let mut state = chain.at_rest(pressures.len());
    chain.supply(&mut state, 0.0, pressures);
    chain.deform(&mut state, 0.0, pressures);
}

/// Commanded pressure (Pa) that FREE `free` answers as the base model answers `wanted` (Pa): the greatest, where several do.
fn command_for(chain: &Chain, frees: usize, free: usize, wanted: f64) -> f64 {
    let answered = |command: f64| {
        let mut pressures = vec![command; frees];
        deform(chain, &mut pressures);
        pressures[free]
    };
    let (mut low, mut high) = (0.0, BEYOND * wanted);
    if answered(high) <= wanted {
        return high;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if answered(middle) <= wanted { low = middle } else { high = middle }
    }
    low
}

impl<'m> TipModel<'m> {
    /// Of a module with the effects of its model.
    pub fn new(module: &'m ModuleModel, effects: &Chain) -> Self {
        let chain = at_rest(effects);
        let frees = module.domain().len();
        let domain = module.domain().iter().enumerate();
        let domain = domain.map(|(free, (lower, upper))| match chain.effects.is_empty() {
            true => (*lower, *upper),
            false => (*lower, command_for(&chain, frees, free, *upper)),
        });
        let domain = domain.collect();
        let mechanics = ModuleMechanics::new(module, module.parameters(), module.module());
        let room = RefCell::new((module.workspace(), mechanics.room()));
        TipModel { module, chain, domain, room }
    }

    /// Limit pressure (Pa, as commanded) of each FREE alone, where it has one.
    pub fn limit_pressures(&self) -> Vec<Option<f64>> {
        let frees = self.domain.len();
        let limits = self.module.limit_pressures().iter().enumerate();
        limits
            .map(|(free, limit)| match self.chain.effects.is_empty() {
                true => *limit,
                false => limit.map(|limit| command_for(&self.chain, frees, free, limit)),
            })
            .collect()
    }

    /// The pose that is seen at commanded pressures.
    fn seen(&self, pressures: &[f64], response: &mut identify::Response) -> Result<PoseChart, OutOfDomain> {
        let mechanics = ModuleMechanics::new(self.module, self.module.parameters(), self.module.module());
        let mut answered = pressures.to_vec();
        deform(&self.chain, &mut answered);
        mechanics.respond(&self.chain, &answered, response)?;
        let own = PoseChart::from_array(response.values);
        match mechanics.observe(&self.chain, response) {
            Seen::Pose(pose, twist) => Ok(PoseChart::from_pose(&pose, twist)),
            // A module is seen as a pose; without one its own chart stands.
            Seen::Free(_) => Ok(own),
        }
    }

    fn check(&self, pressures: &[f64]) -> Result<(), OutOfDomain> {
        for (free, (&pressure, &(lower, upper))) in pressures.iter().zip(&self.domain).enumerate() {
            if !(lower <= pressure && pressure <= upper) {
                return Err(OutOfDomain::Pressure { free, pressure, lower, upper });
            }
        }
        Ok(())
    }
}

impl PoseModel for TipModel<'_> {
    fn domain(&self) -> &[(f64, f64)] {
        &self.domain
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        let (evaluation, response) = &mut *self.room.borrow_mut();
        if self.chain.effects.is_empty() {
            self.module.evaluate(pressures, evaluation)?;
            into.chart = evaluation.chart;
            into.jacobian.copy_from_slice(&evaluation.jacobian);
            return Ok(());
        }
        self.check(pressures)?;
        into.chart = self.seen(pressures, response)?;
        let mut beside = pressures.to_vec();
        let mut at = |free: usize, pressure: f64| -> Result<[f64; 6], OutOfDomain> {
            beside[free] = pressure;
            let chart = self.seen(&beside, response)?;
            beside[free] = pressures[free];
            Ok(chart.to_array())
        };
        let here = into.chart.to_array();
        for (free, column) in into.jacobian.iter_mut().enumerate() {
            let (p, (lower, upper)) = (pressures[free], self.domain[free]);
            // f' = (f(p + h) - f(p - h))/2h; at the ends of the domain (4 f(p + h) - f(p + 2h) - 3 f(p))/2h, h of either sign.
            let is_inside = p - STEP >= lower && p + STEP <= upper;
            let h = if is_inside || p + 2.0 * STEP <= upper { STEP } else { -STEP };
            let near = at(free, p + h)?;
            let far = at(free, if is_inside { p - h } else { p + 2.0 * h })?;
            for (k, slope) in column.iter_mut().enumerate() {
                let difference =
                    if is_inside { near[k] - far[k] } else { 4.0 * near[k] - far[k] - 3.0 * here[k] };
                *slope = difference / (2.0 * h);
            }
        }
        Ok(())
    }
}

/// Names of effects that steering leaves out, as they have a memory.
pub fn left_out(chain: &Chain) -> Vec<&'static str> {
    let mut names: Vec<&str> = chain
        .effects
        .iter()
        .map(|effect| effect.kind)
        .filter(|kind| kind.has_memory())
        .map(EffectKind::name)
        .collect();
    names.dedup();
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        command::fit::fit,
        map_file::{MapFile, samples},
    };
    use rom::{Model, effect::Effect};

    fn model() -> Model {
        let mut map = samples::smooth_module_map(1.0);
        // Weightless, so that a stiffer rubber is nothing but more pressure.
        map.module.tip.plate_mass = 0.0;
        map.module.base.free_mass = 0.0;
        fit(&MapFile::Module(map)).unwrap()
    }

    fn effect(kind: EffectKind, values: &[f64]) -> Chain {
        Chain { effects: vec![Effect { kind, frees: vec![0, 1, 2, 3], values: values.to_vec() }] }
    }

    fn evaluate(tip: &TipModel, pressures: &[f64]) -> PoseEvaluation {
        let mut into = PoseEvaluation::new(4, 0);
        tip.evaluate(pressures, &mut into).unwrap();
        into
    }

    #[test]
    fn a_stiffer_rubber_asks_for_more_pressure_and_takes_more() {
        let model = model();
        let module = model.as_module().unwrap();
        let base = TipModel::new(module, &Chain::default());
        let stiff = TipModel::new(module, &effect(EffectKind::Stiffness, &[0.25]));
        let pressures = [10e3, 20e3, 5e3, 0.0];
        let (own, more) = (evaluate(&base, &pressures), evaluate(&stiff, &pressures.map(|p| 1.25 * p)));
        for (a, b) in own.chart.to_array().iter().zip(more.chart.to_array()) {
            assert!((a - b).abs() < 1e-12);
        }
        // The tangent is that of the base model over 1.25; differences are exact but for rounding, 1e-16 over 40 Pa, and the third
        // derivative of the spline.
        for (a, b) in own.jacobian.iter().flatten().zip(more.jacobian.iter().flatten()) {
            assert!((a / 1.25 - b).abs() < 1e-12, "{a} {b}");
        }
        assert!((stiff.domain()[0].1 - 1.25 * base.domain()[0].1).abs() < 1e-6);
        let soft = TipModel::new(module, &effect(EffectKind::Stiffness, &[-0.2]));
        assert!((soft.domain()[0].1 - 0.8 * base.domain()[0].1).abs() < 1e-6);
        assert!(
            soft.evaluate(&[0.9 * base.domain()[0].1, 0.0, 0.0, 0.0], &mut evaluate(&soft, &[0.0; 4]))
                .is_err()
        );
    }

    #[test]
    fn a_load_and_a_turned_frame_are_seen_and_a_lag_is_not() {
        let model = model();
        let module = model.as_module().unwrap();
        let base = TipModel::new(module, &Chain::default());
        let pressures = [10e3, 20e3, 5e3, 0.0];
        let own = evaluate(&base, &pressures).chart.to_array();
        // The sample's slopes are 1e-3 a kilogram in every number of the chart.
        let loaded = evaluate(&TipModel::new(module, &effect(EffectKind::Payload, &[0.5])), &pressures).chart;
        for (a, b) in own.iter().zip(loaded.to_array()) {
            assert!((b - a - 0.5e-3).abs() < 1e-12);
        }
        let lag = effect(EffectKind::SupplyLag, &[0.3, 0.3]);
        assert_eq!(evaluate(&TipModel::new(module, &lag), &pressures).chart.to_array(), own);
        assert_eq!(left_out(&lag), ["supply_lag"]);
    }
}
