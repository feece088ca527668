use super::{
    Parameter, base_frame, bending_scale, bending_stiffness, creep, delay, hysteresis, marker_frame,
    mismatch, mullins, payload, pressure_bias, saturation, stiffness, supply_lag, valve_backlash,
    winding_angle,
};
use serde::{Deserialize, Serialize};

/// The link of the chain from command to pose read on which an effect sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Link {
    /// Command to pressure in the FREE.
    Supply,
    /// Pressure in the FREE to pressure read.
    Sensing,
    /// Pressure in the FREE to deformation.
    Mechanics,
    /// Deformation to deformation read.
    Reading,
}

/// What an effect is; its equation is in the file of the same name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EffectKind {
    /// Class of everything that acts like a stiffer rubber: `p/(1 + a)`, masses too.
    Stiffness,
    /// Factor on the FREEs' bending stiffness.
    BendingStiffness,
    /// How far the module bends for a given imbalance of its FREEs.
    BendingScale,
    /// One FREE that is stronger or weaker.
    Mismatch,
    /// Winding angle other than described (single FREE).
    WindingAngle,
    /// Unknown mass at the plate.
    Payload,
    /// Rate-independent hysteresis.
    Hysteresis,
    /// Growth at constant pressure.
    Creep,
    /// Softening below the greatest past pressure.
    Mullins,
    /// First-order lag of the pressure behind the command.
    SupplyLag,
    /// Dead band of the regulator.
    ValveBacklash,
    /// Supply that cannot give more than its own pressure.
    Saturation,
    /// Zero error of a pressure sensor.
    PressureBias,
    /// Poses stamped late.
    Delay,
    /// Base plate turned or moved against the frame of the poses.
    BaseFrame,
    /// Marker turned or moved against the tip plate.
    MarkerFrame,
}

impl EffectKind {
    /// Every kind.
    pub const ALL: [EffectKind; 16] = [
        EffectKind::Stiffness,
        EffectKind::BendingStiffness,
        EffectKind::BendingScale,
        EffectKind::Mismatch,
        EffectKind::WindingAngle,
        EffectKind::Payload,
        EffectKind::Hysteresis,
        EffectKind::Creep,
        EffectKind::Mullins,
        EffectKind::SupplyLag,
        EffectKind::ValveBacklash,
        EffectKind::Saturation,
        EffectKind::PressureBias,
        EffectKind::Delay,
        EffectKind::BaseFrame,
        EffectKind::MarkerFrame,
    ];

    /// Name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            EffectKind::Stiffness => "stiffness",
            EffectKind::BendingStiffness => "bending_stiffness",
            EffectKind::BendingScale => "bending_scale",
            EffectKind::Mismatch => "mismatch",
            EffectKind::WindingAngle => "winding_angle",
            EffectKind::Payload => "payload",
            EffectKind::Hysteresis => "hysteresis",
            EffectKind::Creep => "creep",
            EffectKind::Mullins => "mullins",
            EffectKind::SupplyLag => "supply_lag",
            EffectKind::ValveBacklash => "valve_backlash",
            EffectKind::Saturation => "saturation",
            EffectKind::PressureBias => "pressure_bias",
            EffectKind::Delay => "delay",
            EffectKind::BaseFrame => "base_frame",
            EffectKind::MarkerFrame => "marker_frame",
        }
    }

    /// The link it sits on.
    pub fn link(self) -> Link {
        match self {
            EffectKind::SupplyLag | EffectKind::ValveBacklash | EffectKind::Saturation => Link::Supply,
            EffectKind::PressureBias => Link::Sensing,
            EffectKind::Delay | EffectKind::BaseFrame | EffectKind::MarkerFrame => Link::Reading,
            _ => Link::Mechanics,
        }
    }

    /// Whether it acts on the pressure of chosen FREEs, rather than on the module as a whole.
    pub fn acts_on_pressure(self) -> bool {
        !matches!(
            self,
            EffectKind::BendingStiffness
                | EffectKind::BendingScale
                | EffectKind::WindingAngle
                | EffectKind::Payload
                | EffectKind::BaseFrame
                | EffectKind::MarkerFrame
        )
    }

    /// Whether its answer depends on the past.
    pub fn has_memory(self) -> bool {
        matches!(
            self,
            EffectKind::Hysteresis
                | EffectKind::Creep
                | EffectKind::Mullins
                | EffectKind::SupplyLag
                | EffectKind::ValveBacklash
                | EffectKind::Delay
        )
    }

    /// Its numbers.
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            EffectKind::Stiffness => stiffness::PARAMETERS,
            EffectKind::BendingStiffness => bending_stiffness::PARAMETERS,
            EffectKind::BendingScale => bending_scale::PARAMETERS,
            EffectKind::Mismatch => mismatch::PARAMETERS,
            EffectKind::WindingAngle => winding_angle::PARAMETERS,
            EffectKind::Payload => payload::PARAMETERS,
            EffectKind::Hysteresis => hysteresis::PARAMETERS,
            EffectKind::Creep => creep::PARAMETERS,
            EffectKind::Mullins => mullins::PARAMETERS,
            EffectKind::SupplyLag => supply_lag::PARAMETERS,
            EffectKind::ValveBacklash => valve_backlash::PARAMETERS,
            EffectKind::Saturation => saturation::PARAMETERS,
            EffectKind::PressureBias => pressure_bias::PARAMETERS,
            EffectKind::Delay => delay::PARAMETERS,
            EffectKind::BaseFrame => base_frame::PARAMETERS,
            EffectKind::MarkerFrame => marker_frame::PARAMETERS,
        }
    }
}

/// An effect with its numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// What it is.
    pub kind: EffectKind,
    /// Indices of the FREEs on whose pressure it acts, from zero; what acts on the module as a whole ignores them.
    pub frees: Vec<usize>,
    /// Values of [`EffectKind::parameters`], SI.
    pub values: Vec<f64>,
}

/// Why an effect cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// Too few or too many numbers.
    #[error("effect {effect} takes {expected} numbers, got {found}")]
    Count {
        /// Name of the effect.
        effect: &'static str,
        /// Numbers it has.
        expected: usize,
        /// Numbers given.
        found: usize,
    },
    /// A number outside its range, or not finite.
    #[error("{parameter} of effect {effect} is {value}, outside {lower} to {upper}")]
    Range {
        /// Name of the effect.
        effect: &'static str,
        /// Name of the number.
        parameter: &'static str,
        /// The value, in the unit of its name.
        value: f64,
        /// Least value.
        lower: f64,
        /// Greatest value.
        upper: f64,
    },
    /// A FREE that the actuator does not have.
    #[error("effect {effect} acts on FREE {free}, but the actuator has {count}")]
    Free {
        /// Name of the effect.
        effect: &'static str,
        /// The FREE, counted from one.
        free: usize,
        /// Number of FREEs.
        count: usize,
    },
}

impl Effect {
    /// The effect with its starting values, on the given FREEs.
    pub fn at_start(kind: EffectKind, frees: Vec<usize>) -> Self {
        Effect { kind, frees, values: kind.parameters().iter().map(|parameter| parameter.start).collect() }
    }

    /// Checks the numbers against their ranges and the FREEs against the actuator's count.
    pub fn check(&self, count: usize) -> Result<(), EffectError> {
        let parameters = self.kind.parameters();
        let effect = self.kind.name();
        if self.values.len() != parameters.len() {
            return Err(EffectError::Count { effect, expected: parameters.len(), found: self.values.len() });
        }
        for (parameter, value) in parameters.iter().zip(&self.values) {
            // Written so that a NaN fails.
            if !(*value >= parameter.lower && *value <= parameter.upper) {
                return Err(EffectError::Range {
                    effect,
                    parameter: parameter.name,
                    value: parameter.in_unit(*value),
                    lower: parameter.in_unit(parameter.lower),
                    upper: parameter.in_unit(parameter.upper),
                });
            }
        }
        match self.frees.iter().find(|free| **free >= count) {
            Some(free) => Err(EffectError::Free { effect, free: free + 1, count }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_start_lies_in_its_range_and_every_name_serialises_as_it_is_printed() {
        for kind in EffectKind::ALL {
            Effect::at_start(kind, vec![0]).check(1).unwrap();
            let text = toml::Value::try_from(kind).unwrap();
            assert_eq!(text.as_str(), Some(kind.name()));
            for parameter in kind.parameters() {
                assert!(parameter.lower < parameter.upper && parameter.scale > 0.0, "{}", parameter.name);
            }
        }
    }

    #[test]
    fn wrong_numbers_are_refused_with_their_name() {
        let mut effect = Effect::at_start(EffectKind::Creep, vec![0, 3]);
        let message = effect.check(3).unwrap_err().to_string();
        assert_eq!(message, "effect creep acts on FREE 4, but the actuator has 3");
        effect.values[1] = f64::NAN;
        assert!(
            effect.check(4).unwrap_err().to_string().starts_with("time_constant_s of effect creep is NaN")
        );
        effect.values.pop();
        assert!(effect.check(4).unwrap_err().to_string().contains("takes 2 numbers, got 1"));
    }
}
