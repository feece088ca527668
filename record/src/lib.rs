//! Recordings of FREE actuators: MCAP (ROS 2 profile) and CSV, reading, repair, resampling.

mod recording;

pub use recording::{Channel, Motion, Recording};
