use crate::message::{
    Color, CompressedImage, FLUID_PRESSURE, FREE_STATE, FluidPressure, FreeStateMessage, Header,
    MARKER_ARRAY, Marker, MarkerArray, MeshFile, MessageType, POSE_STAMPED, Point, Pose, PoseStamped,
    Quaternion, SOLVE, SolveMessage, Stamp, encode,
};
use crate::{Layout, RecordError, SolveRecord, Storage};
use actuator::Rig;
use mcap::records::{MessageHeader, Metadata};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Version of what stands in a log, in its metadata record `freeact`.
pub(crate) const FORMAT: &str = "1";
/// Name of the metadata record.
pub(crate) const METADATA: &str = "freeact";
/// Names of the attachments.
pub(crate) const RIG_ATTACHMENT: &str = "rig.toml";
/// Name of the attached model.
pub(crate) const MODEL_ATTACHMENT: &str = "model";
/// Frame of the base plate.
const BASE_FRAME: &str = "base";
/// Wall time after which the open chunk is closed and handed to the operating system, so that a kill loses no more.
const FLUSH_EVERY: Duration = Duration::from_secs(1);

/// What a log says about itself: written first, so that a cut-off file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct LogHeader {
    /// Name of the recording.
    pub name: String,
    /// Text of the rig's file, attached.
    pub rig_text: String,
    /// Bytes of the model's file, attached; empty when no model was used.
    pub model: Vec<u8>,
    /// Ambient pressure, Pa.
    pub ambient: f64,
    /// Number of FREEs.
    pub frees: usize,
    /// Whether the rig is a single FREE.
    pub single_free: bool,
    /// Log time of t = 0, ns. Zero unless times are negative or of the wall clock.
    pub origin_ns: u64,
}

impl LogHeader {
    /// The header of a recording of a rig.
    pub fn of(name: impl Into<String>, rig: &Rig) -> Result<Self, RecordError> {
        let layout = Layout::of(rig)?;
        Ok(LogHeader {
            name: name.into(),
            rig_text: rig.text.clone(),
            model: Vec::new(),
            ambient: layout.ambient,
            frees: layout.frees,
            single_free: layout.single_free,
            origin_ns: 0,
        })
    }
}

/// Which pose of the tip plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TipTopic {
    /// Measured: `/tip/pose`.
    Measured,
    /// Predicted by a model: `/tip/pose_predicted`.
    Predicted,
    /// Wanted: `/tip/target`.
    Target,
}

impl TipTopic {
    pub(crate) fn topic(self) -> &'static str {
        match self {
            TipTopic::Measured => "/tip/pose",
            TipTopic::Predicted => "/tip/pose_predicted",
            TipTopic::Target => "/tip/target",
        }
    }
}

/// What is seen of a single FREE; NaN = not measured. Fields as in [`crate::Motion::Free`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeSample {
    /// Twist, rad.
    pub twist: f64,
    /// Change of length, m.
    pub extension: f64,
    /// Outer diameter, m.
    pub outer_diameter: f64,
    /// Torque on the free end, N m.
    pub torque: f64,
    /// Axial force on the free end, N.
    pub force: f64,
}

/// A line through space with a width: the axis of a FREE, for a viewer.
#[derive(Clone, Debug, PartialEq)]
pub struct Strand {
    /// Points along the line, m, base frame.
    pub points: Vec<[f64; 3]>,
    /// Width drawn, m.
    pub width: f64,
    /// Red, green, blue, 0 to 1.
    pub color: [f32; 3],
}

/// The shape of a module for a viewer: its FREEs as lines, its plates as discs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// The FREEs.
    pub strands: Vec<Strand>,
    /// Centre (m), rotation (w, x, y, z), radius and thickness (m) of each plate.
    pub plates: Vec<([f64; 3], [f64; 4], f64, f64)>,
}

/// Writes a log: an MCAP file of profile `ros2` with CDR messages in zstd chunks. Closes the open chunk at least every second of
/// wall time, so that a kill loses no more than that. [`LogWriter::finish`] writes the summary.
pub struct LogWriter<W: Write + Seek = BufWriter<File>> {
    writer: mcap::Writer<W>,
    channels: BTreeMap<String, (u16, u32)>,
    path: PathBuf,
    ambient: f64,
    origin_ns: u64,
    frees: usize,
    flushed: Instant,
    /// Buffer of frame names, so that a message costs no search.
    buffer_frame: String,
}

impl LogWriter {
    /// Creates a log file.
    pub fn create(path: &Path, header: &LogHeader, storage: &Storage) -> Result<Self, RecordError> {
        let file = File::create(path).map_err(|source| RecordError::Io { path: path.to_owned(), source })?;
        LogWriter::on(BufWriter::new(file), path, header, storage)
    }
}

impl<W: Write + Seek> LogWriter<W> {
    /// Writes a log to anything that can be written and sought; `path` is for messages.
    pub fn on(output: W, path: &Path, header: &LogHeader, storage: &Storage) -> Result<Self, RecordError> {
        let fault = |error| mcap_fault(path, error);
        let writer = mcap::WriteOptions::new()
            .profile("ros2")
            .library(concat!("freeact ", env!("CARGO_PKG_VERSION")))
            .compression(Some(mcap::Compression::Zstd))
            .compression_level(storage.compression_level)
            // In the caller's thread: the same bytes on every machine.
            .compression_threads(0)
            .chunk_size(Some(storage.chunk_size))
            .emit_message_indexes(storage.index)
            // A chunk index without message indexes would send viewers to look for what is not there.
            .emit_chunk_indexes(storage.index)
            .create(output)
            .map_err(fault)?;
        let mut log = LogWriter {
            writer,
            channels: BTreeMap::new(),
            path: path.to_owned(),
            ambient: header.ambient,
            origin_ns: header.origin_ns,
            frees: header.frees,
            flushed: Instant::now(),
            buffer_frame: String::new(),
        };
        log.describe(header, storage)?;
        Ok(log)
    }

    fn describe(&mut self, header: &LogHeader, storage: &Storage) -> Result<(), RecordError> {
        let hash = |bytes: &[u8]| blake3::hash(bytes).to_hex().to_string();
        let mut metadata = BTreeMap::from([
            ("format".to_owned(), FORMAT.to_owned()),
            ("freeact_version".into(), env!("CARGO_PKG_VERSION").into()),
            ("name".into(), header.name.clone()),
            ("kind".into(), if header.single_free { "free" } else { "module" }.into()),
            ("frees".into(), header.frees.to_string()),
            ("ambient_pressure_pa".into(), header.ambient.to_string()),
            ("time_origin_ns".into(), header.origin_ns.to_string()),
            ("command_hold".into(), storage.hold_commands.to_string()),
            ("rig_blake3".into(), hash(header.rig_text.as_bytes())),
        ]);
        if !header.model.is_empty() {
            metadata.insert("model_blake3".into(), hash(&header.model));
        }
        if let Some(rounding) = storage.rounding {
            metadata.insert("rounded_pressure_pa".into(), rounding.pressure.to_string());
            metadata.insert("rounded_position_m".into(), rounding.position.to_string());
            metadata.insert("rounded_rotation".into(), rounding.rotation.to_string());
        }
        let fault = |error| mcap_fault(&self.path, error);
        self.writer.write_metadata(&Metadata { name: METADATA.into(), metadata }).map_err(fault)?;
        let mut attach = |name: &str, media_type: &str, data: &[u8]| {
            self.writer.attach(&mcap::Attachment {
                log_time: header.origin_ns,
                create_time: header.origin_ns,
                name: name.into(),
                media_type: media_type.into(),
                data: data.into(),
            })
        };
        attach(RIG_ATTACHMENT, "application/toml", header.rig_text.as_bytes()).map_err(fault)?;
        if !header.model.is_empty() {
            attach(MODEL_ATTACHMENT, "application/octet-stream", &header.model).map_err(fault)?;
        }
        Ok(())
    }

    /// Commanded gauge pressure (Pa) of FREE `free` (from zero) at `time` (s). NaN writes nothing.
    pub fn command(&mut self, time: f64, free: usize, pressure: f64) -> Result<(), RecordError> {
        self.fluid_pressure(time, free, pressure, &command_topic(free))
    }

    /// Measured gauge pressure (Pa) of FREE `free` (from zero) at `time` (s). NaN writes nothing.
    pub fn pressure(&mut self, time: f64, free: usize, pressure: f64) -> Result<(), RecordError> {
        self.fluid_pressure(time, free, pressure, &pressure_topic(free))
    }

    fn fluid_pressure(
        &mut self,
        time: f64,
        free: usize,
        pressure: f64,
        topic: &str,
    ) -> Result<(), RecordError> {
        if free >= self.frees {
            let message = format!("a pressure of FREE {} in a log of {} FREEs", free + 1, self.frees);
            return Err(RecordError::Mismatch(message));
        }
        if pressure.is_nan() {
            return Ok(());
        }
        let stamp = self.nanoseconds(time)?;
        self.buffer_frame.clear();
        self.buffer_frame += &format!("free_{}", free + 1);
        let header = Header { stamp: Stamp::from_nanoseconds(stamp), frame_id: self.buffer_frame.clone() };
        let message = FluidPressure { header, fluid_pressure: pressure + self.ambient, variance: 0.0 };
        self.write(topic, FLUID_PRESSURE, stamp, &message)
    }

    /// A pose of the tip plate: position (m) and rotation (w, x, y, z), NaN where a component was not measured. If nothing was
    /// measured, nothing is written.
    pub fn tip(
        &mut self,
        time: f64,
        which: TipTopic,
        position: [f64; 3],
        rotation: [f64; 4],
    ) -> Result<(), RecordError> {
        if position.iter().chain(&rotation).all(|value| value.is_nan()) {
            return Ok(());
        }
        let stamp = self.nanoseconds(time)?;
        let message = PoseStamped { header: base_header(stamp), pose: pose(position, rotation) };
        self.write(which.topic(), POSE_STAMPED, stamp, &message)
    }

    /// What was seen of a single FREE; if nothing was measured, nothing is written.
    pub fn free_state(&mut self, time: f64, sample: FreeSample) -> Result<(), RecordError> {
        let FreeSample { twist, extension, outer_diameter, torque, force } = sample;
        if [twist, extension, outer_diameter, torque, force].iter().all(|value| value.is_nan()) {
            return Ok(());
        }
        let stamp = self.nanoseconds(time)?;
        let header = base_header(stamp);
        let message = FreeStateMessage { header, twist, extension, outer_diameter, torque, force };
        self.write(FREE_STATE_TOPIC, FREE_STATE, stamp, &message)
    }

    /// One inverse solve.
    pub fn solve(&mut self, solve: &SolveRecord) -> Result<(), RecordError> {
        let stamp = self.nanoseconds(solve.time)?;
        let message = SolveMessage { header: base_header(stamp), solve: solve.clone() };
        self.write(SOLVE_TOPIC, SOLVE, stamp, &message)
    }

    /// The shape of the module, for a viewer.
    pub fn shape(&mut self, time: f64, shape: &Shape) -> Result<(), RecordError> {
        let stamp = self.nanoseconds(time)?;
        let mut markers = Vec::with_capacity(shape.strands.len() + shape.plates.len());
        for (index, strand) in shape.strands.iter().enumerate() {
            let [r, g, b] = strand.color;
            let mut marker = blank_marker(stamp, "frees", index, LINE_STRIP);
            marker.scale.x = strand.width;
            marker.color = Color { r, g, b, a: 1.0 };
            marker.points = strand.points.iter().map(|[x, y, z]| Point { x: *x, y: *y, z: *z }).collect();
            markers.push(marker);
        }
        for (index, (centre, rotation, radius, thickness)) in shape.plates.iter().enumerate() {
            let mut marker = blank_marker(stamp, "plates", index, CYLINDER);
            marker.pose = pose(*centre, *rotation);
            marker.scale = Point { x: 2.0 * radius, y: 2.0 * radius, z: *thickness };
            markers.push(marker);
        }
        self.write(MARKERS_TOPIC, MARKER_ARRAY, stamp, &MarkerArray { markers })
    }

    /// Closes the open chunk and hands everything to the operating system.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.flushed = Instant::now();
        self.writer.flush().map_err(|error| mcap_fault(&self.path, error))
    }

    /// Writes the summary and closes the log.
    pub fn finish(mut self) -> Result<W, RecordError> {
        let fault = |error| mcap_fault(&self.path, error);
        self.writer.finish().map_err(fault)?;
        let mut output = self.writer.into_inner();
        output.flush().map_err(|source| RecordError::Io { path: self.path, source })?;
        Ok(output)
    }

    fn nanoseconds(&self, time: f64) -> Result<u64, RecordError> {
        let from_origin = (time * 1e9).round();
        let stamp = self.origin_ns as f64 + from_origin;
        // 2^53 ns from the origin, 104 days, is as far as f64 tells nanoseconds apart.
        if !(stamp >= 0.0 && from_origin.abs() < 9.0e15) {
            let message = format!(
                "{}: time {time} s cannot be written; times must lie within 104 days of the start and not before it",
                self.path.display()
            );
            return Err(RecordError::Mismatch(message));
        }
        Ok(self.origin_ns.saturating_add_signed(from_origin as i64))
    }

    fn write<T: Serialize>(
        &mut self,
        topic: &str,
        kind: MessageType,
        stamp: u64,
        message: &T,
    ) -> Result<(), RecordError> {
        let data = encode(message).map_err(RecordError::Mismatch)?;
        let fault = |error| mcap_fault(&self.path, error);
        if !self.channels.contains_key(topic) {
            let schema =
                self.writer.add_schema(kind.name, "ros2msg", kind.definition.as_bytes()).map_err(fault)?;
            let id = self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).map_err(fault)?;
            self.channels.insert(topic.to_owned(), (id, 0));
        }
        let Some((channel_id, sequence)) = self.channels.get_mut(topic) else { return Ok(()) };
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time: stamp,
            publish_time: stamp,
        };
        *sequence = sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, &data).map_err(fault)?;
        if self.flushed.elapsed() >= FLUSH_EVERY { self.flush() } else { Ok(()) }
    }
}

/// Topic of what is seen of a single FREE.
pub(crate) const FREE_STATE_TOPIC: &str = "/free/deformation";
/// Topic of the solves.
pub(crate) const SOLVE_TOPIC: &str = "/solve";
/// Topic of the shape.
pub(crate) const MARKERS_TOPIC: &str = "/module/markers";
const LINE_STRIP: i32 = 4;
const CYLINDER: i32 = 3;

/// Topic of the commanded pressure of FREE `free` (from zero).
pub(crate) fn command_topic(free: usize) -> String {
    format!("/free_{}/pressure_command", free + 1)
}

/// Topic of the measured pressure of FREE `free` (from zero).
pub(crate) fn pressure_topic(free: usize) -> String {
    format!("/free_{}/pressure", free + 1)
}

fn base_header(stamp: u64) -> Header {
    Header { stamp: Stamp::from_nanoseconds(stamp), frame_id: BASE_FRAME.into() }
}

fn pose([x, y, z]: [f64; 3], [qw, qx, qy, qz]: [f64; 4]) -> Pose {
    Pose { position: Point { x, y, z }, orientation: Quaternion { x: qx, y: qy, z: qz, w: qw } }
}

fn blank_marker(stamp: u64, namespace: &str, id: usize, kind: i32) -> Marker {
    Marker {
        header: base_header(stamp),
        ns: namespace.into(),
        id: id as i32,
        kind,
        action: 0,
        pose: pose([0.0; 3], [1.0, 0.0, 0.0, 0.0]),
        scale: Point { x: 1.0, y: 1.0, z: 1.0 },
        color: Color { r: 0.6, g: 0.6, b: 0.6, a: 1.0 },
        lifetime: Stamp::default(),
        frame_locked: false,
        points: Vec::new(),
        colors: Vec::new(),
        texture_resource: String::new(),
        texture: CompressedImage::default(),
        uv_coordinates: Vec::new(),
        text: String::new(),
        mesh_resource: String::new(),
        mesh_file: MeshFile::default(),
        mesh_use_embedded_materials: false,
    }
}

pub(crate) fn mcap_fault(path: &Path, error: mcap::McapError) -> RecordError {
    let message = match &error {
        mcap::McapError::Io(source) => format!("cannot be written ({source})"),
        other => format!("cannot be written as MCAP ({other})"),
    };
    RecordError::Mcap { path: path.to_owned(), message, source: Some(Box::new(error)) }
}
