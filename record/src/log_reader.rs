use crate::log_writer::{
    FORMAT, FREE_STATE_TOPIC, METADATA, MODEL_ATTACHMENT, RIG_ATTACHMENT, SOLVE_TOPIC, command_topic,
    pressure_topic,
};
use crate::message::{
    FLUID_PRESSURE, FREE_STATE, FluidPressure, FreeStateMessage, Header, MessageType, POSE_STAMPED,
    PoseStamped, SOLVE, SolveMessage, decode,
};
use crate::raw_log::{RawLog, RawMessage, read_raw};
use crate::{
    FindingKind, Findings, Layout, Motion, PoseOrigin, PressureReference, RecordError, Recording,
    SolveRecord, TipTopic, examine,
};
use actuator::Rig;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::path::Path;

/// A pose as a log keeps it: time (s), position (m), rotation (w, x, y, z).
pub type TimedPose = (f64, [f64; 3], [f64; 4]);

/// Everything that a log holds.
#[derive(Clone, Debug)]
pub struct Log {
    /// What was commanded, read and seen, on the union of the times at which anything was measured.
    pub recording: Recording,
    /// Poses that a model predicted.
    pub predicted: Vec<TimedPose>,
    /// Poses that were wanted.
    pub targets: Vec<TimedPose>,
    /// The solves, with every number that went in and came out, bit for bit.
    pub solves: Vec<SolveRecord>,
    /// The metadata record `freeact`; empty in files of other programs.
    pub metadata: BTreeMap<String, String>,
    /// The attached rig file; `None` in files of other programs.
    pub rig_text: Option<String>,
    /// The attached model file, where there is one.
    pub model: Option<Vec<u8>>,
    /// Number of messages on each topic.
    pub message_counts: BTreeMap<String, usize>,
    /// What is irregular, a file that was cut off included.
    pub findings: Findings,
}

/// Reads a log: one that freeact wrote, or any ROS 2 bag in MCAP with `sensor_msgs/msg/FluidPressure` and
/// `geometry_msgs/msg/PoseStamped`, on our topics or those of `[recordings.topics]`. Without a rig, the attached one is used.
///
/// A file that was cut off is read as far as it goes; how far stands in the findings.
///
/// # Errors
/// No MCAP file; one without a single message; a topic that the rig names and the file has not, or of another type; a message
/// that cannot be decoded; neither a rig given nor one attached; a rig with another number of FREEs.
pub fn read_mcap(path: &Path, rig: Option<&Rig>) -> Result<Log, RecordError> {
    let raw = read_raw(path)?;
    let attached = raw.attachment(RIG_ATTACHMENT).map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    let layout = match (rig, &attached) {
        (Some(rig), _) => Layout::of(rig)?,
        (None, Some(text)) => {
            let inside = path.join(RIG_ATTACHMENT);
            let rig = Rig::parse(&inside, text.clone()).map_err(|error| RecordError::Mcap {
                path: path.to_owned(),
                message: format!("the attached rig cannot be read: {error}"),
                source: None,
            })?;
            Layout::of(&rig)?
        }
        (None, None) => {
            let message = "no rig is attached to this file; give one with --rig".to_owned();
            return Err(RecordError::Mcap { path: path.to_owned(), message, source: None });
        }
    };
    let metadata = raw.metadata.get(METADATA).cloned().unwrap_or_default();
    let reader = Reader { path, raw: &raw, layout: &layout, metadata: &metadata };
    reader.check_metadata()?;
    let mut findings = raw.findings.clone();
    let origin = reader.origin()?;
    let recording = reader.recording(origin, &mut findings)?;
    let predicted = reader.poses(TipTopic::Predicted.topic())?;
    let targets = reader.poses(&reader.topic("tip_target", TipTopic::Target.topic()))?;
    let solves = reader.messages::<SolveMessage>(SOLVE_TOPIC, SOLVE)?;
    findings.append(examine(&recording, &layout));
    let poses = |list: Vec<StampedPose>| {
        list.into_iter()
            .map(|(stamp, position, rotation)| (seconds(stamp, origin), position, rotation))
            .collect()
    };
    Ok(Log {
        recording,
        predicted: poses(predicted),
        targets: poses(targets),
        solves: solves.into_iter().map(|(_, message)| message.solve).collect(),
        rig_text: attached,
        model: raw.attachment(MODEL_ATTACHMENT).map(<[u8]>::to_vec),
        message_counts: raw.topics.iter().map(|(name, topic)| (name.clone(), topic.messages.len())).collect(),
        metadata,
        findings,
    })
}

/// Seconds between two stamps. Whole nanoseconds over 1e9 round to the very f64 that a decimal of nine places reads as.
fn seconds(stamp: u64, origin: u64) -> f64 {
    (i128::from(stamp) - i128::from(origin)) as f64 / 1e9
}

/// A pose and its stamp, ns.
type StampedPose = (u64, [f64; 3], [f64; 4]);

struct Reader<'a> {
    path: &'a Path,
    raw: &'a RawLog,
    layout: &'a Layout,
    metadata: &'a BTreeMap<String, String>,
}

impl Reader<'_> {
    fn fault(&self, message: String) -> RecordError {
        RecordError::Mcap { path: self.path.to_owned(), message, source: None }
    }

    fn check_metadata(&self) -> Result<(), RecordError> {
        if let Some(format) = self.metadata.get("format").filter(|format| *format != FORMAT) {
            return Err(self.fault(format!(
                "log format {format} is not known here (this program reads {FORMAT}); use a newer freeact"
            )));
        }
        let frees: Option<usize> = self.metadata.get("frees").and_then(|text| text.parse().ok());
        match frees {
            Some(frees) if frees != self.layout.frees => Err(self.fault(format!(
                "the log is of {frees} FREEs, the rig has {}; give the rig that it was recorded on",
                self.layout.frees
            ))),
            _ => Ok(()),
        }
    }

    /// A number of the metadata, where the file is ours.
    fn number<T: std::str::FromStr>(&self, key: &str) -> Result<Option<T>, RecordError> {
        let Some(text) = self.metadata.get(key) else { return Ok(None) };
        let fault = |_| {
            self.fault(format!(
                "metadata `{key}` says \"{text}\", which is not a number; the file is damaged"
            ))
        };
        text.parse().map(Some).map_err(fault)
    }

    /// The topic on which something is sought: the rig's, or ours.
    fn topic(&self, key: &str, ours: &str) -> String {
        match self.layout.topics.get(key) {
            // A file that has our topic needs no mapping.
            Some(mapped) if self.raw.topics.contains_key(mapped) || !self.raw.topics.contains_key(ours) => {
                mapped.clone()
            }
            _ => ours.to_owned(),
        }
    }

    /// Time of t = 0: the file's own word, or its earliest stamp.
    fn origin(&self) -> Result<u64, RecordError> {
        if let Some(origin) = self.number("time_origin_ns")? {
            return Ok(origin);
        }
        let mut earliest = u64::MAX;
        for free in 0..self.layout.frees {
            for (key, ours) in [
                (format!("p{}_command", free + 1), command_topic(free)),
                (format!("p{}", free + 1), pressure_topic(free)),
            ] {
                let times = self.messages::<FluidPressure>(&self.topic(&key, &ours), FLUID_PRESSURE)?;
                earliest = times.iter().map(|(stamp, _)| *stamp).fold(earliest, u64::min);
            }
        }
        let poses =
            self.messages::<PoseStamped>(&self.topic("tip_pose", TipTopic::Measured.topic()), POSE_STAMPED)?;
        earliest = poses.iter().map(|(stamp, _)| *stamp).fold(earliest, u64::min);
        Ok(if earliest == u64::MAX { 0 } else { earliest })
    }

    /// Every message of a topic in the order of its stamps. An absent topic has none, unless the rig names it.
    fn messages<T: Stamped + DeserializeOwned>(
        &self,
        topic: &str,
        kind: MessageType,
    ) -> Result<Vec<(u64, T)>, RecordError> {
        let Some(found) = self.raw.topics.get(topic) else {
            if self.layout.topics.values().any(|mapped| mapped == topic) {
                let have: Vec<&str> = self.raw.topics.keys().map(String::as_str).collect();
                return Err(self.fault(format!(
                    "topic {topic}, which the rig names under [recordings.topics], is not in the file, which has {}",
                    have.join(", ")
                )));
            }
            return Ok(Vec::new());
        };
        // Some writers leave the `msg` out.
        if found.schema.replace("/msg/", "/") != kind.name.replace("/msg/", "/") || found.encoding != "cdr" {
            return Err(self.fault(format!(
                "topic {topic} carries {} ({}); {} (cdr) is needed",
                found.schema, found.encoding, kind.name
            )));
        }
        let decoded = found.messages.iter().enumerate().map(|(index, RawMessage { log_time, data })| {
            let message: T = decode(data).map_err(|message| RecordError::Message {
                path: self.path.to_owned(),
                topic: topic.to_owned(),
                index: index + 1,
                time_ns: *log_time,
                message,
            })?;
            // A stamp of zero is an unfilled one, save in logs that begin at zero, where both are the same.
            let stamp = message.header().stamp.nanoseconds().filter(|stamp| *stamp > 0).unwrap_or(*log_time);
            Ok((stamp, message))
        });
        let mut decoded = decoded.collect::<Result<Vec<_>, RecordError>>()?;
        decoded.sort_by_key(|(stamp, _)| *stamp);
        Ok(decoded)
    }

    fn poses(&self, topic: &str) -> Result<Vec<StampedPose>, RecordError> {
        let messages = self.messages::<PoseStamped>(topic, POSE_STAMPED)?;
        let poses = messages.into_iter().map(|(stamp, message)| {
            let (p, q) = (message.pose.position, message.pose.orientation);
            (stamp, [p.x, p.y, p.z], [q.w, q.x, q.y, q.z])
        });
        Ok(poses.collect())
    }

    fn pressures(&self, key: &str, ours: &str) -> Result<Vec<(u64, f64)>, RecordError> {
        let ambient = match (self.number("ambient_pressure_pa")?, self.layout.topic_pressure) {
            (Some(ambient), _) => ambient,
            (None, PressureReference::Absolute) => self.layout.ambient,
            (None, PressureReference::Gauge) => 0.0,
        };
        let messages = self.messages::<FluidPressure>(&self.topic(key, ours), FLUID_PRESSURE)?;
        Ok(messages.into_iter().map(|(stamp, message)| (stamp, message.fluid_pressure - ambient)).collect())
    }

    fn recording(&self, origin: u64, findings: &mut Findings) -> Result<Recording, RecordError> {
        let layout = self.layout;
        let mut commands = Vec::new();
        let mut pressures = Vec::new();
        for free in 0..layout.frees {
            commands.push(self.pressures(&format!("p{}_command", free + 1), &command_topic(free))?);
            pressures.push(self.pressures(&format!("p{}", free + 1), &pressure_topic(free))?);
        }
        let (poses, states) = if layout.single_free {
            let topic = self.topic("free_state", FREE_STATE_TOPIC);
            (Vec::new(), self.messages::<FreeStateMessage>(&topic, FREE_STATE)?)
        } else {
            (self.poses(&self.topic("tip_pose", TipTopic::Measured.topic()))?, Vec::new())
        };
        let mut stamps: Vec<u64> =
            commands.iter().chain(&pressures).flatten().map(|(stamp, _)| *stamp).collect();
        stamps.extend(poses.iter().map(|(stamp, ..)| *stamp));
        stamps.extend(states.iter().map(|(stamp, _)| *stamp));
        stamps.sort_unstable();
        stamps.dedup();
        if stamps.is_empty() {
            let have: Vec<&str> = self.raw.topics.keys().map(String::as_str).collect();
            return Err(self.fault(format!(
                "no pressure and no pose of this rig in the file; it has the topics {}; map them under [recordings.topics]",
                if have.is_empty() { "(none)".to_owned() } else { have.join(", ") }
            )));
        }
        let name = self.metadata.get("name").cloned();
        let name = name.or_else(|| self.path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
        let time = stamps.iter().map(|stamp| seconds(*stamp, origin)).collect();
        let mut recording = Recording::unmeasured(name.unwrap_or_default(), time, layout);
        let mut twice = 0;
        let mut place = |stamp: u64, last: &mut Option<u64>| {
            twice += usize::from(*last == Some(stamp));
            *last = Some(stamp);
            // Every stamp is in the list, which was made from them.
            stamps.binary_search(&stamp).unwrap_or(0)
        };
        for (channels, sources) in
            [(&mut recording.command, &commands), (&mut recording.pressure, &pressures)]
        {
            for (channel, source) in channels.iter_mut().zip(sources) {
                let mut last = None;
                for (stamp, value) in source {
                    channel[place(*stamp, &mut last)] = *value;
                }
            }
        }
        let raise = if layout.pose_origin == PoseOrigin::Start && self.metadata.is_empty() {
            layout.length
        } else {
            0.0
        };
        match &mut recording.motion {
            Motion::Pose { position, rotation } => {
                let mut last = None;
                for (stamp, at, turn) in &poses {
                    let index = place(*stamp, &mut last);
                    for (axis, value) in at.iter().enumerate() {
                        position[axis][index] = if axis == 2 { value + raise } else { *value };
                    }
                    for (component, value) in turn.iter().enumerate() {
                        rotation[component][index] = *value;
                    }
                }
            }
            Motion::Free { twist, extension, outer_diameter, torque, force } => {
                let mut last = None;
                for (stamp, state) in &states {
                    let index = place(*stamp, &mut last);
                    twist[index] = state.twist;
                    extension[index] = state.extension;
                    outer_diameter[index] = state.outer_diameter;
                    torque[index] = state.torque;
                    force[index] = state.force;
                }
            }
        }
        if twice > 0 {
            let message = format!(
                "{twice} messages carry the time of the one before on their topic; the later one was kept"
            );
            findings.add(FindingKind::DuplicateTime, "t_s", twice, message);
        }
        if raise > 0.0 {
            let message = format!(
                "positions are from the start; the rest position (0, 0, {} mm) was added",
                raise * 1e3
            );
            findings.add(FindingKind::Assumption, "z_mm", recording.len(), message);
        }
        if self.metadata.get("command_hold").is_some_and(|hold| hold == "true") {
            for channel in &mut recording.command {
                hold(channel);
            }
        }
        Ok(recording.drop_unrecorded())
    }
}

/// Fills each hole with the value before it.
fn hold(channel: &mut [f64]) {
    let mut last = f64::NAN;
    for value in channel {
        if value.is_nan() {
            *value = last;
        }
        last = *value;
    }
}

/// A message with a header.
trait Stamped {
    fn header(&self) -> &Header;
}

macro_rules! stamped {
    ($($message:ty),*) => {
        $(impl Stamped for $message {
            fn header(&self) -> &Header {
                &self.header
            }
        })*
    };
}

stamped!(FluidPressure, PoseStamped, FreeStateMessage, SolveMessage);
