use rom::effect::{Chain, Effect, EffectKind, Parameter};

/// A number of the chain that is estimated; several values of an effect may be tied to one number.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Index of the effect in the chain.
    pub effect: usize,
    /// Indices of its values that take this number.
    pub values: Vec<usize>,
    /// Name, unit and scale.
    pub parameter: Parameter,
    /// Least value, SI.
    pub lower: f64,
    /// Greatest value, SI.
    pub upper: f64,
    /// Standard deviation (SI) of what is believed before the recordings, about the neutral value; `None` = nothing is.
    pub prior: Option<f64>,
    /// Whether it is one of the base model's own free numbers rather than of an effect.
    pub is_calibration: bool,
}

/// A chain and which of its numbers are estimated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setup {
    /// The effects, calibration first.
    pub chain: Chain,
    /// The numbers estimated.
    pub numbers: Vec<Number>,
}

impl Setup {
    /// Value of a number, SI.
    pub fn value(&self, number: usize) -> f64 {
        let Number { effect, values, .. } = &self.numbers[number];
        self.chain.effects[*effect].values[values[0]]
    }

    /// Sets a number (SI), within its bounds.
    pub fn set(&mut self, number: usize, value: f64) {
        let Number { effect, values, lower, upper, .. } = &self.numbers[number];
        for index in values {
            self.chain.effects[*effect].values[*index] = value.clamp(*lower, *upper);
        }
    }

    /// Adds an effect and estimates all its numbers.
    pub fn with_effect(&self, effect: Effect) -> Self {
        let mut setup = self.clone();
        let index = setup.chain.effects.len();
        for (value, parameter) in effect.kind.parameters().iter().enumerate() {
            setup.numbers.push(Number {
                effect: index,
                values: vec![value],
                parameter: *parameter,
                lower: parameter.lower,
                upper: parameter.upper,
                prior: None,
                is_calibration: false,
            });
        }
        setup.chain.effects.push(effect);
        setup
    }

    /// Takes the marker at its described height: a weight stretches the module at rest exactly as a marker set too high does, and the calibration would
    /// take the better part of a small weight away. The weight's estimate so contains the marker's tolerance.
    pub fn hold_height(&mut self) {
        const HEIGHT: usize = 5;
        let effects = &mut self.chain.effects;
        self.numbers.retain(|number| {
            let effect = &mut effects[number.effect];
            let is_height =
                number.is_calibration && effect.kind == EffectKind::MarkerFrame && number.values == [HEIGHT];
            if is_height {
                effect.values[HEIGHT] = number.parameter.neutral;
            }
            !is_height
        });
    }

    /// Starts calibration numbers that ended at a bound from their neutral values again: pushed there by what an effect will explain, they would hold the
    /// estimate of that effect back.
    pub fn release(&mut self) {
        for number in 0..self.numbers.len() {
            let Number { parameter, lower, upper, is_calibration, .. } = self.numbers[number].clone();
            let value = self.value(number);
            let near = 1e-6 * parameter.scale;
            if is_calibration && (value <= lower + near || value >= upper - near) {
                self.set(number, parameter.neutral);
            }
        }
    }

    /// Takes an effect away.
    pub fn without_effect(&self, effect: usize) -> Self {
        let mut setup = self.clone();
        setup.chain.effects.remove(effect);
        setup.numbers.retain(|number| number.effect != effect);
        for number in &mut setup.numbers {
            number.effect -= usize::from(number.effect > effect);
        }
        setup
    }

    /// Index of the calibration's effect of a kind.
    pub fn calibration(&self, kind: EffectKind) -> Option<usize> {
        let is = |number: &&Number| number.is_calibration && self.chain.effects[number.effect].kind == kind;
        self.numbers.iter().find(is).map(|number| number.effect)
    }

    /// Estimates no longer the numbers of these effects: they keep their values.
    pub fn holding(&self, held: impl Fn(&Effect) -> bool) -> Self {
        let mut setup = self.clone();
        setup.numbers.retain(|number| !held(&self.chain.effects[number.effect]));
        setup
    }

    /// Indices of effects that are not the base model's own calibration.
    pub fn effects(&self) -> Vec<usize> {
        let is_calibration =
            |index: usize| self.numbers.iter().any(|number| number.effect == index && number.is_calibration);
        (0..self.chain.effects.len()).filter(|index| !is_calibration(*index)).collect()
    }
}
