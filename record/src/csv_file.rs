use crate::{
    FindingKind, Findings, Layout, PoseOrigin, PressureReference, Quantity, RecordError, Recording, examine,
};
use actuator::Rig;
use std::{fs, path::Path};

/// Departure from unit length up to which a quaternion counts as rounded: four components of three decimals sum to 1e-3.
const QUATERNION_ROUNDING: f64 = 1.1e-3;

/// Reads a CSV recording of a rig: a header with the columns of [`Quantity`] (or those that the rig's table `[recordings]`
/// maps to them), then one row a sample. Empty or NaN = not measured.
///
/// # Errors
/// With file, line and column: no header or no row, an unknown or repeated column, no time, a pressure of a FREE that the rig
/// has not, something that is no number, a row of another length, times that go back, a quaternion that is not of unit length.
pub fn read_csv(path: &Path, rig: &Rig) -> Result<(Recording, Findings), RecordError> {
    let bytes = fs::read(path).map_err(|source| RecordError::Io { path: path.to_owned(), source })?;
    parse_csv(path, &bytes, rig)
}

/// Reads a recording from the bytes of a CSV file; `path` is for messages and the recording's name.
pub fn parse_csv(path: &Path, bytes: &[u8], rig: &Rig) -> Result<(Recording, Findings), RecordError> {
    let layout = Layout::of(rig)?;
    let file = File { path, layout: &layout };
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(layout.delimiter)
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let mut rows = reader.records();
    let header = match rows.next() {
        None => {
            return Err(file.fault(1, "", "the file is empty; a header such as t_s,p1_kpa,x_mm is needed"));
        }
        Some(row) => row.map_err(|error| file.csv_error(&error))?,
    };
    let columns = file.columns(&header)?;
    let mut samples = Samples { lines: Vec::new(), values: vec![Vec::new(); columns.len()] };
    for row in rows {
        let row = row.map_err(|error| file.csv_error(&error))?;
        let line = row.position().map_or(0, csv::Position::line);
        if row.len() != header.len() {
            let message = format!("{} fields where the header has {}", row.len(), header.len());
            return Err(file.fault(line, "", &message));
        }
        samples.lines.push(line);
        for (column, values) in columns.iter().zip(&mut samples.values) {
            values.push(file.number(line, column, &row[column.index])?);
        }
    }
    if samples.lines.is_empty() {
        return Err(file.fault(2, "", "there is no sample after the header"));
    }
    let mut findings = Findings::default();
    file.check_times(&columns, &mut samples, &mut findings)?;
    let recording = file.recording(&columns, samples, &mut findings)?;
    findings.append(examine(&recording, &layout));
    Ok((recording, findings))
}

/// Writes a recording as CSV in the usual columns; channels without any sample are left out, NaN is written as nothing.
pub fn write_csv(path: &Path, recording: &Recording) -> Result<(), RecordError> {
    let columns: Vec<Quantity> = recording
        .quantities()
        .into_iter()
        .filter(|quantity| {
            recording.channel(*quantity).is_some_and(|c| c.iter().any(|value| !value.is_nan()))
        })
        .collect();
    let mut text = "t_s".to_owned();
    for quantity in &columns {
        text.push(',');
        text += &quantity.column();
    }
    text.push('\n');
    for (index, time) in recording.time.iter().enumerate() {
        text += &time.to_string();
        for quantity in &columns {
            text.push(',');
            let value = recording.channel(*quantity).map_or(f64::NAN, |channel| channel[index]);
            if !value.is_nan() {
                text += &(value / quantity.unit()).to_string();
            }
        }
        text.push('\n');
    }
    fs::write(path, text).map_err(|source| RecordError::Io { path: path.to_owned(), source })
}

/// A column of the file that holds something known.
struct Column {
    index: usize,
    name: String,
    quantity: Quantity,
    unit: f64,
}

/// Numbers of the file in SI, column by column, and the line of each.
struct Samples {
    lines: Vec<u64>,
    values: Vec<Vec<f64>>,
}

/// What is being read, for messages.
struct File<'a> {
    path: &'a Path,
    layout: &'a Layout,
}

impl File<'_> {
    fn fault(&self, line: u64, column: &str, message: &str) -> RecordError {
        RecordError::Csv {
            path: self.path.to_owned(),
            line,
            column: column.to_owned(),
            message: message.to_owned(),
        }
    }

    fn csv_error(&self, error: &csv::Error) -> RecordError {
        let line = error.position().map_or(1, csv::Position::line);
        let message = match error.kind() {
            csv::ErrorKind::Utf8 { .. } => "this is not UTF-8 text; save the file as CSV in UTF-8".to_owned(),
            _ => error.to_string(),
        };
        self.fault(line, "", &message)
    }

    fn columns(&self, header: &csv::StringRecord) -> Result<Vec<Column>, RecordError> {
        let layout = self.layout;
        let line = header.position().map_or(1, csv::Position::line);
        let mut columns: Vec<Column> = Vec::new();
        for (index, name) in header.iter().enumerate() {
            if layout.ignore.iter().any(|ignored| ignored == name) {
                continue;
            }
            let (quantity, unit) = match layout.columns.get(name) {
                Some(mapped) => *mapped,
                None => Quantity::from_column(name).map_err(|message| {
                    let hint = if header.len() == 1 && name.contains([';', '\t']) {
                        "; for another delimiter set delimiter = \";\" under [recordings] of the rig".to_owned()
                    } else {
                        format!(
                            "; or map it under [recordings.columns] of the rig, as p1_kpa = \"{name}\", or list it in ignore"
                        )
                    };
                    self.fault(line, name, &(message + &hint))
                })?,
            };
            self.fits_the_rig(quantity).map_err(|message| self.fault(line, name, &message))?;
            if let Some(other) = columns.iter().find(|other| other.quantity == quantity) {
                let message =
                    format!("holds the same quantity as column `{}`; list one of them in ignore", other.name);
                return Err(self.fault(line, name, &message));
            }
            columns.push(Column { index, name: name.to_owned(), quantity, unit });
        }
        for (quantity, needed) in layout.columns.iter().map(|(name, (quantity, _))| (quantity, name)) {
            if !columns.iter().any(|column| column.quantity == *quantity) {
                let message = format!(
                    "is mapped to {} by the rig but is not in this file, which has: {}",
                    quantity.column(),
                    header.iter().collect::<Vec<_>>().join(", ")
                );
                return Err(self.fault(line, needed, &message));
            }
        }
        if !columns.iter().any(|column| column.quantity == Quantity::Time) {
            let message =
                "there is no time; a column t_s is needed, or t_s = \"its name\" under [recordings.columns]";
            return Err(self.fault(line, "t_s", message));
        }
        let about_z = columns.iter().find(|column| column.quantity == Quantity::RotationAboutZ);
        let quaternion = columns.iter().any(|column| matches!(column.quantity, Quantity::Rotation(_)));
        if let (Some(about_z), true) = (about_z, quaternion) {
            return Err(self.fault(
                line,
                &about_z.name,
                "a quaternion is in the file too; list this column in ignore",
            ));
        }
        let components: Vec<String> = (0..4)
            .map(Quantity::Rotation)
            .filter(|quantity| !columns.iter().any(|column| column.quantity == *quantity))
            .map(Quantity::column)
            .collect();
        if quaternion && !components.is_empty() {
            let message = "is missing; a quaternion needs qw, qx, qy and qz";
            return Err(self.fault(line, &components[0], message));
        }
        Ok(columns)
    }

    fn fits_the_rig(&self, quantity: Quantity) -> Result<(), String> {
        let frees = self.layout.frees;
        let single = self.layout.single_free;
        match quantity {
            Quantity::Command(free) | Quantity::Pressure(free) if free >= frees => {
                let have = if frees == 1 { "one FREE".to_owned() } else { format!("{frees} FREEs") };
                Err(format!("the rig has {have}; correct its [[free]] tables or list this column in ignore"))
            }
            Quantity::Position(_) | Quantity::Rotation(_) | Quantity::RotationAboutZ if single => Err(
                "belongs to a module, but the rig is a single FREE, which has twist_rad, extension_mm, outer_diameter_mm, \
                 torque_nmm, force_n"
                    .into(),
            ),
            Quantity::Twist
            | Quantity::Extension
            | Quantity::OuterDiameter
            | Quantity::Torque
            | Quantity::Force
                if !single =>
            {
                Err("belongs to a single FREE, but the rig is a module, which has x_mm, y_mm, z_mm, qw, qx, qy, qz or rz_rad"
                    .into())
            }
            _ => Ok(()),
        }
    }

    fn number(&self, line: u64, column: &Column, text: &str) -> Result<f64, RecordError> {
        if text.is_empty() || text.eq_ignore_ascii_case("nan") {
            if column.quantity == Quantity::Time {
                return Err(self.fault(
                    line,
                    &column.name,
                    "a sample without a time; give one or take the row out",
                ));
            }
            return Ok(f64::NAN);
        }
        let value: f64 = text.parse().map_err(|_| {
            let message =
                format!("\"{text}\" is not a number; leave the field empty where nothing was measured");
            self.fault(line, &column.name, &message)
        })?;
        if !value.is_finite() {
            let message =
                format!("\"{text}\" is not finite; leave the field empty where nothing was measured");
            return Err(self.fault(line, &column.name, &message));
        }
        let value = value * column.unit;
        let absolute = self.layout.pressure == PressureReference::Absolute;
        match column.quantity {
            Quantity::Command(_) | Quantity::Pressure(_) if absolute => Ok(value - self.layout.ambient),
            _ => Ok(value),
        }
    }

    /// Refuses times that go back; of a time that stands twice, keeps the first sample and reports it.
    fn check_times(
        &self,
        columns: &[Column],
        samples: &mut Samples,
        findings: &mut Findings,
    ) -> Result<(), RecordError> {
        let Some(which) = columns.iter().position(|column| column.quantity == Quantity::Time) else {
            return Ok(());
        };
        let time = &samples.values[which];
        let back: Vec<usize> = (1..time.len()).filter(|index| time[*index] < time[index - 1]).collect();
        if let Some(first) = back.first() {
            let message = format!(
                "time goes back {} time{} here, first from {} to {} s; sort the rows, or split the file where a new \
                 recording starts",
                back.len(),
                if back.len() == 1 { "" } else { "s" },
                time[first - 1],
                time[*first]
            );
            return Err(self.fault(samples.lines[*first], &columns[which].name, &message));
        }
        let twice: Vec<usize> = (1..time.len()).filter(|index| time[*index] == time[index - 1]).collect();
        let Some(first) = twice.first() else { return Ok(()) };
        let message = format!(
            "{} samples carry the time of the sample before and were left out, first on line {}",
            twice.len(),
            samples.lines[*first]
        );
        findings.add(FindingKind::DuplicateTime, "t_s", twice.len(), message);
        let keep: Vec<bool> = (0..time.len()).map(|index| twice.binary_search(&index).is_err()).collect();
        for values in &mut samples.values {
            let mut keep = keep.iter();
            values.retain(|_| keep.next() == Some(&true));
        }
        let mut keep = keep.iter();
        samples.lines.retain(|_| keep.next() == Some(&true));
        Ok(())
    }

    fn recording(
        &self,
        columns: &[Column],
        samples: Samples,
        findings: &mut Findings,
    ) -> Result<Recording, RecordError> {
        let layout = self.layout;
        let lines = samples.lines;
        let name = self.path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let mut recording = Recording::unmeasured(name, vec![0.0; lines.len()], layout);
        for (column, values) in columns.iter().zip(samples.values) {
            if column.quantity == Quantity::RotationAboutZ {
                findings.add(
                    FindingKind::Assumption,
                    &column.name,
                    values.len(),
                    "only the rotation about z was recorded; the plate is taken not to tilt",
                );
                let about_z =
                    |component: fn(f64) -> f64| values.iter().map(|angle| component(0.5 * angle)).collect();
                let still = |value: f64| {
                    values
                        .iter()
                        .map(|angle| if angle.is_nan() { f64::NAN } else { value })
                        .collect::<Vec<_>>()
                };
                if let crate::Motion::Pose { rotation, .. } = &mut recording.motion {
                    *rotation = [about_z(f64::cos), still(0.0), still(0.0), about_z(f64::sin)];
                }
            } else if let Some(channel) = recording.channel_mut(column.quantity) {
                *channel = values;
            }
        }
        self.check_quaternions(columns, &recording, &lines)?;
        if layout.pose_origin == PoseOrigin::Start && !layout.single_free {
            let rest = layout.length;
            if let Some(z) = recording.channel_mut(Quantity::Position(2)) {
                z.iter_mut().for_each(|value| *value += rest);
            }
            let message = format!(
                "positions are from the start; the rest position (0, 0, {} mm) was added, no sag at the start assumed",
                rest * 1e3
            );
            findings.add(FindingKind::Assumption, "z_mm", lines.len(), message);
        }
        Ok(recording.drop_unrecorded())
    }

    fn check_quaternions(
        &self,
        columns: &[Column],
        recording: &Recording,
        lines: &[u64],
    ) -> Result<(), RecordError> {
        let crate::Motion::Pose { rotation, .. } = &recording.motion else { return Ok(()) };
        let Some(column) = columns.iter().find(|column| column.quantity == Quantity::Rotation(0)) else {
            return Ok(());
        };
        let norm = |index: usize| rotation.iter().map(|c| c[index] * c[index]).sum::<f64>().sqrt();
        // A quaternion with a NaN component counts as not measured.
        let wrong: Vec<usize> =
            (0..lines.len()).filter(|index| (norm(*index) - 1.0).abs() > QUATERNION_ROUNDING).collect();
        let Some(first) = wrong.first() else { return Ok(()) };
        let message = format!(
            "the quaternion has length {:.6}, not 1 ({} such row{}); check the order w, x, y, z and leave the fields empty \
             where the rotation was not measured",
            norm(*first),
            wrong.len(),
            if wrong.len() == 1 { "" } else { "s" }
        );
        Err(self.fault(lines[*first], &column.name, &message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, free_for_tests, rig_for_tests};

    fn read(text: &str, rig: &Rig) -> Result<(Recording, Findings), RecordError> {
        parse_csv(Path::new("run.csv"), text.as_bytes(), rig)
    }

    fn message(text: &str, rig: &Rig) -> String {
        read(text, rig).unwrap_err().to_string()
    }

    #[test]
    fn a_recording_of_a_module_is_read_in_si() {
        let text = "\u{feff}t_s, p1_command_kpa,p1_kpa,p2_kpa,x_mm,y_mm,z_mm,qw,qx,qy,qz\r\n\
                    0.0,10,10.5,,1,2,175,1,0,0,0\r\n0.05,12,NaN,3,1,2,176,0.8,0,0,0.6\r\n";
        let (recording, _) = read(text, &rig_for_tests(2, "")).unwrap();
        assert_eq!((recording.name.as_str(), recording.time.as_slice()), ("run", [0.0, 0.05].as_slice()));
        assert_eq!(recording.command[0], [10e3, 12e3]);
        assert!(recording.command[1].iter().all(|value| value.is_nan()));
        assert_eq!(recording.pressure[0][0], 10.5e3);
        assert!(recording.pressure[0][1].is_nan() && recording.pressure[1][0].is_nan());
        let pose = recording.pose(1).unwrap();
        assert!((pose.position.z - 0.176).abs() < 1e-15);
        assert_eq!(pose.wxyz(), [0.8, 0.0, 0.0, 0.6]);
    }

    #[test]
    fn a_single_free_and_other_names_units_and_references_are_read() {
        let rig = free_for_tests(
            "[recordings]\npressure = \"absolute\"\nambient_kpa = 100\nignore = [\"room\"]\ndelimiter = \";\"\n\
             [recordings.columns]\nt_ms = \"time\"\np1_bar = \"P\"\ntwist_deg = \"turn\"\n",
        );
        let (recording, _) = read("time;P;turn;room;torque_nmm\n0;1.5;90;21;13\n10;1;0;;\n", &rig).unwrap();
        assert_eq!(recording.time, [0.0, 0.01]);
        assert!((recording.pressure[0][0] - 50e3).abs() < 1e-9 && recording.pressure[0][1].abs() < 1e-9);
        assert!(recording.command.is_empty());
        let Motion::Free { twist, torque, extension, .. } = &recording.motion else { panic!() };
        assert!((twist[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!((torque[0] - 0.013).abs() < 1e-15 && torque[1].is_nan() && extension[0].is_nan());
    }

    #[test]
    fn rotation_about_z_and_positions_from_the_start_make_poses() {
        let rig = rig_for_tests(1, "[recordings]\npose_origin = \"start\"\n");
        let (recording, findings) =
            read("t_s,p1_kpa,x_mm,y_mm,z_mm,rz_rad\n0,0,0,0,0,0\n1,5,0,0,2,3.0\n2,5,,,,\n", &rig).unwrap();
        let pose = recording.pose(1).unwrap();
        assert!((pose.position.z - 0.177).abs() < 1e-15);
        assert!((pose.rotation.angle() - 3.0).abs() < 1e-12 && pose.rotation.k > 0.0);
        assert!(recording.pose(2).is_none());
        assert_eq!(findings.of_kind(FindingKind::Assumption).count(), 2);
    }

    #[test]
    fn errors_name_file_line_column_and_remedy() {
        let rig = rig_for_tests(2, "");
        for (text, expected) in [
            ("", "run.csv:1: the file is empty; a header"),
            ("t_s,p1_kpa\n", "run.csv:2: there is no sample"),
            ("t_s,p1_kpa,depth\n0,1,2\n", "run.csv:1: column `depth`: unknown name; known are t_s"),
            ("t_s;p1_kpa\n0;1\n", "set delimiter = \";\""),
            ("p1_kpa\n1\n", "column `t_s`: there is no time"),
            (
                "t_s,p1_kpa\n0,1\n1,l2\n",
                "run.csv:3: column `p1_kpa`: \"l2\" is not a number; leave the field empty",
            ),
            ("t_s,p1_kpa\n0,inf\n", "is not finite"),
            ("t_s,p1_kpa\n,1\n", "a sample without a time"),
            ("t_s,p1_kpa\n0,1,2\n", "run.csv:2: 3 fields where the header has 2"),
            (
                "t_s,p1_kpa\n0,1\n2,1\n1,1\n3,1\n2,1\n",
                "run.csv:4: column `t_s`: time goes back 2 times here, first from 2 to 1 s",
            ),
            ("t_s,p3_kpa\n0,1\n", "column `p3_kpa`: the rig has 2 FREEs"),
            ("t_s,twist_rad\n0,1\n", "belongs to a single FREE"),
            ("t_s,p1_kpa,p1_pa\n0,1,1\n", "holds the same quantity as column `p1_kpa`"),
            ("t_s,qw,qx,qy\n0,1,0,0\n", "column `qz`: is missing"),
            (
                "t_s,qw,qx,qy,qz\n0,1,0,0,0\n1,0,0,0,0\n",
                "run.csv:3: column `qw`: the quaternion has length 0.000000",
            ),
            ("t_s,rz_rad,qw,qx,qy,qz\n0,1,1,0,0,0\n", "a quaternion is in the file too"),
        ] {
            let message = message(text, &rig);
            assert!(message.contains(expected), "{text:?} gave {message}");
        }
        assert!(message("t_s,x_mm\n0,1\n", &free_for_tests("")).contains("belongs to a module"));
        let latin = parse_csv(Path::new("run.csv"), b"t_s,p1_kpa\n0,\xb5\n", &rig).unwrap_err().to_string();
        assert!(latin.contains("run.csv:2: this is not UTF-8"), "{latin}");
        let mapped = rig_for_tests(1, "[recordings.columns]\np1_kpa = \"P\"\n");
        assert!(message("t_s,x_mm\n0,1\n", &mapped).contains("column `P`: is mapped to p1_kpa"));
    }

    #[test]
    fn a_time_that_stands_twice_is_left_out_and_reported() {
        let (recording, findings) =
            read("t_s,p1_kpa\n0,1\n1,2\n1,3\n1,4\n2,5\n", &rig_for_tests(1, "")).unwrap();
        assert_eq!(recording.time, [0.0, 1.0, 2.0]);
        assert_eq!(recording.pressure[0], [1e3, 2e3, 5e3]);
        let finding = findings.of_kind(FindingKind::DuplicateTime).next().unwrap();
        assert_eq!(finding.count, 2);
        assert!(finding.message.contains("first on line 4"));
    }

    #[test]
    fn what_is_written_is_read_again() {
        let rig = rig_for_tests(2, "");
        let text = "t_s,p1_command_kpa,p2_kpa,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,10.123,,1,2,175,1,0,0,0\n0.05,12,3,,,,,,,\n";
        let (recording, _) = read(text, &rig).unwrap();
        let path = std::env::temp_dir().join(format!("freeact-write-csv-{}.csv", std::process::id()));
        write_csv(&path, &recording).unwrap();
        let (again, _) = read_csv(&path, &rig).unwrap();
        std::fs::remove_file(&path).unwrap();
        for quantity in recording.quantities() {
            let pairs = recording.channel(quantity).unwrap().iter().zip(again.channel(quantity).unwrap());
            for (a, b) in pairs {
                // Division and multiplication by the unit may each cost half a unit in the last place.
                assert!(
                    (a.is_nan() && b.is_nan()) || (a - b).abs() <= 2.0 * f64::EPSILON * a.abs(),
                    "{quantity:?}"
                );
            }
        }
        assert_eq!(recording.time, again.time);
    }
}
