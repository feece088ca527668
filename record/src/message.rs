//! The messages of a log as CDR lays them out: field order and types are those of the `.msg` texts.

use serde::{Deserialize, Serialize};

/// A message type: its name and its whole definition.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MessageType {
    /// Name, as `sensor_msgs/msg/FluidPressure`.
    pub name: &'static str,
    /// Definition with everything it rests on (schema encoding `ros2msg`).
    pub definition: &'static str,
}

pub(crate) const FLUID_PRESSURE: MessageType = MessageType {
    name: "sensor_msgs/msg/FluidPressure",
    definition: include_str!("../msg/FluidPressure.msg"),
};
pub(crate) const POSE_STAMPED: MessageType =
    MessageType { name: "geometry_msgs/msg/PoseStamped", definition: include_str!("../msg/PoseStamped.msg") };
pub(crate) const MARKER_ARRAY: MessageType = MessageType {
    name: "visualization_msgs/msg/MarkerArray",
    definition: include_str!("../msg/MarkerArray.msg"),
};
pub(crate) const FREE_STATE: MessageType =
    MessageType { name: "freeact_msgs/msg/FreeState", definition: include_str!("../msg/FreeState.msg") };
pub(crate) const SOLVE: MessageType =
    MessageType { name: "freeact_msgs/msg/Solve", definition: include_str!("../msg/Solve.msg") };

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stamp {
    pub sec: i32,
    pub nanosec: u32,
}

impl Stamp {
    pub fn from_nanoseconds(nanoseconds: u64) -> Self {
        // ROS counts seconds in 32 bits: good until 2038.
        let sec = i32::try_from(nanoseconds / 1_000_000_000).unwrap_or(i32::MAX);
        Stamp { sec, nanosec: (nanoseconds % 1_000_000_000) as u32 }
    }

    pub fn nanoseconds(self) -> Option<u64> {
        let sec = u64::try_from(self.sec).ok()?;
        Some(sec * 1_000_000_000 + u64::from(self.nanosec))
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    pub stamp: Stamp,
    pub frame_id: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FluidPressure {
    pub header: Header,
    pub fluid_pressure: f64,
    pub variance: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Point {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pose {
    pub position: Point,
    pub orientation: Quaternion,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PoseStamped {
    pub header: Header,
    pub pose: Pose,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Color {
    pub r: f32,
    pub g: f32,
    pub b: f32,
    pub a: f32,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CompressedImage {
    pub header: Header,
    pub format: String,
    pub data: Vec<u8>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeshFile {
    pub filename: String,
    pub data: Vec<u8>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Marker {
    pub header: Header,
    pub ns: String,
    pub id: i32,
    pub kind: i32,
    pub action: i32,
    pub pose: Pose,
    pub scale: Point,
    pub color: Color,
    pub lifetime: Stamp,
    pub frame_locked: bool,
    pub points: Vec<Point>,
    pub colors: Vec<Color>,
    pub texture_resource: String,
    pub texture: CompressedImage,
    pub uv_coordinates: Vec<[f32; 2]>,
    pub text: String,
    pub mesh_resource: String,
    pub mesh_file: MeshFile,
    pub mesh_use_embedded_materials: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MarkerArray {
    pub markers: Vec<Marker>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FreeStateMessage {
    pub header: Header,
    pub twist: f64,
    pub extension: f64,
    pub outer_diameter: f64,
    pub torque: f64,
    pub force: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SolveMessage {
    pub header: Header,
    pub solve: crate::SolveRecord,
}

/// Encodes a message: the four bytes that say little-endian CDR, then the fields.
pub(crate) fn encode<T: Serialize>(message: &T) -> Result<Vec<u8>, String> {
    let mut bytes = vec![0, 1, 0, 0];
    cdr_encoding::to_writer::<T, byteorder::LittleEndian, _>(&mut bytes, message)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Decodes a message of either byte order.
pub(crate) fn decode<T: for<'de> Deserialize<'de>>(bytes: &[u8]) -> Result<T, String> {
    let fault = |error: cdr_encoding::Error| format!("the message is cut short or of another type ({error})");
    match bytes {
        [0, 1, _, _, body @ ..] => cdr_encoding::from_bytes::<T, byteorder::LittleEndian>(body)
            .map(|(message, _)| message)
            .map_err(fault),
        [0, 0, _, _, body @ ..] => cdr_encoding::from_bytes::<T, byteorder::BigEndian>(body)
            .map(|(message, _)| message)
            .map_err(fault),
        _ => Err("the message does not begin with the mark of plain CDR (00 00 or 00 01)".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pressure_is_laid_out_as_cdr_says() {
        let header = Header { stamp: Stamp { sec: 1, nanosec: 2 }, frame_id: "ab".into() };
        let message = FluidPressure { header, fluid_pressure: 101_325.0, variance: 0.0 };
        let bytes = encode(&message).unwrap();
        let mut expected = vec![0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0];
        // Length with the closing zero, the text, padding to eight bytes behind the mark.
        expected.extend([3, 0, 0, 0, b'a', b'b', 0, 0]);
        expected.extend([0; 4].iter().take((8 - (expected.len() - 4) % 8) % 8));
        expected.extend(101_325.0f64.to_le_bytes());
        expected.extend(0.0f64.to_le_bytes());
        assert_eq!(bytes, expected);
        assert_eq!(decode::<FluidPressure>(&bytes).unwrap(), message);
        assert!(decode::<FluidPressure>(&bytes[..20]).unwrap_err().contains("cut short"));
        assert!(decode::<FluidPressure>(&[9, 9]).unwrap_err().contains("plain CDR"));
    }
}
