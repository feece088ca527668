//! A simulated rig for the demonstration: a module's model with an effect that is put in on purpose, commands, sensors with noise.

use crate::failure::Failure;
use actuator::{Rig, units::KPA};
use identify::{Mechanics, ModuleMechanics, Seen};
use record::{Layout, Motion, Quantity, Recording};
use rom::{
    ModuleModel,
    effect::{Chain, Effect, EffectKind},
};

/// Samples a second.
const RATE: f64 = 20.0;
/// Length of a recording, s.
const SECONDS: f64 = 60.0;
/// Noise (one standard deviation) of the readings: Pa, m, and of the quaternion's components.
const NOISE: [f64; 3] = [0.05 * KPA, 0.1e-3, 0.5e-3];
/// Time constant of the lag that is put in, s.
pub const TIME_CONSTANT: f64 = 0.3;

/// Mass that is put on the tip plate, kg.
pub const PAYLOAD: f64 = 0.03;

/// The effects that are put in: the pressures follow their commands late, and the tip plate carries what nobody declared.
pub fn effects(frees: usize) -> Chain {
    let late = vec![TIME_CONSTANT; EffectKind::SupplyLag.parameters().len()];
    let effect = |kind, values| Effect { kind, frees: (0..frees).collect(), values };
    Chain { effects: vec![effect(EffectKind::SupplyLag, late), effect(EffectKind::Payload, vec![PAYLOAD])] }
}

/// A way to command the pressures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Commands {
    /// Steps of single FREEs, pairs and all.
    Staircase,
    /// Triangles of three rates.
    Triangles,
    /// Random pressures, each held for a while.
    SetPoints,
    /// Smooth and random: of another kind than the others, to judge on.
    Smooth,
}

impl Commands {
    /// All, the one to judge on last.
    pub const ALL: [Commands; 4] =
        [Commands::Staircase, Commands::Triangles, Commands::SetPoints, Commands::Smooth];

    /// Name of the recording.
    pub fn name(self) -> &'static str {
        match self {
            Commands::Staircase => "1-staircase",
            Commands::Triangles => "2-triangles",
            Commands::SetPoints => "3-setpoints",
            Commands::Smooth => "4-smooth",
        }
    }

    /// Share of the greatest pressure commanded to a FREE at a time (s).
    fn share(self, time: f64, free: usize, frees: usize) -> f64 {
        let hash = |n: f64| (n * 0.754_877_666_2 + free as f64 * 0.569_840_290_9 + 0.31).fract();
        match self {
            Commands::Staircase => {
                let (turn, level) = ((time / 10.0) as usize, (time % 10.0 / 2.0).floor());
                let on = match turn % 6 {
                    turn if turn < frees => free == turn,
                    4 => free.is_multiple_of(2),
                    _ => true,
                };
                if on { level / 4.0 } else { 0.0 }
            }
            Commands::Triangles => {
                let period = [20.0, 8.0, 3.0][(time / 20.0) as usize % 3];
                let phase = (time / period + free as f64 / frees as f64).fract();
                1.0 - (2.0 * phase - 1.0).abs()
            }
            Commands::SetPoints => hash((time / 1.5).floor()),
            Commands::Smooth => {
                let wave = |k: f64| (std::f64::consts::TAU * (0.05 * k * time + hash(k))).sin();
                (0.5 + 0.2 * (wave(1.0) + wave(2.3) + wave(5.1))).clamp(0.0, 1.0)
            }
        }
    }
}

/// Runs the rig: the model with the effects, driven by commands up to `greatest` (Pa).
pub fn record(
    commands: Commands,
    rig: &Rig,
    model: &ModuleModel,
    effects: &Chain,
    greatest: f64,
) -> Result<Recording, Failure> {
    let layout = Layout::of(rig).map_err(Failure::file)?;
    let mechanics = ModuleMechanics::new(model, model.parameters(), model.module());
    let frees = mechanics.frees();
    let samples = (SECONDS * RATE) as usize;
    let time: Vec<f64> = (0..samples).map(|k| k as f64 / RATE).collect();
    let mut recording = Recording::unmeasured(commands.name(), time.clone(), &layout);
    let mut state = effects.at_rest(frees);
    let mut response = mechanics.room();
    let mut noise = Noise(commands.name().bytes().map(u64::from).sum());
    let mut put = |quantity: Quantity, k: usize, value: f64| {
        if let Some(channel) = recording.channel_mut(quantity) {
            channel[k] = value;
        }
    };
    for (k, time) in time.iter().enumerate() {
        let command: Vec<f64> =
            (0..frees).map(|free| greatest * commands.share(*time, free, frees)).collect();
        let mut pressures = command.clone();
        effects.supply(&mut state, 1.0 / RATE, &mut pressures);
        let mut read = pressures.clone();
        effects.read_pressures(&mut read);
        effects.deform(&mut state, 1.0 / RATE, &mut pressures);
        let answer = mechanics.respond(effects, &pressures, &mut response);
        answer.map_err(|error| Failure::refused(error.to_string()))?;
        let Seen::Pose(pose, _) = mechanics.observe(effects, &response) else { continue };
        for free in 0..frees {
            put(Quantity::Command(free), k, command[free]);
            put(Quantity::Pressure(free), k, read[free] + NOISE[0] * noise.next());
        }
        for axis in 0..3 {
            put(Quantity::Position(axis), k, pose.position[axis] + NOISE[1] * noise.next());
        }
        let seen = pose.wxyz().map(|component| component + NOISE[2] * noise.next());
        let length = seen.iter().map(|component| component * component).sum::<f64>().sqrt();
        for (component, value) in seen.into_iter().enumerate() {
            put(Quantity::Rotation(component), k, value / length);
        }
    }
    debug_assert!(matches!(recording.motion, Motion::Pose { .. }));
    Ok(recording)
}

/// Random numbers of mean zero and variance one, nearly Gaussian: the sum of twelve even ones less six. The same every time.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut even = || {
            // Knuth's linear congruential generator, upper bits.
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| even()).sum::<f64>() - 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_mean_zero_and_variance_one() {
        let mut noise = Noise(7);
        let values: Vec<f64> = (0..20_000).map(|_| noise.next()).collect();
        let mean = values.iter().sum::<f64>() / 2e4;
        let variance = values.iter().map(|value| value * value).sum::<f64>() / 2e4;
        // Four standard errors: 1/sqrt(n) of the mean, sqrt(2/n) of the variance.
        assert!(mean.abs() < 4.0 / 2e4f64.sqrt() && (variance - 1.0).abs() < 4.0 * (2.0 / 2e4f64).sqrt());
    }

    #[test]
    fn commands_stay_between_nothing_and_all() {
        for commands in Commands::ALL {
            let shares: Vec<f64> =
                (0..1200).map(|k| commands.share(f64::from(k) / 20.0, k as usize % 4, 4)).collect();
            assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)), "{commands:?}");
            assert!(shares.iter().any(|share| *share > 0.7) && shares.iter().any(|share| *share < 0.3));
        }
    }
}
