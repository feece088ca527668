use crate::{
    FindingKind, Findings, Layout, LogHeader, Quantity, RecordError, Recording, Storage, examine, read_csv,
    read_mcap, write_mcap,
};
use actuator::Rig;
use std::path::{Path, PathBuf};

/// Reads one recording, CSV or MCAP by its ending, and what is irregular about it.
pub fn read_recording(path: &Path, rig: &Rig) -> Result<(Recording, Findings), RecordError> {
    match path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("csv" | "txt" | "tsv") => read_csv(path, rig),
        Some("mcap") => read_mcap(path, Some(rig)).map(|log| (log.recording, log.findings)),
        _ => Err(RecordError::Mismatch(format!(
            "{}: recordings end in .csv or .mcap; rename the file or convert it",
            path.display()
        ))),
    }
}

/// Reads files of one recording and joins them on the union of their times. Files that hold the same quantities must follow one
/// another in time (a run in parts); files that hold different ones (pressures here, poses there) must be on one clock and
/// overlap.
///
/// # Errors
/// Those of the files; no file; the same quantity twice at overlapping times; files of different quantities that never overlap.
pub fn read_recordings(paths: &[PathBuf], rig: &Rig) -> Result<(Recording, Findings), RecordError> {
    let layout = Layout::of(rig)?;
    let mut parts = Vec::new();
    let mut findings = Findings::default();
    for path in paths {
        let (recording, own) = read_recording(path, rig)?;
        if let [_] = paths {
            return Ok((recording, own));
        }
        // What a part lacks, another may hold: only what is wrong within a file is kept of its findings.
        findings.list.extend(own.list.into_iter().filter(|finding| {
            let kept = [FindingKind::DuplicateTime, FindingKind::Assumption, FindingKind::CutOff];
            kept.contains(&finding.kind)
        }));
        parts.push((path, recording));
    }
    let Some((first, rest)) = parts.split_first() else {
        return Err(RecordError::Mismatch(
            "no recording to read; name at least one .csv or .mcap file".into(),
        ));
    };
    let mut joined = first.1.clone();
    for (path, part) in rest {
        joined = join(&joined, part, path, &layout)?;
    }
    findings.append(examine(&joined, &layout));
    Ok((joined, findings))
}

/// Reads files of one recording ([`read_recordings`]) and writes them as one log.
pub fn import(
    paths: &[PathBuf],
    rig: &Rig,
    out: &Path,
    storage: &Storage,
) -> Result<(Recording, Findings), RecordError> {
    let (recording, findings) = read_recordings(paths, rig)?;
    if paths.iter().any(|path| same_file(path, out)) {
        let message = format!("{} would be written over itself; give another name to --out", out.display());
        return Err(RecordError::Mismatch(message));
    }
    write_mcap(out, &recording, &LogHeader::of(recording.name.clone(), rig)?, storage)?;
    Ok((recording, findings))
}

fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}

/// The quantities of which there is at least one sample.
fn measured(recording: &Recording) -> Vec<Quantity> {
    let any = |quantity: &Quantity| {
        recording.channel(*quantity).is_some_and(|c| c.iter().any(|value| !value.is_nan()))
    };
    recording.quantities().into_iter().filter(any).collect()
}

fn span(recording: &Recording) -> (f64, f64) {
    (recording.time.first().copied().unwrap_or(f64::NAN), recording.time.last().copied().unwrap_or(f64::NAN))
}

fn join(a: &Recording, b: &Recording, path: &Path, layout: &Layout) -> Result<Recording, RecordError> {
    let (of_a, of_b) = (measured(a), measured(b));
    let (span_a, span_b) = (span(a), span(b));
    let overlap = span_a.0 <= span_b.1 && span_b.0 <= span_a.1;
    let shared: Vec<String> = of_b.iter().filter(|q| of_a.contains(q)).map(|q| q.column()).collect();
    let times = format!("{} to {} s and {} to {} s", span_a.0, span_a.1, span_b.0, span_b.1);
    if !shared.is_empty() && overlap {
        return Err(RecordError::Mismatch(format!(
            "{}: {} stand in an earlier file too, at overlapping times ({times}); import each recording by itself, or shift \
             the times",
            path.display(),
            shared.join(", ")
        )));
    }
    if shared.is_empty() && !overlap {
        return Err(RecordError::Mismatch(format!(
            "{}: no time in common with the files before ({times}); bring both to one clock",
            path.display()
        )));
    }
    let mut time: Vec<f64> = a.time.iter().chain(&b.time).copied().collect();
    time.sort_by(f64::total_cmp);
    time.dedup();
    let mut joined = Recording::unmeasured(a.name.clone(), time, layout);
    for (part, quantities) in [(a, of_a), (b, of_b)] {
        for quantity in quantities {
            let places: Vec<usize> = part
                .time
                .iter()
                // Every time is in the list, which was made from them.
                .map(|time| joined.time.partition_point(|other| other < time))
                .collect();
            let (Some(from), Some(to)) = (part.channel(quantity), joined.channel_mut(quantity)) else {
                continue;
            };
            for (value, place) in from.iter().zip(places) {
                to[place] = *value;
            }
        }
    }
    Ok(joined.drop_unrecorded())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{parse_csv, rig_for_tests};

    fn part(name: &str, text: &str, rig: &Rig) -> Recording {
        parse_csv(Path::new(name), text.as_bytes(), rig).unwrap().0
    }

    fn joined(a: &str, b: &str) -> Result<Recording, RecordError> {
        let rig = rig_for_tests(1, "");
        join(&part("a.csv", a, &rig), &part("b.csv", b, &rig), Path::new("b.csv"), &Layout::of(&rig).unwrap())
    }

    #[test]
    fn pressures_and_poses_of_two_files_meet_on_one_clock() {
        let both = joined("t_s,p1_kpa\n0,1\n1,2\n2,3\n", "t_s,x_mm\n0.5,10\n1,20\n").unwrap();
        assert_eq!(both.time, [0.0, 0.5, 1.0, 2.0]);
        assert_eq!((both.pressure[0][0], both.pressure[0][2], both.pressure[0][3]), (1e3, 2e3, 3e3));
        assert!(both.pressure[0][1].is_nan() && both.command.is_empty());
        let x = both.channel(Quantity::Position(0)).unwrap();
        assert!((x[1] - 0.01).abs() < 1e-15 && (x[2] - 0.02).abs() < 1e-15 && x[0].is_nan() && x[3].is_nan());
    }

    #[test]
    fn parts_of_a_run_follow_one_another_in_any_order() {
        let whole = joined("t_s,p1_kpa\n10,3\n11,4\n", "t_s,p1_kpa\n0,1\n1,2\n").unwrap();
        assert_eq!(
            (whole.time.as_slice(), whole.pressure[0].as_slice()),
            ([0.0, 1.0, 10.0, 11.0].as_slice(), [1e3, 2e3, 3e3, 4e3].as_slice())
        );
    }

    #[test]
    fn what_cannot_be_joined_is_refused() {
        let text =
            joined("t_s,p1_kpa\n0,1\n1,2\n", "t_s,p1_kpa,x_mm\n0,1,1\n1,2,2\n").unwrap_err().to_string();
        assert!(
            text.contains(
                "b.csv: p1_kpa stand in an earlier file too, at overlapping times (0 to 1 s and 0 to 1 s)"
            ),
            "{text}"
        );
        let text = joined("t_s,p1_kpa\n0,1\n1,2\n", "t_s,x_mm\n1700000000,1\n").unwrap_err().to_string();
        assert!(text.contains("no time in common"), "{text}");
        let rig = rig_for_tests(1, "");
        assert!(read_recordings(&[], &rig).unwrap_err().to_string().contains("no recording to read"));
        assert!(
            read_recording(Path::new("a.bag"), &rig)
                .unwrap_err()
                .to_string()
                .contains("end in .csv or .mcap")
        );
    }

    #[test]
    fn an_import_writes_what_it_read() {
        let rig = rig_for_tests(1, "");
        let at =
            |name: &str| std::env::temp_dir().join(format!("freeact-import-{}-{name}", std::process::id()));
        let files = [at("a.csv"), at("b.csv")];
        std::fs::write(&files[0], "t_s,p1_kpa\n0,1\n1,2\n2,3\n").unwrap();
        std::fs::write(
            &files[1],
            "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,10,0,175,1,0,0,0\n1,20,0,175,1,0,0,0\n2,30,0,175,1,0,0,0\n",
        )
        .unwrap();
        let out = at("out.mcap");
        let (recording, _) = import(&files, &rig, &out, &Storage::default()).unwrap();
        let (again, _) = read_recordings(std::slice::from_ref(&out), &rig).unwrap();
        assert_eq!(again.channel(Quantity::Position(0)), recording.channel(Quantity::Position(0)));
        assert_eq!((again.len(), again.pressure[0][2]), (3, 3e3));
        let error =
            import(std::slice::from_ref(&out), &rig, &out, &Storage::default()).unwrap_err().to_string();
        for file in files.iter().chain([&out]) {
            std::fs::remove_file(file).unwrap();
        }
        assert!(error.contains("written over itself"), "{error}");
    }
}
