use crate::{Quantity, RecordError};
use actuator::{Description, Rig, units::KPA};
use std::collections::BTreeMap;
use toml::Value;

/// Standard atmosphere, kPa: the ambient pressure where a rig states none.
const DEFAULT_AMBIENT_KPA: f64 = 101.325;
/// Words in the free text `pose` that say the same as `pose_origin = "start"`.
const FROM_START: &str = "relative to the pose at the start";

/// What pressures of a file are measured against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PressureReference {
    /// The ambient pressure.
    Gauge,
    /// Vacuum; the ambient pressure is taken off on reading.
    Absolute,
}

/// Where positions of a file are measured from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseOrigin {
    /// The base plate's centre.
    Base,
    /// The tip plate's place at the start of the recording, taken to be the rest position (0, 0, length).
    Start,
}

/// How the recordings of a rig are written: its table `[recordings]`, read and checked.
///
/// ```toml
/// [recordings]
/// pressure = "gauge"        # or "absolute": pressures in CSV files; default gauge
/// topic_pressure = "absolute"  # or "gauge": sensor_msgs/FluidPressure in bags, absolute by its definition
/// ambient_kpa = 101.325     # taken off absolute pressures, stated in MCAP files
/// pose_origin = "base"      # or "start": positions from the tip's place at the start; rest (0, 0, length) is added
/// pose = "free text"        # for people; "relative to the pose at the start" in it means pose_origin = "start"
/// rate_hz = 20              # nominal rate; a recording that keeps another is reported
/// delimiter = ","           # of CSV files
/// ignore = ["temperature"]  # columns to pass over
/// [recordings.columns]      # our name with its unit = name in the file; "p1_psi" says that the file's numbers are psi
/// t_s = "time"
/// p1_command_kpa = "set 1"
/// [recordings.topics]       # what = topic in the bag; what is not named keeps the topics that freeact writes
/// p1_command = "/valves/one/set"
/// p1 = "/valves/one/read"
/// tip_pose = "/mocap/plate/pose"
/// ```
/// Every key may be absent. Units of columns: pressure kpa, pa, mpa, bar, mbar, psi; length mm, m, cm, um, in; angle rad,
/// deg, mrad; time s, ms, us, ns, min; torque nmm, nm, mnm; force n, mn.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Reference of the pressures in CSV files.
    pub pressure: PressureReference,
    /// Reference of the pressures in MCAP files that freeact did not write.
    pub topic_pressure: PressureReference,
    /// Ambient pressure, Pa.
    pub ambient: f64,
    /// Origin of the positions.
    pub pose_origin: PoseOrigin,
    /// Nominal sampling rate, Hz.
    pub rate: Option<f64>,
    /// Delimiter of CSV files.
    pub delimiter: u8,
    /// Columns to pass over.
    pub ignore: Vec<String>,
    /// Column of the file to the quantity it holds and the SI value of its unit.
    pub columns: BTreeMap<String, (Quantity, f64)>,
    /// What is sought (`p1_command`, `p1`, `tip_pose`, `tip_target`, `free_state`) to the topic it is found on.
    pub topics: BTreeMap<String, String>,
    /// Number of FREEs.
    pub frees: usize,
    /// Whether the rig is a single FREE.
    pub single_free: bool,
    /// Length of the actuator at rest, m.
    pub length: f64,
    /// Greatest pressure of each FREE, Pa.
    pub pressure_max: Vec<f64>,
}

impl Layout {
    /// Reads the table `[recordings]` of a rig.
    pub fn of(rig: &Rig) -> Result<Self, RecordError> {
        let (single_free, length) = match &rig.description {
            Description::Free(free) => (true, free.tube.length),
            Description::Module(module) => (false, module.length()),
        };
        let mut layout = Layout {
            pressure: PressureReference::Gauge,
            topic_pressure: PressureReference::Absolute,
            ambient: DEFAULT_AMBIENT_KPA * KPA,
            pose_origin: PoseOrigin::Base,
            rate: None,
            delimiter: b',',
            ignore: Vec::new(),
            columns: BTreeMap::new(),
            topics: BTreeMap::new(),
            frees: rig.frees().len(),
            single_free,
            length,
            pressure_max: rig.limits.pressure_max.clone(),
        };
        for (field, value) in &rig.recordings {
            layout.take(field, value).map_err(|(field, message)| RecordError::Layout {
                path: rig.path.clone(),
                line: line_of(&rig.text, &field),
                field,
                message,
            })?;
        }
        Ok(layout)
    }

    fn take(&mut self, field: &str, value: &Value) -> Result<(), (String, String)> {
        let fault = |message: String| (field.to_owned(), message);
        match field {
            "pressure" => self.pressure = reference(value).map_err(fault)?,
            "topic_pressure" => self.topic_pressure = reference(value).map_err(fault)?,
            "ambient_kpa" => self.ambient = positive(value).map_err(fault)? * KPA,
            "rate_hz" => self.rate = Some(positive(value).map_err(fault)?),
            "pose_origin" => {
                self.pose_origin = match text(value).map_err(fault)? {
                    "base" => PoseOrigin::Base,
                    "start" => PoseOrigin::Start,
                    other => {
                        return Err(fault(format!("\"{other}\" is not known; write \"base\" or \"start\"")));
                    }
                }
            }
            "pose" => {
                if text(value).map_err(fault)?.contains(FROM_START) {
                    self.pose_origin = PoseOrigin::Start;
                }
            }
            "delimiter" => {
                self.delimiter = match text(value).map_err(fault)?.as_bytes() {
                    [byte] if *byte != b'"' && *byte != b'\n' => *byte,
                    _ => return Err(fault("must be one character such as \",\", \";\" or \"\\t\"".into())),
                }
            }
            "ignore" => {
                let Value::Array(names) = value else {
                    return Err(fault("must be a list of column names, as [\"temperature\"]".into()));
                };
                for name in names {
                    self.ignore.push(text(name).map_err(fault)?.to_owned());
                }
            }
            "columns" => {
                for (target, column) in table(value).map_err(fault)? {
                    let fault = |message: String| (target.clone(), message);
                    let quantity = Quantity::from_column(target).map_err(fault)?;
                    let column = text(column).map_err(fault)?.to_owned();
                    if self.columns.insert(column.clone(), quantity).is_some() {
                        return Err(fault(format!(
                            "column \"{column}\" is already mapped to another quantity"
                        )));
                    }
                }
            }
            "topics" => {
                for (what, topic) in table(value).map_err(fault)? {
                    let fault = |message: String| (what.clone(), message);
                    let known = self.topic_keys();
                    if !known.contains(what) {
                        return Err(fault(format!("unknown name; this rig has {}", known.join(", "))));
                    }
                    self.topics.insert(what.clone(), text(topic).map_err(fault)?.to_owned());
                }
            }
            _ => {
                return Err(fault(
                    "unknown field; known are pressure, topic_pressure, ambient_kpa, pose_origin, pose, rate_hz, \
                     delimiter, ignore and the tables columns and topics"
                        .into(),
                ));
            }
        }
        Ok(())
    }

    /// What may be sought in a bag: pressures of each FREE, and the tip or the state of the FREE.
    pub fn topic_keys(&self) -> Vec<String> {
        let mut keys = Vec::new();
        for free in 1..=self.frees {
            keys.push(format!("p{free}_command"));
            keys.push(format!("p{free}"));
        }
        if self.single_free {
            keys.push("free_state".into());
        } else {
            keys.extend(["tip_pose".into(), "tip_target".into()]);
        }
        keys
    }
}

/// Line (from one) of `field` in the part of a rig file that begins with `[recordings`.
fn line_of(text: &str, field: &str) -> usize {
    let mut inside = false;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start();
        if line.starts_with('[') {
            inside = line.starts_with("[recordings");
            if inside && line.starts_with(&format!("[recordings.{field}]")) {
                return index + 1;
            }
        }
        let key = line.split('=').next().unwrap_or_default().trim().trim_matches('"');
        if inside && key == field {
            return index + 1;
        }
    }
    text.lines().position(|line| line.trim_start().starts_with("[recordings")).map_or(1, |index| index + 1)
}

fn text(value: &Value) -> Result<&str, String> {
    value.as_str().ok_or_else(|| format!("must be a text in quotes, not {}", value.type_str()))
}

fn table(value: &Value) -> Result<&toml::Table, String> {
    value.as_table().ok_or_else(|| format!("must be a table, not {}", value.type_str()))
}

fn reference(value: &Value) -> Result<PressureReference, String> {
    match text(value)? {
        "gauge" => Ok(PressureReference::Gauge),
        "absolute" => Ok(PressureReference::Absolute),
        other => Err(format!("\"{other}\" is not known; write \"gauge\" or \"absolute\"")),
    }
}

fn positive(value: &Value) -> Result<f64, String> {
    let number = match value {
        Value::Float(number) => *number,
        Value::Integer(number) => *number as f64,
        other => return Err(format!("must be a number, not {}", other.type_str())),
    };
    if number > 0.0 && number.is_finite() {
        Ok(number)
    } else {
        Err(format!("must be positive, not {number}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig_for_tests;

    #[test]
    fn an_absent_table_gives_the_usual_layout() {
        let layout = Layout::of(&rig_for_tests(2, "")).unwrap();
        assert_eq!(layout.ambient, 101_325.0);
        assert_eq!((layout.pressure, layout.pose_origin), (PressureReference::Gauge, PoseOrigin::Base));
        assert_eq!(layout.frees, 2);
        // 175 times a rounded thousandth.
        assert!((layout.length - 0.175).abs() < 1e-15);
        assert_eq!(layout.topic_keys(), ["p1_command", "p1", "p2_command", "p2", "tip_pose", "tip_target"]);
    }

    #[test]
    fn a_full_table_is_understood() {
        let layout = Layout::of(&rig_for_tests(
            1,
            "[recordings]\npressure = \"absolute\"\nambient_kpa = 95\nrate_hz = 20\ndelimiter = \";\"\n\
             pose = \"x, y, z in mm, relative to the pose at the start of the recording\"\nignore = [\"a\"]\n\
             [recordings.columns]\np1_psi = \"P one\"\n[recordings.topics]\np1 = \"/p\"\n",
        ))
        .unwrap();
        assert_eq!((layout.pressure, layout.ambient), (PressureReference::Absolute, 95e3));
        assert_eq!((layout.pose_origin, layout.rate), (PoseOrigin::Start, Some(20.0)));
        assert_eq!(layout.columns["P one"].0, Quantity::Pressure(0));
        assert_eq!((layout.topics["p1"].as_str(), layout.delimiter), ("/p", b';'));
    }

    #[test]
    fn faults_name_the_line_and_the_remedy() {
        let message = |table: &str| Layout::of(&rig_for_tests(1, table)).unwrap_err().to_string();
        let first = rig_for_tests(1, "").text.lines().count() + 1;
        let text = message("[recordings]\npressure = \"gage\"\n");
        assert!(text.contains(&format!(":{}: ", first + 1)), "{text}");
        assert!(text.contains("\"gage\" is not known; write \"gauge\" or \"absolute\""), "{text}");
        assert!(message("[recordings]\nrate_hz = -1\n").contains("must be positive, not -1"));
        assert!(message("[recordings]\nrate = 1\n").contains("unknown field; known are pressure"));
        let text = message("[recordings.columns]\nt_s = \"time\"\np1 = \"x\"\n");
        assert!(text.contains("write p1_kpa") && text.contains(&format!(":{}: ", first + 2)), "{text}");
        assert!(
            message("[recordings.topics]\np2 = \"/x\"\n").contains("this rig has p1_command, p1, tip_pose")
        );
        assert!(message("[recordings.columns]\nt_s = \"a\"\nx_mm = \"a\"\n").contains("already mapped"));
    }
}
