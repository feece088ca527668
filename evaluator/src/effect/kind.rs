use crate::{Dual, Real};

use super::{
    Parameter, base_frame, bending_scale, bending_stiffness, creep, delay, hysteresis, marker_frame,
    mismatch, mullins, payload, pressure_bias, saturation, stiffness, supply_lag, valve_backlash,
    winding_angle,
};

/// Greatest number of values of an effect.
pub const MAX_VALUES: usize = 6;

/// The link of the chain from command to pose read on which an effect sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
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

/// What an effect is; its equation is in the file of the same name. The numbers stand in images: they never change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum EffectKind {
    /// Class of everything that acts like a stiffer rubber: `p/(1 + a)`, masses too.
    Stiffness = 1,
    /// Factor on the FREEs' bending stiffness.
    BendingStiffness = 2,
    /// How far the module bends for a given imbalance of its FREEs.
    BendingScale = 3,
    /// One FREE that is stronger or weaker.
    Mismatch = 4,
    /// Winding angle other than described (single FREE).
    WindingAngle = 5,
    /// Unknown mass at the plate.
    Payload = 6,
    /// Rate-independent hysteresis.
    Hysteresis = 7,
    /// Growth at constant pressure.
    Creep = 8,
    /// Softening below the greatest past pressure.
    Mullins = 9,
    /// First-order lag of the pressure behind the command.
    SupplyLag = 10,
    /// Dead band of the regulator.
    ValveBacklash = 11,
    /// Supply that cannot give more than its own pressure.
    Saturation = 12,
    /// Zero error of a pressure sensor.
    PressureBias = 13,
    /// Poses stamped late.
    Delay = 14,
    /// Base plate turned or moved against the frame of the poses.
    BaseFrame = 15,
    /// Marker turned or moved against the tip plate.
    MarkerFrame = 16,
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

    /// Numbers of memory for each FREE.
    pub fn memory(self) -> usize {
        match self {
            EffectKind::SupplyLag => 2,
            EffectKind::Delay => delay::MEMORY,
            kind if kind.has_memory() => 1,
            _ => 0,
        }
    }

    /// Number in images.
    pub fn number(self) -> u32 {
        self as u32
    }

    /// The kind of a number in an image.
    pub fn from_number(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.number() == number)
    }

    /// What becomes of a FREE's pressure (Pa) at the end of `step` seconds, for the effects that act on it; others leave it. On the
    /// link of sensing it is the reading.
    ///
    /// # Panics
    /// When `values` are fewer than [`EffectKind::parameters`], or `memory` not as long as [`EffectKind::memory`].
    pub fn pressure<T: Real>(self, values: &[T], memory: &mut [T], step: T, pressure: T) -> T {
        const LENGTH: &str = "memory is as long as the effect asks for";
        match self {
            EffectKind::Stiffness => stiffness::pressure(values, pressure),
            EffectKind::Mismatch => mismatch::pressure(values, pressure),
            EffectKind::Saturation => saturation::pressure(values, pressure),
            EffectKind::PressureBias => pressure_bias::read(values, pressure),
            EffectKind::Hysteresis => hysteresis::pressure(values, &mut memory[0], pressure),
            EffectKind::Mullins => mullins::pressure(values, &mut memory[0], pressure),
            EffectKind::ValveBacklash => valve_backlash::pressure(values, &mut memory[0], pressure),
            EffectKind::Creep => creep::pressure(values, &mut memory[0], step, pressure),
            EffectKind::SupplyLag => {
                supply_lag::pressure(values, memory.try_into().expect(LENGTH), step, pressure)
            }
            EffectKind::Delay => delay::pressure(values, memory.try_into().expect(LENGTH), step, pressure),
            _ => pressure,
        }
    }

    /// As [`EffectKind::pressure`], with derivatives: of what it returns and of what it remembers, with respect to the pressure (number
    /// 0) and to the effect's values (numbers 1 and on, as far as `N` goes). The past, and its derivatives with respect to the
    /// values, are in `memory`.
    ///
    /// # Panics
    /// As [`EffectKind::pressure`], and for more than [`MAX_VALUES`] values.
    pub fn pressure_with_slopes<T: Real, const N: usize>(
        self,
        values: &[T],
        memory: &mut [Dual<T, N>],
        step: T,
        pressure: T,
    ) -> Dual<T, N> {
        let mut varied = [Dual::default(); MAX_VALUES];
        for (index, (varied, value)) in varied.iter_mut().zip(values).enumerate() {
            *varied = if index + 1 < N { Dual::variable(*value, index + 1) } else { Dual::fixed(*value) };
        }
        for remembered in memory.iter_mut() {
            // What is past does not depend on the pressure now.
            remembered.slopes[0] = T::ZERO;
        }
        self.pressure(&varied[..values.len()], memory, Dual::fixed(step), Dual::variable(pressure, 0))
    }

    /// As [`EffectKind::pressure`], with the derivative of what it returns with respect to the pressure now.
    ///
    /// # Panics
    /// As [`EffectKind::pressure`].
    pub fn pressure_with_gain<T: Real>(self, values: &[T], memory: &mut [T], step: T, pressure: T) -> (T, T) {
        let mut remembered = [Dual::<T, 1>::default(); delay::MEMORY];
        let remembered = &mut remembered[..memory.len()];
        for (dual, value) in remembered.iter_mut().zip(memory.iter()) {
            dual.value = *value;
        }
        let out = self.pressure_with_slopes(values, remembered, step, pressure);
        for (value, dual) in memory.iter_mut().zip(remembered) {
            *value = dual.value;
        }
        (out.value, out.slopes[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_start_lies_in_its_range_and_numbers_are_told_apart() {
        for kind in EffectKind::ALL {
            assert!(kind.parameters().len() <= MAX_VALUES);
            assert_eq!(EffectKind::from_number(kind.number()), Some(kind));
            for parameter in kind.parameters() {
                assert!(parameter.lower < parameter.upper && parameter.scale > 0.0, "{}", parameter.name);
                assert!(parameter.lower <= parameter.start && parameter.start <= parameter.upper);
            }
        }
        assert_eq!(EffectKind::from_number(0), None);
    }

    /// Pressures of an uneven walk, Pa.
    const WALK: [f64; 9] = [4e3, 9e3, 31e3, 22e3, 24e3, 6e3, 47e3, 47e3, 13e3];

    /// What an effect makes of the walk: the last pressure.
    fn walk(kind: EffectKind, values: &[f64], last: f64) -> f64 {
        let mut memory = [0.0; delay::MEMORY];
        let mut out = 0.0;
        for (k, pressure) in WALK.into_iter().enumerate() {
            let pressure = if k + 1 == WALK.len() { last } else { pressure };
            out = kind.pressure(values, &mut memory[..kind.memory()], 0.04, pressure);
        }
        out
    }

    #[test]
    fn derivatives_carry_the_past_along() {
        for kind in EffectKind::ALL.into_iter().filter(|kind| kind.acts_on_pressure()) {
            let mut values = [0.0; MAX_VALUES];
            let parameters = kind.parameters();
            for (value, parameter) in values.iter_mut().zip(parameters) {
                *value = parameter.start + 0.3 * parameter.scale;
            }
            let values = &mut values[..parameters.len()];
            let mut memory = [Dual::<f64, { MAX_VALUES + 1 }>::default(); delay::MEMORY];
            let mut out = Dual::default();
            for pressure in WALK {
                out = kind.pressure_with_slopes(values, &mut memory[..kind.memory()], 0.04, pressure);
            }
            let last = WALK[WALK.len() - 1];
            assert_eq!(out.value, walk(kind, values, last), "{}", kind.name());
            let by_pressure = (walk(kind, values, last + 1.0) - walk(kind, values, last - 1.0)) / 2.0;
            assert!((out.slopes[0] - by_pressure).abs() < 1e-6, "{}: {by_pressure}", kind.name());
            for (index, parameter) in parameters.iter().enumerate() {
                let step = 1e-4 * parameter.scale;
                let at = |by: f64| {
                    let mut moved = [0.0; MAX_VALUES];
                    moved[..values.len()].copy_from_slice(values);
                    moved[index] += by;
                    walk(kind, &moved[..values.len()], last)
                };
                let difference = (at(step) - at(-step)) / (2.0 * step);
                let off = (out.slopes[index + 1] - difference).abs();
                assert!(off <= 1e-5 * difference.abs().max(1e-3), "{} {}", kind.name(), parameter.name);
            }
        }
    }
}
