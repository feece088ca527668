//! Cells of CSV files: numbers and poses in the units that the columns name.

use crate::columns::rounded;
use actuator::{TipPose, units::MM};

/// Columns of a pose.
pub const POSE_HEADER: &str = "x_mm,y_mm,z_mm,qw,qx,qy,qz";

/// A number for a file: twelve significant figures, without the dust of a conversion of units.
pub fn number(value: f64) -> String {
    rounded(value).map(|value| value.to_string()).unwrap_or_default()
}

/// Cells of the pressures' columns `p1_kpa`, ...
pub fn pressure_header(count: usize) -> Vec<String> {
    (1..=count).map(|i| format!("p{i}_kpa")).collect()
}

/// Numbers of [`POSE_HEADER`].
pub fn pose_numbers(pose: &TipPose) -> impl Iterator<Item = f64> {
    pose.position.iter().map(|metres| metres / MM).chain(pose.wxyz()).collect::<Vec<_>>().into_iter()
}

/// Cells of [`POSE_HEADER`].
pub fn pose_cells(pose: &TipPose) -> Vec<String> {
    pose_numbers(pose).map(number).collect()
}
