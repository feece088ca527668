use super::Effect;
use actuator::{Module, PoseChart, TipPose};
use evaluator::{Pose, effect};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// What effects change in a module beyond its pressures: factors of the map's slopes.
pub type Loads = effect::Loads<f64>;

/// Effects in the order in which they act. On each link the order of the list holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Chain {
    /// The effects.
    pub effects: Vec<Effect>,
}

/// What the chain remembers, of an actuator of so many FREEs.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainState {
    frees: usize,
    memory: Vec<f64>,
}

/// Mass (kg) at the plate that stretches and straightens a module as its own masses do: plate, payload and half of the FREEs'
/// (the mean of a hanging bar's tension is that of half its weight at the end).
pub fn hanging_mass(module: &Module) -> f64 {
    module.tip.plate_mass + module.tip.payload + 0.5 * module.base.free_mass * module.frees.len() as f64
}

fn plain(pose: &TipPose) -> Pose<f64> {
    Pose { position: pose.position.into(), rotation: pose.wxyz() }
}

impl Chain {
    /// Checks every effect for an actuator of `frees` FREEs.
    pub fn check(&self, frees: usize) -> Result<(), super::EffectError> {
        self.effects.iter().try_for_each(|effect| effect.check(frees))
    }

    /// The chain as the evaluator steps it, on an actuator of `frees` FREEs.
    pub fn of<'a>(
        &'a self,
        frees: usize,
    ) -> effect::Chain<impl DoubleEndedIterator<Item = effect::Effect<'a, f64>> + Clone> {
        let lent = |effect: &'a Effect| effect::Effect {
            kind: effect.kind,
            frees: effect.frees.iter().fold(0, |bits, free| bits | 1 << free),
            values: &effect.values,
        };
        effect::Chain::new(self.effects.iter().map(lent), frees)
    }

    /// The state of an actuator of `frees` FREEs that has rested: no pressure so far, no memory.
    pub fn at_rest(&self, frees: usize) -> ChainState {
        ChainState { frees, memory: vec![0.0; self.of(frees).memory()] }
    }

    /// Commands to pressures in the FREEs (Pa, in place) after `step` seconds. The first call starts the supply settled at its command.
    pub fn supply(&self, state: &mut ChainState, step: f64, pressures: &mut [f64]) {
        self.of(state.frees).supply(&mut state.memory, step, pressures);
    }

    /// Pressures in the FREEs to pressures read (Pa, in place).
    pub fn read_pressures(&self, pressures: &mut [f64]) {
        self.of(pressures.len()).read_pressures(pressures);
    }

    /// Pressures read to pressures in the FREEs (Pa, in place): inverse of [`Chain::read_pressures`].
    pub fn unread_pressures(&self, pressures: &mut [f64]) {
        self.of(pressures.len()).unread_pressures(pressures);
    }

    /// Pressures in the FREEs to those that the base model is to answer (Pa, in place) after `step` seconds: memory of the rubber,
    /// stiffness, and delays of the reading (the base model has no state, so that a late pose is the pose of a late pressure).
    pub fn deform(&self, state: &mut ChainState, step: f64, pressures: &mut [f64]) {
        self.of(state.frees).deform(&mut state.memory, step, pressures);
    }

    /// Factors of the base model's slopes. `hanging_mass` (kg) is what the base model carries already, see [`hanging_mass`]: a rubber
    /// stiffer by 1 + a answers `(hanging + payload)/(1 + a)` as the base model does, which knows of `hanging` alone.
    pub fn loads(&self, hanging_mass: f64) -> Loads {
        self.of(0).loads(hanging_mass)
    }

    /// Change of the winding angle, rad.
    pub fn winding_angle(&self) -> f64 {
        self.of(0).winding_angle()
    }

    /// The chart of a module whose base model answers `chart`, loads included: what bends further bends further.
    pub fn bend(&self, chart: &PoseChart) -> PoseChart {
        PoseChart::from_array(self.of(0).bend(chart.to_array()))
    }

    /// Pose to pose read: marker first, then base frame.
    pub fn read_pose(&self, pose: &TipPose) -> TipPose {
        let Pose { position, rotation: [w, x, y, z] } = self.of(0).read_pose(&plain(pose));
        // The product of unit quaternions is one, up to rounding.
        let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        TipPose { position: Vector3::from(position), rotation }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::EffectKind;

    fn effect(kind: EffectKind, frees: &[usize], values: &[f64]) -> Effect {
        Effect { kind, frees: frees.to_vec(), values: values.to_vec() }
    }

    #[test]
    fn effects_act_on_their_own_link_and_their_own_frees() {
        let chain = Chain {
            effects: vec![
                effect(EffectKind::PressureBias, &[1], &[500.0]),
                effect(EffectKind::SupplyLag, &[0, 1], &[0.2, 0.2]),
                effect(EffectKind::Stiffness, &[0, 1], &[0.25]),
            ],
        };
        let mut state = chain.at_rest(2);
        let mut pressures = [10e3, 20e3];
        chain.supply(&mut state, 0.0, &mut pressures);
        assert_eq!(pressures, [10e3, 20e3], "a recording starts settled");
        pressures = [0.0, 20e3];
        chain.supply(&mut state, 0.2, &mut pressures);
        assert!((pressures[0] - 10e3 * (-1f64).exp()).abs() < 1e-9);
        let mut read = pressures;
        chain.read_pressures(&mut read);
        assert_eq!(read[0], pressures[0]);
        assert!((read[1] - 20.5e3).abs() < 1e-9);
        chain.unread_pressures(&mut read);
        assert!((read[1] - 20e3).abs() < 1e-9);
        chain.deform(&mut state, 0.2, &mut pressures);
        assert!((pressures[1] - 16e3).abs() < 1e-9);
    }

    #[test]
    fn a_stiffer_module_carries_its_weight_as_a_lighter_one() {
        let chain = Chain {
            effects: vec![
                effect(EffectKind::Stiffness, &[], &[0.25]),
                effect(EffectKind::Payload, &[], &[0.01]),
            ],
        };
        // (15 g + 10 g)/1.25 = 20 g, 5 g more than the base model's own 15 g.
        assert!((chain.loads(0.015).mass - 0.005).abs() < 1e-15);
    }

    #[test]
    fn memories_of_effects_and_frees_do_not_mix() {
        let play = |frees: &[usize]| effect(EffectKind::Hysteresis, frees, &[1e3, 1.0]);
        let both = Chain { effects: vec![play(&[0]), play(&[1])] };
        let mut state = both.at_rest(2);
        for (input, expected) in [([5e3, 3e3], [4e3, 2e3]), ([4e3, 8e3], [4e3, 7e3])] {
            let mut pressures = input;
            both.deform(&mut state, 0.1, &mut pressures);
            assert_eq!(pressures, expected);
        }
    }

    #[test]
    fn every_effect_on_the_pressure_is_absent_at_its_neutral_values() {
        for kind in EffectKind::ALL.into_iter().filter(|kind| kind.acts_on_pressure()) {
            let values: Vec<f64> = kind.parameters().iter().map(|parameter| parameter.neutral).collect();
            let chain = Chain { effects: vec![effect(kind, &[0], &values)] };
            let mut state = chain.at_rest(1);
            for input in [0.0, 3e3, 9e3, 4e3, 12e3, 1e3] {
                let mut pressures = [input];
                chain.supply(&mut state, 0.05, &mut pressures);
                chain.read_pressures(&mut pressures);
                chain.deform(&mut state, 0.05, &mut pressures);
                assert!(
                    (pressures[0] - input).abs() < 1e-9,
                    "{}: {input} became {}",
                    kind.name(),
                    pressures[0]
                );
            }
        }
    }

    #[test]
    fn every_effect_on_the_pressure_is_felt_away_from_its_neutral_values() {
        for kind in EffectKind::ALL.into_iter().filter(|kind| kind.acts_on_pressure()) {
            let values: Vec<f64> = kind
                .parameters()
                .iter()
                .map(
                    |parameter| {
                        if parameter.start == parameter.neutral { parameter.scale } else { parameter.start }
                    },
                )
                .collect();
            let chain = Chain { effects: vec![effect(kind, &[0], &values)] };
            let mut state = chain.at_rest(1);
            let mut felt = 0.0f64;
            for input in [0.0, 3e3, 90e3, 4e3, 12e3, 1e3] {
                let mut pressures = [input];
                chain.supply(&mut state, 0.05, &mut pressures);
                chain.read_pressures(&mut pressures);
                chain.deform(&mut state, 0.05, &mut pressures);
                felt = felt.max((pressures[0] - input).abs());
            }
            assert!(felt > 1.0, "{} changed nothing", kind.name());
        }
    }
}
