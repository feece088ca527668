use super::{EffectKind, Link, base_frame, bending_scale, marker_frame, pressure_bias};
use crate::{Pose, Real};

/// Greatest number of effects of an image.
pub const MAX_EFFECTS: usize = 16;

/// An effect with its numbers, which stand elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect<'a, T> {
    /// What it is.
    pub kind: EffectKind,
    /// The FREEs on whose pressure it acts, a bit each; what acts on the module as a whole ignores them.
    pub frees: u32,
    /// Values of [`EffectKind::parameters`], SI.
    pub values: &'a [T],
}

/// What effects change in a module beyond its pressures: factors of the map's slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loads<T> {
    /// Mass at the plate beyond the base model's, kg, as the base model is to be told of it.
    pub mass: T,
    /// Factor on the bending stiffness, minus one.
    pub bending_stiffness: T,
}

/// Effects in the order in which they act, on an actuator of some FREEs: on each link the order of the list holds.
#[derive(Clone, Copy, Debug)]
pub struct Chain<I> {
    effects: I,
    frees: usize,
}

impl<'a, T: Real + 'a, I: Iterator<Item = Effect<'a, T>> + Clone> Chain<I> {
    /// The chain of these effects on `frees` FREEs.
    pub fn new(effects: I, frees: usize) -> Self {
        Chain { effects, frees }
    }

    /// Numbers that its memory takes; all nought is an actuator that has rested.
    pub fn memory(&self) -> usize {
        self.effects.clone().map(|effect| effect.kind.memory() * self.frees).sum()
    }

    /// Lets the effects of some links act, each on its FREEs with its own memory.
    fn act(
        &self,
        links: &[Link],
        memory: &mut [T],
        mut on_free: impl FnMut(&Effect<'a, T>, usize, &mut [T]),
    ) {
        let mut rest = memory;
        for effect in self.effects.clone() {
            let per_free = effect.kind.memory();
            let (own, others) = rest.split_at_mut(per_free * self.frees);
            rest = others;
            if !(links.contains(&effect.kind.link()) && effect.kind.acts_on_pressure()) {
                continue;
            }
            for free in (0..self.frees).filter(|free| effect.frees >> free & 1 == 1) {
                on_free(&effect, free, &mut own[free * per_free..(free + 1) * per_free]);
            }
        }
    }

    /// Commands to pressures in the FREEs (Pa, in place) after `step` seconds. The first call starts the supply settled at its command.
    ///
    /// # Panics
    /// When there are not as many pressures as FREEs, or `memory` is shorter than [`Chain::memory`].
    pub fn supply(&self, memory: &mut [T], step: T, pressures: &mut [T]) {
        self.step(&[Link::Supply], memory, step, pressures);
    }

    /// Pressures in the FREEs to those that the base model is to answer (Pa, in place) after `step` seconds: memory of the rubber,
    /// stiffness, and delays of the reading (the base model has no state, so that a late pose is the pose of a late pressure).
    ///
    /// # Panics
    /// As [`Chain::supply`].
    pub fn deform(&self, memory: &mut [T], step: T, pressures: &mut [T]) {
        self.step(&[Link::Mechanics, Link::Reading], memory, step, pressures);
    }

    fn step(&self, links: &[Link], memory: &mut [T], step: T, pressures: &mut [T]) {
        assert_eq!(pressures.len(), self.frees, "there is one pressure per FREE");
        self.act(links, memory, |effect, free, own| {
            pressures[free] = effect.kind.pressure(effect.values, own, step, pressures[free]);
        });
    }

    /// As [`Chain::deform`], with `gains[free]` = the derivative of each pressure with respect to what it was.
    ///
    /// # Panics
    /// As [`Chain::supply`], and when there are not as many gains as FREEs.
    pub fn deform_with_gains(&self, memory: &mut [T], step: T, pressures: &mut [T], gains: &mut [T]) {
        assert_eq!(gains.len(), self.frees, "there is one gain per FREE");
        gains.fill(T::ONE);
        self.act(&[Link::Mechanics, Link::Reading], memory, |effect, free, own| {
            let (pressure, gain) = effect.kind.pressure_with_gain(effect.values, own, step, pressures[free]);
            pressures[free] = pressure;
            gains[free] *= gain;
        });
    }

    /// Pressures in the FREEs to pressures read (Pa, in place).
    pub fn read_pressures(&self, pressures: &mut [T]) {
        for effect in self.effects.clone().filter(|effect| effect.kind.link() == Link::Sensing) {
            each_of(&effect, pressures, |pressure| pressure_bias::read(effect.values, pressure));
        }
    }

    /// Pressures read to pressures in the FREEs (Pa, in place): inverse of [`Chain::read_pressures`].
    pub fn unread_pressures(&self, pressures: &mut [T])
    where
        I: DoubleEndedIterator,
    {
        for effect in self.effects.clone().rev().filter(|effect| effect.kind.link() == Link::Sensing) {
            each_of(&effect, pressures, |reading| pressure_bias::unread(effect.values, reading));
        }
    }

    /// Factors of the base model's slopes. `hanging_mass` (kg) is what stretches and straightens the base model already: a rubber
    /// stiffer by 1 + a answers `(hanging + payload)/(1 + a)` as the base model does, which knows of `hanging` alone.
    pub fn loads(&self, hanging_mass: T) -> Loads<T> {
        let mut stiffer = T::ONE;
        for effect in self.of(EffectKind::Stiffness) {
            stiffer *= T::ONE + effect.values[0];
        }
        Loads {
            mass: (hanging_mass + self.sum(EffectKind::Payload)) / stiffer - hanging_mass,
            bending_stiffness: self.sum(EffectKind::BendingStiffness),
        }
    }

    /// Change of the winding angle, rad.
    pub fn winding_angle(&self) -> T {
        self.sum(EffectKind::WindingAngle)
    }

    /// The chart of a module whose base model answers `chart`, loads included: what bends further bends further.
    pub fn bend<D: Real + From<T>>(&self, chart: [D; 6]) -> [D; 6] {
        self.of(EffectKind::BendingScale)
            .fold(chart, |chart, effect| bending_scale::chart(effect.values, chart))
    }

    /// Pose to pose read: marker first, then base frame.
    pub fn read_pose<D: Real + From<T>>(&self, pose: &Pose<D>) -> Pose<D> {
        let marked = self
            .of(EffectKind::MarkerFrame)
            .fold(*pose, |pose, effect| marker_frame::pose(effect.values, &pose));
        self.of(EffectKind::BaseFrame).fold(marked, |pose, effect| base_frame::pose(effect.values, &pose))
    }

    fn of(&self, kind: EffectKind) -> impl Iterator<Item = Effect<'a, T>> {
        self.effects.clone().filter(move |effect| effect.kind == kind)
    }

    /// Sum of the first values of all effects of a kind.
    fn sum(&self, kind: EffectKind) -> T {
        self.of(kind).fold(T::ZERO, |sum, effect| sum + effect.values[0])
    }
}

fn each_of<T: Real>(effect: &Effect<'_, T>, pressures: &mut [T], function: impl Fn(T) -> T) {
    for (free, pressure) in pressures.iter_mut().enumerate() {
        if effect.frees >> free & 1 == 1 {
            *pressure = function(*pressure);
        }
    }
}

/// Up to [`MAX_EFFECTS`] effects, and the number of FREEs that they act on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effects<'a, T> {
    effects: [Effect<'a, T>; MAX_EFFECTS],
    count: usize,
    frees: usize,
}

impl<'a, T: Real> Effects<'a, T> {
    /// No effects, on `frees` FREEs.
    pub fn none(frees: usize) -> Self {
        let placeholder = Effect { kind: EffectKind::Stiffness, frees: 0, values: &[] };
        Effects { effects: [placeholder; MAX_EFFECTS], count: 0, frees }
    }

    /// Adds an effect after the others; says what is wrong with it where it cannot be.
    pub fn push(&mut self, effect: Effect<'a, T>) -> Result<(), &'static str> {
        let parameters = effect.kind.parameters();
        if effect.values.len() != parameters.len() {
            return Err("an effect has not as many numbers as its kind takes");
        }
        // Written so that a number that is none fails.
        let within = |(parameter, value): (&super::Parameter, &T)| {
            let slack = 1e-6 * parameter.scale;
            let value = value.to_f64();
            value >= parameter.lower - slack && value <= parameter.upper * (1.0 + 1e-6) + slack
        };
        if !parameters.iter().zip(effect.values).all(within) {
            return Err("a number of an effect is outside its range");
        }
        if effect.frees >> self.frees != 0 {
            return Err("an effect acts on a FREE that the actuator does not have");
        }
        let Some(place) = self.effects.get_mut(self.count) else { return Err("it has too many effects") };
        *place = effect;
        self.count += 1;
        Ok(())
    }

    /// The chain of them.
    pub fn chain(&self) -> Chain<impl DoubleEndedIterator<Item = Effect<'a, T>> + Clone + '_> {
        Chain::new(self.effects[..self.count].iter().copied(), self.frees)
    }
}
