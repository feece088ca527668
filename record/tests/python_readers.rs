//! Logs are read by other people's libraries: runs tests/python/read_mcap.py on a log with a message on every topic.
//!
//! Needs FREEACT_PYTHON, the Python of an environment with tests/python/requirements.txt installed; says so and skips without it.

use actuator::Rig;
use record::{FreeSample, LogHeader, LogWriter, Shape, SolveRecord, Storage, Strand, TipTopic};
use std::path::Path;
use std::process::Command;

#[test]
fn every_topic_is_decoded_by_mcap_ros2_support_and_rosbags() {
    let Some(python) = std::env::var_os("FREEACT_PYTHON") else {
        eprintln!("SKIPPED: set FREEACT_PYTHON to a Python with tests/python/requirements.txt installed");
        return;
    };
    let text = "kind = \"module\"\n[[free]]\nposition_mm = [0.0, 0.0]\nlength_mm = 175.0\ninner_diameter_mm = 9.52\nwall_mm = 0.8\n\
                winding_angle_deg = 30.0\nfibres = 6\nfibre_ea_newton = 644.0\n[free.elastomer]\nmodel = \"neo-hookean\"\n\
                shear_modulus_mpa = 0.4\n";
    let rig = Rig::parse(Path::new("rig.toml"), text.to_owned()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/python/read_mcap.py");
    for index in [true, false] {
        let path = std::env::temp_dir().join(format!("freeact-python-{}-{index}.mcap", std::process::id()));
        let header = LogHeader { model: b"model".to_vec(), ..LogHeader::of("every topic", &rig).unwrap() };
        let storage = Storage { index, ..Storage::default() };
        let mut log = LogWriter::create(&path, &header, &storage).unwrap();
        for step in 0..50 {
            let time = 0.01 * f64::from(step);
            log.command(time, 0, 1e3 * f64::from(step)).unwrap();
            log.pressure(time, 0, 1e3 * f64::from(step) + 1.0 / 3.0).unwrap();
            for which in [TipTopic::Measured, TipTopic::Predicted, TipTopic::Target] {
                log.tip(time, which, [0.0, 1.0 / 3.0, 0.175], [1.0, 0.0, 0.0, 0.0]).unwrap();
            }
            let strand =
                Strand { points: vec![[0.0; 3], [0.0, 0.0, 0.175]], width: 0.011, color: [1.0, 0.5, 0.0] };
            let plates = vec![([0.0, 0.0, 0.175], [1.0, 0.0, 0.0, 0.0], 0.02, 0.003)];
            log.shape(time, &Shape { strands: vec![strand], plates }).unwrap();
            // Lists and texts of changing length try every padding.
            let solve = SolveRecord {
                time,
                status: "reached".into(),
                reason: "r".repeat(step as usize % 9),
                start_pressure: vec![1.0 / 3.0; step as usize % 4],
                setting_name: vec!["a".repeat(step as usize % 5); step as usize % 3],
                setting_value: vec![0.5; step as usize % 3],
                pressure: vec![2e3; 4],
                ..SolveRecord::default()
            };
            log.solve(&solve).unwrap();
            let sample = FreeSample {
                twist: time,
                extension: f64::NAN,
                outer_diameter: 0.011,
                torque: 0.0,
                force: 0.0,
            };
            log.free_state(time, sample).unwrap();
        }
        log.finish().unwrap();
        let run = Command::new(&python).arg(&script).arg(&path).output().unwrap();
        let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
        std::fs::remove_file(&path).unwrap();
        assert!(run.status.success(), "{out}\n{err}");
        assert!(out.contains("400 messages, the same by mcap-ros2-support and rosbags"), "{out}");
        assert!(out.contains("/solve: 50 x freeact_msgs/msg/Solve"), "{out}");
    }
}
