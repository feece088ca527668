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
    /// Tip pose at sample `index`, where it was measured whole.
    pub fn pose(&self, index: usize) -> Option<TipPose> {
        let Motion::Pose { position, rotation } = &self.motion else { return None };
        let at = |channel: &Channel| channel[index];
        TipPose::from_parts(position.each_ref().map(at), rotation.each_ref().map(at))
    }
}
