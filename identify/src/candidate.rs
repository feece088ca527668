use crate::setup::{Number, Setup};
use rom::effect::{Effect, EffectKind, Parameter};

/// An effect that may be missing, and from where its estimate starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// What it is.
    pub kind: EffectKind,
    /// FREEs it acts on, from zero.
    pub frees: Vec<usize>,
    /// Starting values; several where the equation has more than one valley.
    pub starts: Vec<Vec<f64>>,
}

/// Tolerances of the base model itself: how far its own numbers may be off before that is an effect of the actuator.
///
/// They are bounds and widths of what is believed beforehand, not estimates. They were set by a module of another maker's model with nothing
/// missing (the rig `practice-null`): rods of finite elements tied by spacers agree with it within 5 % of stiffness, which is read from the
/// twist, and within 10 % in how far an imbalance of the FREEs bends the module, with half their own provisional bending stiffness. What lies
/// within these, the bending a little widened, cannot be told from the model's own error. Tip: how well a marker is set. Supply: a regulator with a short
/// hose follows within a tenth of a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Greatest change of stiffness that passes as the base model's error.
    pub stiffness: f64,
    /// The same for the bending stiffness.
    pub bending_stiffness: f64,
    /// Greatest change of how far the module bends for a given imbalance of its FREEs.
    pub bending_scale: f64,
    /// Greatest offset of the marker, m.
    pub tip_offset: f64,
    /// Greatest time constant of an ordinary supply, s.
    pub supply_time_constant: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Tolerances {
            stiffness: 0.05,
            bending_stiffness: 0.5,
            bending_scale: 0.15,
            tip_offset: 2e-4,
            supply_time_constant: 0.1,
        }
    }
}

impl Tolerances {
    /// The base model's own numbers as a chain at their neutral values.
    pub fn calibration(&self, frees: usize, is_module: bool, has_bending: bool) -> Setup {
        let all: Vec<usize> = (0..frees).collect();
        let mut setup = Setup::default();
        let mut add = |kind: EffectKind, numbers: &[(&[usize], f64, f64)]| {
            let parameters = kind.parameters();
            let effect = setup.chain.effects.len();
            let values = parameters.iter().map(|parameter| parameter.neutral).collect();
            setup.chain.effects.push(Effect { kind, frees: all.clone(), values });
            for (values, lower, upper) in numbers {
                let parameter = parameters[values[0]];
                setup.numbers.push(Number {
                    effect,
                    values: values.to_vec(),
                    parameter,
                    lower: *lower,
                    upper: *upper,
                    prior: Some(0.5 * (upper - lower)),
                    is_calibration: true,
                });
            }
        };
        add(EffectKind::Stiffness, &[(&[0], -self.stiffness, self.stiffness)]);
        if has_bending {
            add(EffectKind::BendingStiffness, &[(&[0], -self.bending_stiffness, self.bending_stiffness)]);
        }
        if is_module {
            add(EffectKind::BendingScale, &[(&[0], -self.bending_scale, self.bending_scale)]);
            let tip = |value: &'static [usize]| (value, -self.tip_offset, self.tip_offset);
            add(EffectKind::MarkerFrame, &[tip(&[3]), tip(&[4]), tip(&[5])]);
        }
        add(EffectKind::SupplyLag, &[(&[0, 1], 0.0, self.supply_time_constant)]);
        // A lag has no slope at zero: its estimate starts inside. Any value within the tolerance is believed alike.
        let supply = setup.numbers.len() - 1;
        setup.numbers[supply].prior = None;
        setup.set(supply, 0.3 * self.supply_time_constant);
        setup
    }
}

impl Candidate {
    /// One candidate from its kind's own start.
    pub fn alone(kind: EffectKind, frees: &[usize]) -> Self {
        Self::new(kind, frees)
    }

    fn new(kind: EffectKind, frees: &[usize]) -> Self {
        let start = kind.parameters().iter().map(|parameter| parameter.start).collect();
        Candidate { kind, frees: frees.to_vec(), starts: vec![start] }
    }

    fn from(kind: EffectKind, frees: &[usize], starts: &[&[f64]]) -> Self {
        Candidate { kind, frees: frees.to_vec(), starts: starts.iter().map(|start| start.to_vec()).collect() }
    }

    /// Effects between command and pressure, for a greatest pressure (Pa).
    pub fn supply(frees: usize, greatest: f64) -> Vec<Self> {
        let all: Vec<usize> = (0..frees).collect();
        vec![
            Candidate::from(EffectKind::SupplyLag, &all, &[&[0.15, 0.15], &[0.6, 0.6]]),
            Candidate::from(EffectKind::ValveBacklash, &all, &[&[0.01 * greatest]]),
            Candidate::from(EffectKind::Saturation, &all, &[&[0.9 * greatest], &[0.75 * greatest]]),
        ]
    }

    /// Effects in which the past matters, for a greatest pressure (Pa).
    pub fn memory(frees: usize, greatest: f64) -> Vec<Self> {
        let all: Vec<usize> = (0..frees).collect();
        vec![
            Candidate::from(
                EffectKind::Hysteresis,
                &all,
                &[&[0.02 * greatest, 0.7], &[0.08 * greatest, 0.4]],
            ),
            Candidate::from(EffectKind::Creep, &all, &[&[0.02, 3.0], &[0.02, 30.0], &[0.02, 150.0]]),
            Candidate::new(EffectKind::Mullins, &all),
            Candidate::new(EffectKind::Delay, &all),
        ]
    }

    /// Effects without memory, of a module.
    pub fn still(frees: usize, has_payload: bool, has_reading: bool) -> Vec<Self> {
        let all: Vec<usize> = (0..frees).collect();
        let mut candidates = vec![
            Candidate::new(EffectKind::Stiffness, &all),
            Candidate::new(EffectKind::BaseFrame, &all),
            Candidate::new(EffectKind::MarkerFrame, &all),
        ];
        if has_payload {
            candidates.push(Candidate::new(EffectKind::Payload, &all));
        }
        if has_reading {
            candidates.push(Candidate::new(EffectKind::PressureBias, &all));
        }
        if frees > 1 {
            candidates.extend(all.iter().map(|free| Candidate::new(EffectKind::Mismatch, &[*free])));
            if has_reading {
                candidates.extend(all.iter().map(|free| Candidate::new(EffectKind::PressureBias, &[*free])));
            }
        }
        candidates
    }

    /// A setup with this effect, from one of its starts. An effect that the calibration already has in small replaces it: its numbers are freed from the
    /// base model's tolerance.
    pub fn join(&self, setup: &Setup, start: &[f64]) -> Setup {
        let replaced = match self.kind {
            EffectKind::Stiffness | EffectKind::SupplyLag | EffectKind::MarkerFrame => {
                setup.calibration(self.kind)
            }
            _ => None,
        };
        let mut effect = Effect { kind: self.kind, frees: self.frees.clone(), values: start.to_vec() };
        let mut joined = match replaced {
            Some(index) => {
                if self.kind != EffectKind::SupplyLag {
                    effect.values.clone_from(&setup.chain.effects[index].values);
                }
                setup.without_effect(index).with_effect(effect)
            }
            None => {
                let mut setup = setup.with_effect(effect);
                if self.kind == EffectKind::Payload {
                    setup.hold_height();
                }
                setup
            }
        };
        joined.release();
        joined
    }

    /// Whether the setup has this effect already; an effect on all FREEs and one on a single FREE are two.
    pub fn is_in(&self, setup: &Setup) -> bool {
        setup.effects().into_iter().any(|index| {
            let effect = &setup.chain.effects[index];
            effect.kind == self.kind && effect.frees == self.frees
        })
    }

    /// Name for messages: the effect's, with the FREE where it is a single one of several.
    pub fn title(&self, frees: usize) -> String {
        match self.frees.as_slice() {
            [free] if frees > 1 => format!("{} of FREE {}", self.kind.name(), free + 1),
            _ => self.kind.name().to_owned(),
        }
    }

    /// Its numbers.
    pub fn parameters(&self) -> &'static [Parameter] {
        self.kind.parameters()
    }
}
