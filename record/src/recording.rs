use crate::{Layout, Quantity};
use actuator::TipPose;

/// Samples of one quantity over the times of a recording; NaN = not measured.
pub type Channel = Vec<f64>;

/// What was seen of the actuator's deformation. Channels that were not measured are filled with NaN.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Tip plate of a module in the base frame.
    Pose {
        /// x, y, z, m.
        position: [Channel; 3],
        /// w, x, y, z; unit length where measured.
        rotation: [Channel; 4],
    },
    /// A single FREE, cap to cap.
    Free {
        /// Twist of the whole FREE, rad.
        twist: Channel,
        /// Change of length, m.
        extension: Channel,
        /// Outer diameter, m.
        outer_diameter: Channel,
        /// Torque on the free end, N m, positive about +z.
        torque: Channel,
        /// Axial force on the free end, N, positive in tension.
        force: Channel,
    },
}

/// A recording of an actuator: what was commanded, what pressure was read, what was seen. SI, gauge pressures.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Name, for reports.
    pub name: String,
    /// Times, s, rising.
    pub time: Vec<f64>,
    /// Commanded pressure of each FREE, Pa; empty when not recorded at all.
    pub command: Vec<Channel>,
    /// Measured pressure of each FREE, Pa; empty when not recorded at all.
    pub pressure: Vec<Channel>,
    /// The deformation.
    pub motion: Motion,
}

impl Recording {
    /// A recording of nothing yet at the given times, with room for what the rig can show.
    pub fn unmeasured(name: impl Into<String>, time: Vec<f64>, layout: &Layout) -> Self {
        let nothing = vec![f64::NAN; time.len()];
        let motion = if layout.single_free {
            Motion::Free {
                twist: nothing.clone(),
                extension: nothing.clone(),
                outer_diameter: nothing.clone(),
                torque: nothing.clone(),
                force: nothing.clone(),
            }
        } else {
            Motion::Pose {
                position: [nothing.clone(), nothing.clone(), nothing.clone()],
                rotation: [nothing.clone(), nothing.clone(), nothing.clone(), nothing.clone()],
            }
        };
        let pressures = vec![nothing; layout.frees];
        Recording { name: name.into(), time, command: pressures.clone(), pressure: pressures, motion }
    }

    /// Empties the commands or the pressures when not a single one was recorded.
    pub(crate) fn drop_unrecorded(mut self) -> Self {
        for channels in [&mut self.command, &mut self.pressure] {
            if channels.iter().flatten().all(|value| value.is_nan()) {
                channels.clear();
            }
        }
        self
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Tip pose at sample `index`, where it was measured whole.
    pub fn pose(&self, index: usize) -> Option<TipPose> {
        let Motion::Pose { position, rotation } = &self.motion else { return None };
        let at = |channel: &Channel| channel[index];
        TipPose::from_parts(position.each_ref().map(at), rotation.each_ref().map(at))
    }

    /// The channel of a quantity; `None` where this recording cannot hold it.
    pub fn channel(&self, quantity: Quantity) -> Option<&Channel> {
        match (quantity, &self.motion) {
            (Quantity::Time, _) => Some(&self.time),
            (Quantity::Command(free), _) => self.command.get(free),
            (Quantity::Pressure(free), _) => self.pressure.get(free),
            (Quantity::Position(axis), Motion::Pose { position, .. }) => position.get(axis),
            (Quantity::Rotation(component), Motion::Pose { rotation, .. }) => rotation.get(component),
            (Quantity::Twist, Motion::Free { twist, .. }) => Some(twist),
            (Quantity::Extension, Motion::Free { extension, .. }) => Some(extension),
            (Quantity::OuterDiameter, Motion::Free { outer_diameter, .. }) => Some(outer_diameter),
            (Quantity::Torque, Motion::Free { torque, .. }) => Some(torque),
            (Quantity::Force, Motion::Free { force, .. }) => Some(force),
            _ => None,
        }
    }

    /// The channel of a quantity, to be changed.
    pub fn channel_mut(&mut self, quantity: Quantity) -> Option<&mut Channel> {
        match (quantity, &mut self.motion) {
            (Quantity::Time, _) => Some(&mut self.time),
            (Quantity::Command(free), _) => self.command.get_mut(free),
            (Quantity::Pressure(free), _) => self.pressure.get_mut(free),
            (Quantity::Position(axis), Motion::Pose { position, .. }) => position.get_mut(axis),
            (Quantity::Rotation(component), Motion::Pose { rotation, .. }) => rotation.get_mut(component),
            (Quantity::Twist, Motion::Free { twist, .. }) => Some(twist),
            (Quantity::Extension, Motion::Free { extension, .. }) => Some(extension),
            (Quantity::OuterDiameter, Motion::Free { outer_diameter, .. }) => Some(outer_diameter),
            (Quantity::Torque, Motion::Free { torque, .. }) => Some(torque),
            (Quantity::Force, Motion::Free { force, .. }) => Some(force),
            _ => None,
        }
    }

    /// The quantities that this recording has channels for, time left out, in the order of the columns of a file.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut all: Vec<Quantity> = (0..self.command.len()).map(Quantity::Command).collect();
        all.extend((0..self.pressure.len()).map(Quantity::Pressure));
        match self.motion {
            Motion::Pose { .. } => {
                all.extend((0..3).map(Quantity::Position));
                all.extend((0..4).map(Quantity::Rotation));
            }
            Motion::Free { .. } => all.extend([
                Quantity::Twist,
                Quantity::Extension,
                Quantity::OuterDiameter,
                Quantity::Torque,
                Quantity::Force,
            ]),
        }
        all
    }
}
