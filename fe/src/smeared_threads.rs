use crate::jet::Jet;
use actuator::{FibreLaw, Free};

/// The threads of a FREE spread evenly over its outer surface, as if right-handed.
///
/// A thread of turn `k = cot(angle)/B` is stretched to `sqrt((b/B)^2 (kB + psi)^2 + lambda^2)/sqrt((kB)^2 + 1)`, with b the outer radius, B that
/// at rest, lambda the axial stretch and psi = tau B the twist over a length of B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SmearedThreads {
    /// n EA sqrt((kB)^2 + 1), N: threads' stiffness times their length per length of the tube.
    stiffness: f64,
    /// kB.
    turn: f64,
    law: FibreLaw,
    /// Length of a thread over that of its helix at rest, minus one.
    slack: f64,
}

impl SmearedThreads {
    /// Those of a FREE.
    pub fn of(free: &Free) -> Self {
        let radius = free.tube.outer_radius();
        let turn = free.winding.turn_per_length(radius) * radius;
        let fibre = free.winding.fibre;
        let stiffness = f64::from(free.winding.fibres) * fibre.axial_stiffness * turn.hypot(1.0);
        SmearedThreads { stiffness, turn, law: fibre.law, slack: 0.0 }
    }

    /// The threads wound loosely: longer than their helix at rest by this share of it. Those that carry tension only do nothing
    /// before the tube has filled them.
    pub fn with_slack(self, slack: f64) -> Self {
        SmearedThreads { stiffness: self.stiffness * (1.0 + slack) / (1.0 + self.slack), slack, ..self }
    }

    /// Energy per reference length, J/m, by (b/B)^2, stretch, and twist times B. `None` where threads that carry tension only are slack.
    pub fn energy(&self, outer: Jet, stretch: Jet, twist: Jet) -> Option<Jet> {
        let turned = twist + Jet::constant(self.turn);
        let squared = (outer * turned * turned + stretch * stretch) * (1.0 / self.length_squared());
        let elongation = squared.powf(0.5) - Jet::constant(1.0);
        let carries = self.law == FibreLaw::Linear || elongation.value > 0.0;
        carries.then(|| elongation * elongation * (0.5 * self.stiffness))
    }

    /// (b/B)^2 at which threads that carry tension only tighten; infinite where they never do, not a number where it does not matter to them.
    /// `None` where they always carry.
    pub fn tight_at(&self, axial_stretch: f64, twist: f64) -> Option<f64> {
        let turned = twist + self.turn;
        let room = self.length_squared() - axial_stretch * axial_stretch;
        (self.law == FibreLaw::TensionOnly).then(|| room / (turned * turned))
    }

    /// (Thread's length over the tube's at rest)^2.
    fn length_squared(&self) -> f64 {
        (self.turn * self.turn + 1.0) * (1.0 + self.slack).powi(2)
    }
}
