use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Sense of the fibre's helix about +z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Handedness {
    /// Right-handed screw: the angle grows with z.
    Right,
    /// Left-handed screw, the mirror image.
    Left,
}

impl Handedness {
    /// +1 for right, -1 for left: the factor that turns twist, torque and torsion of a right-handed FREE into this one's.
    pub fn sign(self) -> f64 {
        match self {
            Handedness::Right => 1.0,
            Handedness::Left => -1.0,
        }
    }

    /// The hand of the mirror image.
    pub fn opposite(self) -> Self {
        match self {
            Handedness::Right => Handedness::Left,
            Handedness::Left => Handedness::Right,
        }
    }
}

/// What a fibre answers to compression.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FibreLaw {
    /// Tension = EA (stretch - 1) of either sign: the truss of the paper's finite elements.
    Linear,
    /// Tension = EA max(0, stretch - 1): real thread.
    TensionOnly,
}

/// One thread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fibre {
    /// Axial stiffness EA, N.
    pub axial_stiffness: f64,
    /// Width over which the thread holds the tube's surface, perpendicular to itself, m. A thread without width is a line
    /// load, whose displacement grows for ever as a mesh is refined.
    pub diameter: f64,
    /// Answer to compression.
    pub law: FibreLaw,
}

/// Equal, equally spaced helical fibres on the outer surface of the tube.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Winding {
    /// Angle from the hoop (circumferential) direction, rad: 0 = rings, pi/2 = along the tube.
    angle_from_hoop: f64,
    /// Sense of the helix.
    pub handedness: Handedness,
    /// Number of fibres around the tube.
    pub fibres: u32,
    /// The thread.
    pub fibre: Fibre,
}

impl Winding {
    /// A winding whose angle is measured from the hoop direction (rad), as in this project and in the paper's figures.
    pub fn from_hoop(angle: f64, handedness: Handedness, fibres: u32, fibre: Fibre) -> Self {
        Winding { angle_from_hoop: angle, handedness, fibres, fibre }
    }

    /// A winding whose angle is measured from the tube's axis (rad), as many authors do.
    pub fn from_axis(angle: f64, handedness: Handedness, fibres: u32, fibre: Fibre) -> Self {
        Self::from_hoop(FRAC_PI_2 - angle, handedness, fibres, fibre)
    }

    /// Angle from the hoop direction, rad.
    pub fn angle_from_hoop(&self) -> f64 {
        self.angle_from_hoop
    }

    /// The same winding at another angle from the hoop direction (rad).
    pub fn with_angle_from_hoop(self, angle: f64) -> Self {
        Winding { angle_from_hoop: angle, ..self }
    }

    /// Turn of a fibre per length of a tube of outer radius `outer_radius` (m): k = cot(angle)/B, rad/m, as if right-handed.
    pub fn turn_per_length(&self, outer_radius: f64) -> f64 {
        (FRAC_PI_2 - self.angle_from_hoop).tan() / outer_radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    const THREAD: Fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::Linear };

    #[test]
    fn twenty_from_the_axis_is_seventy_from_the_hoop() {
        let from_axis = Winding::from_axis(20f64.to_radians(), Handedness::Left, 6, THREAD);
        assert!((from_axis.angle_from_hoop().to_degrees() - 70.0).abs() < 1e-12);
    }

    #[test]
    fn a_fibre_along_the_tube_does_not_turn() {
        let along = Winding::from_hoop(FRAC_PI_2, Handedness::Right, 6, THREAD);
        assert!(along.turn_per_length(5e-3).abs() < 1e-9);
        let diagonal = Winding::from_hoop(FRAC_PI_2 / 2.0, Handedness::Right, 6, THREAD);
        assert!((diagonal.turn_per_length(5e-3) - 200.0).abs() < 1e-9);
    }
}
