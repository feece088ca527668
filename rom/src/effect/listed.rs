use evaluator::effect::EffectKind;
use serde::{Deserialize, Serialize};

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
    fn every_effect_can_start_and_its_name_serialises_as_it_is_printed() {
        for kind in EffectKind::ALL {
            Effect::at_start(kind, vec![0]).check(1).unwrap();
            let text = toml::Value::try_from(kind).unwrap();
            assert_eq!(text.as_str(), Some(kind.name()));
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
