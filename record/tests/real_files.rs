//! Reads recordings as they lie on disk: the rigs of the project and, where they are there, measured ones.

use actuator::Rig;
use record::{FindingKind, Quantity, Recording, read_csv, read_mcap};
use std::path::{Path, PathBuf};

/// Folder of recordings that do not belong to the project, named by the environment; `None` says so and skips.
fn outside(variable: &str) -> Option<PathBuf> {
    let found = std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_dir());
    if found.is_none() {
        eprintln!("SKIPPED: set {variable} to the folder of these recordings to run this test");
    }
    found
}

fn csv_files(folder: &Path) -> Vec<PathBuf> {
    files(folder, "csv")
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == ending))
        .collect();
    files.sort();
    files
}

#[test]
fn measured_single_frees_are_read() {
    let Some(folder) = outside("FREEACT_MEASURED") else { return };
    let mut count = 0;
    for file in csv_files(&folder.join("um-free")) {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let rig = Rig::read(&folder.join("um-free").join(format!("{}.toml", &name[..6]))).unwrap();
        let (recording, findings) = read_csv(&file, &rig).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(recording.pressure.len(), 1);
        assert!(findings.of_kind(FindingKind::UnitSlip).next().is_none(), "{name}: {findings}");
        count += 1;
    }
    assert_eq!(count, 15);
}

#[test]
fn the_measured_module_is_read_and_its_faults_are_reported() {
    let Some(folder) = outside("FREEACT_MEASURED") else { return };
    let rig = Rig::read(&folder.join("um-module/rig.toml")).unwrap();
    let (recording, findings) = read_csv(&folder.join("um-module/grid.csv"), &rig).unwrap();
    // 37,590 rows, seven of which repeat a time.
    assert_eq!(findings.of_kind(FindingKind::DuplicateTime).map(|finding| finding.count).sum::<usize>(), 7);
    assert_eq!(recording.len(), 37_583);
    // The start is the rest position by the words of the rig's file.
    assert!((recording.pose(0).unwrap().position.z - 0.16).abs() < 1e-5);
    let missing: Vec<usize> = findings.of_kind(FindingKind::Missing).map(|finding| finding.count).collect();
    assert_eq!(missing, [990; 7], "{findings}");
    let spikes =
        findings.of_kind(FindingKind::Outlier).find(|finding| finding.channel == "position").unwrap();
    assert!(spikes.message.contains("far off"), "{findings}");
    eprintln!("{findings}");
}

#[test]
fn rigs_are_read_and_are_healthy() {
    let Some(folder) = outside("FREEACT_RIGS") else { return };
    let mut samples = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let rig_folder = entry.unwrap().path();
        let rig = Rig::read(&rig_folder.join("rig.toml")).unwrap();
        for file in csv_files(&rig_folder) {
            let (recording, findings): (Recording, _) =
                read_csv(&file, &rig).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!((recording.command.len(), recording.pressure.len()), (4, 4));
            assert!((0..recording.len()).all(|index| recording.pose(index).is_some()));
            assert!(findings.is_empty(), "{}: {findings}", file.display());
            samples += recording.len();
        }
    }
    eprintln!("{samples} samples");
    assert!(samples > 200_000);
}

/// The rigs of the project, recorded as logs.
fn rigs_of_the_project() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/rigs");
    let mut rigs: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    rigs.retain(|path| path.is_dir());
    rigs.sort();
    rigs
}

/// Decimals with which a quantity was printed before it became a log.
fn printed_step(quantity: Quantity) -> f64 {
    if matches!(quantity, Quantity::Rotation(_)) { 1e-6 } else { 1e-3 * quantity.unit() }
}

#[test]
fn the_logs_of_the_project_are_whole_healthy_and_keep_their_printed_decimals() {
    let mut samples = 0;
    for folder in rigs_of_the_project() {
        let rig = Rig::read(&folder.join("rig.toml")).unwrap();
        for file in files(&folder, "mcap") {
            let log = read_mcap(&file, Some(&rig)).unwrap_or_else(|error| panic!("{error}"));
            assert!(log.findings.is_empty(), "{}: {}", file.display(), log.findings);
            assert_eq!(log.rig_text.as_deref(), Some(rig.text.as_str()));
            for quantity in log.recording.quantities() {
                let step = printed_step(quantity);
                let channel = log.recording.channel(quantity).unwrap();
                assert_eq!(channel.len(), log.recording.len());
                // Archives are rounded to steps of about a quarter of the last decimal (2^-22): half of one is the most.
                let furthest = channel
                    .iter()
                    .map(|value| ((value / step).round() * step - value).abs())
                    .fold(0.0, f64::max);
                assert!(furthest < 0.13 * step, "{quantity:?}: {furthest}");
            }
            samples += log.recording.len();
        }
    }
    assert_eq!(samples, 227_600);
}

#[test]
fn the_logs_of_the_project_give_back_the_numbers_of_their_csv_files() {
    let Some(original) = outside("FREEACT_RIGS") else { return };
    let mut compared = 0;
    for folder in rigs_of_the_project() {
        let rig = Rig::read(&folder.join("rig.toml")).unwrap();
        for file in files(&folder, "mcap") {
            let csv = original
                .join(folder.file_name().unwrap())
                .join(file.with_extension("csv").file_name().unwrap());
            let (before, _) = read_csv(&csv, &rig).unwrap();
            let log = read_mcap(&file, Some(&rig)).unwrap().recording;
            assert_eq!(
                (before.time.as_slice(), before.quantities()),
                (log.time.as_slice(), log.quantities())
            );
            for quantity in before.quantities() {
                let step = printed_step(quantity);
                for (a, b) in before.channel(quantity).unwrap().iter().zip(log.channel(quantity).unwrap()) {
                    // The same whole number of last decimals.
                    assert_eq!(
                        (a / step).round(),
                        (b / step).round(),
                        "{} {quantity:?}: {a} and {b}",
                        csv.display()
                    );
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 227_600 * 15);
}
