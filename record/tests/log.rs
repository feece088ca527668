//! Logs: what is written comes back, cut-off and foreign files are read as far as they go, garbage is refused.

use actuator::Rig;
use record::{
    FindingKind, FreeSample, LogHeader, LogWriter, Motion, Quantity, Recording, Shape, SolveRecord, Storage,
    Strand, TipTopic, parse_csv, read_mcap, write_mcap,
};
use std::io::Cursor;
use std::path::{Path, PathBuf};

fn rig(frees: usize, recordings: &str) -> Rig {
    let mut text =
        "kind = \"module\"\n[defaults]\nlength_mm = 175.0\ninner_diameter_mm = 9.52\nwall_mm = 0.8\n\
                    winding_angle_deg = 30.0\nfibres = 6\nfibre_ea_newton = 644.0\n[defaults.elastomer]\n\
                    model = \"neo-hookean\"\nshear_modulus_mpa = 0.4\n[limits]\npressure_max_kpa = 50.0\n"
            .to_owned();
    for free in 0..frees {
        text += &format!("[[free]]\nposition_mm = [{}.0, 0.0]\n", 20 * free);
    }
    Rig::parse(Path::new("rig.toml"), text + recordings).unwrap()
}

/// A file of its own for each test, taken away when the test ends.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        Scratch(std::env::temp_dir().join(format!("freeact-{}-{name}", std::process::id())))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Four seconds at 50 Hz of two FREEs with numbers that fill every bit, and holes.
fn recording(rig: &Rig) -> Recording {
    let mut text = "t_s,p1_command_kpa,p2_command_kpa,p1_kpa,p2_kpa,x_mm,y_mm,z_mm,qw,qx,qy,qz\n".to_owned();
    for index in 0..200 {
        let t = 0.02 * f64::from(index);
        let angle = 0.3 * (1.3 * t).sin();
        let step = 10.0 * (f64::from(index / 50) + 1.0 / 3.0);
        let hole = |value: f64, every: u32| {
            if index % every == 3 || index == 60 { String::new() } else { value.to_string() }
        };
        text += &format!("{:.3},{step},{},{},{}", t, step / 7.0, hole(step + t.sin() / 9.0, 11), hole(t, 7));
        if index % 13 == 5 || index == 60 {
            text += ",,,,,,,\n";
        } else {
            let (w, z) = ((0.5 * angle).cos(), (0.5 * angle).sin());
            text += &format!(",{},{},{},{w},0,0,{z}\n", t.sin(), t.cos(), 175.0 + 5.0 * t.sin());
        }
    }
    parse_csv(Path::new("run.csv"), text.as_bytes(), rig).unwrap().0
}

fn same(a: &Recording, b: &Recording, pressure_tolerance: f64) {
    assert_eq!((a.len(), &a.time), (b.len(), &b.time));
    assert_eq!(a.quantities(), b.quantities());
    for quantity in a.quantities() {
        let tolerance = match quantity {
            Quantity::Command(_) | Quantity::Pressure(_) => pressure_tolerance,
            _ => 0.0,
        };
        for (index, (x, y)) in
            a.channel(quantity).unwrap().iter().zip(b.channel(quantity).unwrap()).enumerate()
        {
            assert!(x.is_nan() == y.is_nan(), "{quantity:?} at {index}: {x} came back as {y}");
            assert!(
                x.is_nan() || (x - y).abs() <= tolerance,
                "{quantity:?} at {index}: {x} came back as {y}"
            );
        }
    }
}

/// Adding the ambient pressure and taking it off again costs half a unit in the last place of the sum, 2^-37 Pa, twice.
const AMBIENT_ROUNDING: f64 = 1.5e-11;

#[test]
fn a_recording_comes_back_from_its_log() {
    let rig = rig(2, "");
    let before = recording(&rig);
    for (name, storage) in [
        ("log", Storage::default()),
        ("held", Storage { hold_commands: true, index: false, ..Storage::default() }),
    ] {
        let file = Scratch::new(&format!("{name}.mcap"));
        write_mcap(&file.0, &before, &LogHeader::of("run", &rig).unwrap(), &storage).unwrap();
        let log = read_mcap(&file.0, None).unwrap();
        same(&before, &log.recording, AMBIENT_ROUNDING);
        assert_eq!(log.recording.name, "run");
        assert_eq!(log.rig_text.as_deref(), Some(rig.text.as_str()));
        assert_eq!(log.metadata["ambient_pressure_pa"], "101325");
        assert_eq!(log.findings.of_kind(FindingKind::CutOff).count(), 0);
        assert_eq!(held_alone(&before), 1);
        let commands = log.message_counts["/free_1/pressure_command"];
        assert_eq!(commands, if storage.hold_commands { 4 + held_alone(&before) } else { 200 });
    }
}

/// Samples that have nothing but commands; these must be written to keep their times.
fn held_alone(recording: &Recording) -> usize {
    (0..recording.len())
        .filter(|index| index % 50 != 0)
        .filter(|index| {
            recording.pose(*index).is_none() && recording.pressure.iter().all(|c| c[*index].is_nan())
        })
        .count()
}

#[test]
fn negative_times_and_an_archive_keep_the_printed_numbers() {
    let rig = rig(1, "");
    let text = "t_s,p1_command_kpa,p1_kpa,x_mm,y_mm,z_mm,qw,qx,qy,qz\n-0.5,12.345,12.346,1.234,-5.678,175.901,0.999999,0.001414,0,0\n\
                0,12.345,12.447,1.235,-5.679,175.902,0.999999,0.001414,0,0\n";
    let (before, _) = parse_csv(Path::new("run.csv"), text.as_bytes(), &rig).unwrap();
    let file = Scratch::new("negative.mcap");
    write_mcap(&file.0, &before, &LogHeader::of("run", &rig).unwrap(), &Storage::archive()).unwrap();
    let log = read_mcap(&file.0, Some(&rig)).unwrap();
    assert_eq!(log.recording.time, [-0.5, 0.0]);
    for quantity in before.quantities() {
        // Half of the last printed decimal.
        let half = if matches!(quantity, Quantity::Rotation(_)) { 0.5e-6 } else { 0.5e-3 * quantity.unit() };
        for (x, y) in before.channel(quantity).unwrap().iter().zip(log.recording.channel(quantity).unwrap()) {
            assert!((x - y).abs() < half, "{quantity:?}: {x} came back as {y}");
        }
    }
}

#[test]
fn solves_targets_predictions_and_models_come_back_bit_for_bit() {
    let rig = rig(2, "");
    let file = Scratch::new("solve.mcap");
    let header = LogHeader { model: vec![1, 2, 3], ..LogHeader::of("run", &rig).unwrap() };
    let mut writer = LogWriter::create(&file.0, &header, &Storage::default()).unwrap();
    // Numbers without a short decimal, the smallest and the largest, and none.
    let odd = [1.0 / 3.0, f64::MIN_POSITIVE / 8.0, f64::MAX, -0.0, f64::INFINITY, std::f64::consts::PI * 1e4];
    let solves: Vec<SolveRecord> = (0..5)
        .map(|index| SolveRecord {
            time: 0.01 * f64::from(index) + 1e-12,
            target_position: [odd[0], odd[1], odd[2]],
            target_rotation: [odd[3], odd[4], odd[5], 0.1],
            start_pressure: odd[..index as usize].to_vec(),
            pressure_min: vec![0.0, 0.0],
            pressure_max: vec![5e4 / 3.0; 2],
            position_weight: 0.7,
            rotation_weight: 1e-300,
            preference: "least-change".into(),
            preference_weight: 1e-6 / 7.0,
            setting_name: vec!["trust_radius".into(), "tolerance".into()],
            setting_value: vec![0.1, 1e-9],
            status: "unreachable".into(),
            reason: "p2 is at its bound, 50 kPa".into(),
            active_bound: vec!["p2_max".into()],
            pressure: vec![odd[5], odd[0]],
            predicted_position: [0.1, 0.2, 0.3],
            predicted_rotation: [1.0, 0.0, 0.0, 0.0],
            objective: odd[5],
            position_residual: 1e-3 / 3.0,
            rotation_residual: 2e-3,
            limit_margin: 1e3,
            iterations: 17,
            duration: 25e-6,
        })
        .collect();
    for solve in &solves {
        writer.solve(solve).unwrap();
        writer.command(solve.time, 1, solve.pressure[1]).unwrap();
        writer
            .tip(solve.time, TipTopic::Predicted, solve.predicted_position, solve.predicted_rotation)
            .unwrap();
        writer.tip(solve.time, TipTopic::Target, [odd[0], 0.0, 0.1], [1.0, 0.0, 0.0, 0.0]).unwrap();
        let strand =
            Strand { points: vec![[0.0; 3], [0.0, 0.0, 0.175]], width: 0.011, color: [1.0, 0.5, 0.0] };
        let plates = vec![([0.0, 0.0, 0.175], [1.0, 0.0, 0.0, 0.0], 0.02, 0.003)];
        writer.shape(solve.time, &Shape { strands: vec![strand], plates }).unwrap();
    }
    writer.finish().unwrap();
    let log = read_mcap(&file.0, None).unwrap();
    assert_eq!(log.solves, solves);
    // Equality takes -0 for 0: compare the bits of one.
    assert_eq!(log.solves[0].target_rotation[0].to_bits(), (-0.0f64).to_bits());
    assert_eq!((log.targets.len(), log.predicted.len()), (5, 5));
    assert_eq!(log.targets[2], (0.02, [odd[0], 0.0, 0.1], [1.0, 0.0, 0.0, 0.0]));
    assert_eq!(log.model.as_deref(), Some([1u8, 2, 3].as_slice()));
    assert_eq!(log.message_counts["/module/markers"], 5);
    assert!(log.metadata.contains_key("model_blake3") && log.metadata.contains_key("rig_blake3"));
}

#[test]
fn a_single_free_comes_back() {
    let text = "kind = \"free\"\nlength_mm = 86.4\ninner_diameter_mm = 9.52\nwall_mm = 0.8\nwinding_angle_deg = 40.0\n\
                fibres = 6\nfibre_ea_newton = 644.0\n[elastomer]\nmodel = \"neo-hookean\"\nshear_modulus_mpa = 0.4\n";
    let rig = Rig::parse(Path::new("free.toml"), text.to_owned()).unwrap();
    let csv = "t_s,p1_kpa,twist_rad,extension_mm,torque_nmm\n0,17.2,0.35,,0\n10,27.5,0.6,0.1,0\n20,30,,,\n";
    let (before, _) = parse_csv(Path::new("run.csv"), csv.as_bytes(), &rig).unwrap();
    let file = Scratch::new("free.mcap");
    write_mcap(&file.0, &before, &LogHeader::of("run", &rig).unwrap(), &Storage::default()).unwrap();
    let log = read_mcap(&file.0, None).unwrap();
    same(&before, &log.recording, AMBIENT_ROUNDING);
    assert_eq!(log.message_counts["/free/deformation"], 2);
    let Motion::Free { outer_diameter, .. } = &log.recording.motion else { panic!() };
    assert!(outer_diameter.iter().all(|value| value.is_nan()));
}

#[test]
fn a_log_that_was_never_finished_keeps_what_was_flushed() {
    let rig = rig(1, "");
    let file = Scratch::new("killed.mcap");
    let header = LogHeader::of("run", &rig).unwrap();
    let mut writer = LogWriter::create(&file.0, &header, &Storage::default()).unwrap();
    for index in 0..1000 {
        writer.pressure(0.001 * f64::from(index), 0, 1e3).unwrap();
        if index == 700 {
            writer.flush().unwrap();
            // What a kill here would leave: the bytes that the operating system has.
            std::fs::copy(&file.0, file.0.with_extension("copy")).unwrap();
        }
    }
    drop(writer);
    let killed = Scratch(file.0.with_extension("copy"));
    let log = read_mcap(&killed.0, None).unwrap();
    assert_eq!(log.recording.len(), 701);
    let cut = log.findings.of_kind(FindingKind::CutOff).next().unwrap();
    assert!(
        cut.message.contains("was cut off") && cut.message.contains("701 messages recovered"),
        "{}",
        cut.message
    );
}

#[test]
fn cut_anywhere_a_log_gives_a_beginning_or_an_error_but_never_a_panic() {
    let rig = rig(2, "");
    let before = recording(&rig);
    let storage = Storage { chunk_size: 4096, ..Storage::default() };
    let file = Scratch::new("cut.mcap");
    write_mcap(&file.0, &before, &LogHeader::of("run", &rig).unwrap(), &storage).unwrap();
    let bytes = std::fs::read(&file.0).unwrap();
    let cut = Scratch::new("cut-short.mcap");
    let mut most = 0;
    for length in (0..bytes.len()).step_by(97) {
        std::fs::write(&cut.0, &bytes[..length]).unwrap();
        match read_mcap(&cut.0, Some(&rig)) {
            Ok(log) => {
                let n = log.recording.len();
                assert!(n >= most, "less was read from more");
                most = n;
                assert_eq!(log.recording.time, before.time[..n]);
                assert_eq!(log.findings.of_kind(FindingKind::CutOff).count(), 1);
            }
            Err(error) => assert_eq!(most, 0, "{length}: {error}"),
        }
    }
    assert_eq!(most, before.len());
    // A flipped byte inside a chunk is found by its checksum or its format, and what comes before is kept.
    for place in (600..bytes.len() - 600).step_by(211) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x55;
        std::fs::write(&cut.0, &damaged).unwrap();
        if let Ok(log) = read_mcap(&cut.0, Some(&rig)) {
            let n = log.recording.len();
            assert!(
                n == before.len() || log.findings.of_kind(FindingKind::CutOff).count() == 1,
                "byte {place}"
            );
            for (index, value) in log.recording.channel(Quantity::Position(1)).unwrap().iter().enumerate() {
                let expected = before.channel(Quantity::Position(1)).unwrap()[index];
                // The last sample may lack its pose where the chunk behind it is gone.
                assert!(value.is_nan() || *value == expected, "byte {place}: {expected} was read as {value}");
            }
        }
    }
}

#[test]
fn garbage_and_strangers_are_refused_with_the_remedy() {
    let rig = rig(1, "");
    let file = Scratch::new("garbage.mcap");
    let message = |bytes: &[u8], rig: Option<&Rig>| {
        std::fs::write(&file.0, bytes).unwrap();
        read_mcap(&file.0, rig).unwrap_err().to_string()
    };
    assert!(message(b"", Some(&rig)).contains("the file is empty"));
    assert!(message(b"t_s,p1_kpa\n", Some(&rig)).contains("not an MCAP file (it begins with \"t_s,p1_k\")"));
    let mut garbage = mcap::MAGIC.to_vec();
    garbage.extend((0..4000u32).map(|index| (index.wrapping_mul(2_654_435_761) >> 24) as u8));
    assert!(message(&garbage, Some(&rig)).contains("nothing can be recovered"));
    assert!(read_mcap(Path::new("absent.mcap"), None).unwrap_err().to_string().starts_with("absent.mcap: "));
    let foreign = foreign_bag("sensor_msgs/msg/FluidPressure");
    assert!(message(&foreign, None).contains("give one with --rig"));
    let text = message(&foreign, Some(&rig));
    assert!(text.contains("it has the topics /valve, /vision; map them under [recordings.topics]"), "{text}");
    let mapped = |table: &str| crate::rig(1, table);
    let text = message(&foreign, Some(&mapped("[recordings.topics]\np1 = \"/pump\"\n")));
    assert!(text.contains("topic /pump, which the rig names"), "{text}");
    let text = message(
        &foreign_bag("std_msgs/msg/Float64"),
        Some(&mapped("[recordings.topics]\np1 = \"/valve\"\n")),
    );
    assert!(text.contains("carries std_msgs/msg/Float64 (cdr); sensor_msgs/msg/FluidPressure"), "{text}");
    // Four FREEs in the log, one in the rig.
    let other = crate::rig(4, "");
    write_mcap(
        &file.0,
        &recording_of_nothing(&other),
        &LogHeader::of("run", &other).unwrap(),
        &Storage::default(),
    )
    .unwrap();
    let text = read_mcap(&file.0, Some(&rig)).unwrap_err().to_string();
    assert!(text.contains("the log is of 4 FREEs, the rig has 1"), "{text}");
}

fn recording_of_nothing(rig: &Rig) -> Recording {
    parse_csv(Path::new("run.csv"), b"t_s,p1_kpa\n0,1\n", rig).unwrap().0
}

/// A bag as another program writes it: stamps of the wall clock, two topics of other names, no metadata of ours.
fn foreign_bag(pressure_type: &str) -> Vec<u8> {
    let mut writer = mcap::WriteOptions::new().profile("ros2").create(Cursor::new(Vec::new())).unwrap();
    let mut channel = |topic: &str, kind: &str| {
        let schema = writer.add_schema(kind, "ros2msg", b"").unwrap();
        writer.add_channel(schema, topic, "cdr", &Default::default()).unwrap()
    };
    let valve = channel("/valve", pressure_type);
    let vision = channel("/vision", "geometry_msgs/msg/PoseStamped");
    for index in 0..10u64 {
        let stamp = 1_700_000_000_000_000_000 + index * 10_000_000;
        let mut head = vec![0u8, 1, 0, 0];
        head.extend(((stamp / 1_000_000_000) as i32).to_le_bytes());
        head.extend(((stamp % 1_000_000_000) as u32).to_le_bytes());
        // An empty frame name: length one, the closing zero, three bytes of padding.
        head.extend([1, 0, 0, 0, 0, 0, 0, 0]);
        let numbers: Vec<f64> = if index % 2 == 0 {
            vec![101_325.0 + 1e3 * index as f64, 0.0]
        } else {
            vec![0.0, 0.0, 0.175, 0.0, 0.0, 0.6, 0.8]
        };
        head.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        let channel_id = if index % 2 == 0 { valve } else { vision };
        // The bag writer got each message later than the one before; the stamp counts.
        let late = stamp + (index + 1) * 1_000_000;
        let header =
            mcap::records::MessageHeader { channel_id, sequence: 0, log_time: late, publish_time: late };
        writer.write_to_known_channel(&header, &head).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

#[test]
fn a_bag_of_another_program_is_read_by_its_topics() {
    let rig = rig(1, "[recordings.topics]\np1 = \"/valve\"\ntip_pose = \"/vision\"\n");
    let file = Scratch::new("foreign.mcap");
    std::fs::write(&file.0, foreign_bag("sensor_msgs/msg/FluidPressure")).unwrap();
    let log = read_mcap(&file.0, Some(&rig)).unwrap();
    assert_eq!(log.recording.len(), 10);
    assert_eq!((log.recording.time[0], log.recording.time[3]), (0.0, 0.03));
    assert_eq!(log.recording.pressure[0][4], 4e3);
    assert!(log.recording.pressure[0][3].is_nan() && log.recording.command.is_empty());
    assert_eq!(log.recording.pose(3).unwrap().wxyz(), [0.8, 0.0, 0.0, 0.6]);
}

#[test]
fn what_cannot_be_written_is_refused() {
    let rig = rig(1, "");
    let file = Scratch::new("refused.mcap");
    let mut writer =
        LogWriter::create(&file.0, &LogHeader::of("run", &rig).unwrap(), &Storage::default()).unwrap();
    assert!(writer.pressure(-1.0, 0, 1e3).unwrap_err().to_string().contains("time -1 s cannot be written"));
    assert!(writer.pressure(f64::NAN, 0, 1e3).is_err());
    assert!(
        writer
            .command(0.0, 1, 1e3)
            .unwrap_err()
            .to_string()
            .contains("a pressure of FREE 2 in a log of 1 FREEs")
    );
    let nothing = f64::NAN;
    let sample = FreeSample {
        twist: nothing,
        extension: nothing,
        outer_diameter: nothing,
        torque: nothing,
        force: nothing,
    };
    writer.free_state(0.0, sample).unwrap();
    writer.finish().unwrap();
    assert!(read_mcap(&file.0, None).unwrap_err().to_string().contains("no pressure and no pose"));
}
