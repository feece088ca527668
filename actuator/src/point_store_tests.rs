use super::*;

fn key(number: u64) -> PointKey {
    PointKey::of(&("test", number)).unwrap()
}

/// The point of a number: bodies of different lengths, the first one empty.
fn point(number: u64) -> Vec<f64> {
    (0..number).map(|i| (number * 100 + i) as f64).collect()
}

/// A directory whose single log holds the first `count` points.
fn stored(count: u64) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let mut store = PointStore::open(folder.path()).unwrap();
    for number in 0..count {
        store.put(key(number), &point(number)).unwrap();
    }
    let log = store.logs[0].clone();
    (folder, log)
}

/// The points of a directory, all of which must be right, and what it warns of.
fn read(folder: &Path, of: u64) -> (Vec<u64>, Vec<String>) {
    let store = PointStore::open(folder).unwrap();
    let numbers: Vec<u64> = (0..of).filter(|number| store.places.contains_key(&key(*number))).collect();
    assert_eq!(numbers.len(), store.len());
    for number in &numbers {
        assert_eq!(store.get::<Vec<f64>>(&key(*number)).unwrap(), point(*number));
    }
    (numbers, store.warnings)
}

/// Where each record of a log ends.
fn ends(bytes: &[u8]) -> Vec<usize> {
    read_log(bytes).0.into_iter().map(|(_, body)| body.end + TAIL).collect()
}

#[test]
fn what_was_put_is_found_by_the_same_store_and_by_the_next() {
    let folder = tempfile::tempdir().unwrap();
    let below = folder.path().join("a/b");
    let mut store = PointStore::open(&below).unwrap();
    assert!(store.is_empty() && fs::read_dir(&below).unwrap().next().is_none(), "an empty log");
    for number in 0..5 {
        store.put(key(number), &point(number)).unwrap();
        assert_eq!(store.get::<Vec<f64>>(&key(number)).unwrap(), point(number));
    }
    assert_eq!(store.get::<Vec<f64>>(&key(5)), None);
    store.sync().unwrap();
    drop(store);
    assert_eq!(read(&below, 9), ((0..5).collect(), vec![]));
    // A second run writes a log of its own, and leaves the first as it is.
    let mut store = PointStore::open(&below).unwrap();
    let first = fs::read(&store.logs[0]).unwrap();
    store.put(key(7), &point(7)).unwrap();
    assert_eq!((store.logs.len(), fs::read(&store.logs[0]).unwrap()), (2, first));
    assert_eq!(read(&below, 9).0, [0, 1, 2, 3, 4, 7]);
    store.remove().unwrap();
    assert!(!below.exists());
}

#[test]
fn a_log_cut_off_anywhere_gives_its_whole_records() {
    let (folder, log) = stored(6);
    let bytes = fs::read(&log).unwrap();
    let ends = ends(&bytes);
    assert_eq!(ends.last(), Some(&bytes.len()));
    for length in 0..=bytes.len() {
        fs::write(&log, &bytes[..length]).unwrap();
        let whole = ends.iter().filter(|end| **end <= length).count() as u64;
        assert_eq!(read(folder.path(), 6), ((0..whole).collect(), vec![]), "{length} bytes");
    }
    // What comes next goes to another log, so that a cut-off end never has anything behind it.
    fs::write(&log, &bytes[..bytes.len() - 1]).unwrap();
    let mut store = PointStore::open(folder.path()).unwrap();
    for number in 5..8 {
        store.put(key(number), &point(number)).unwrap();
    }
    assert_eq!(read(folder.path(), 8), ((0..8).collect(), vec![]));
    assert_eq!(fs::read(&log).unwrap().len(), bytes.len() - 1);
}

#[test]
fn a_changed_byte_anywhere_is_told_and_costs_what_lies_behind_it() {
    let (folder, log) = stored(4);
    let bytes = fs::read(&log).unwrap();
    let ends = ends(&bytes);
    for at in 0..bytes.len() {
        for change in [1u8, 0x80, 0xff] {
            let mut changed = bytes.clone();
            changed[at] ^= change;
            fs::write(&log, &changed).unwrap();
            let whole = if at < HEADER { 0 } else { ends.iter().filter(|end| **end <= at).count() as u64 };
            let (numbers, warnings) = read(folder.path(), 4);
            assert_eq!(numbers, (0..whole).collect::<Vec<_>>(), "byte {at}");
            assert_eq!(warnings.len(), 1, "byte {at}");
        }
    }
    // As a loss of power may leave it: grown, but never filled.
    let empty = [&bytes[..], &[0; 300]].concat();
    fs::write(&log, empty).unwrap();
    let (numbers, warnings) = read(folder.path(), 4);
    assert_eq!(numbers.len(), 4);
    assert!(warnings[0].contains(&format!("damaged at byte {}; the 4 points", bytes.len())), "{warnings:?}");
}

#[test]
fn damage_after_the_opening_is_seen_when_the_point_is_asked_for() {
    let (folder, log) = stored(3);
    let store = PointStore::open(folder.path()).unwrap();
    let mut bytes = fs::read(&log).unwrap();
    let ends = ends(&bytes);
    bytes[ends[2] - TAIL - 1] ^= 1;
    fs::write(&log, &bytes).unwrap();
    assert_eq!(store.get::<Vec<f64>>(&key(2)), None);
    assert_eq!(store.get::<Vec<f64>>(&key(1)), Some(point(1)));
    fs::remove_file(&log).unwrap();
    assert_eq!(store.get::<Vec<f64>>(&key(1)), None);
}

#[test]
fn a_point_is_stored_once_and_the_first_holds() {
    let (folder, log) = stored(2);
    let length = fs::metadata(&log).unwrap().len();
    let mut store = PointStore::open(folder.path()).unwrap();
    store.put(key(1), &vec![-1.0]).unwrap();
    assert_eq!((store.len(), store.logs.len()), (2, 1));
    store.put(key(2), &point(2)).unwrap();
    store.put(key(2), &vec![-1.0]).unwrap();
    assert_eq!(store.get::<Vec<f64>>(&key(2)), Some(point(2)));
    assert_eq!(fs::metadata(&log).unwrap().len(), length);
    assert_eq!(ends(&fs::read(&store.logs[1]).unwrap()).len(), 1);
    // Two that knew nothing of each other may both have it.
    fs::copy(&log, folder.path().join("copy.points")).unwrap();
    assert_eq!(read(folder.path(), 3), (vec![0, 1, 2], vec![]));
}

#[test]
fn writers_share_a_directory_and_readers_never_see_half_a_record() {
    let folder = tempfile::tempdir().unwrap();
    const WRITERS: u64 = 4;
    const EACH: u64 = 60;
    std::thread::scope(|scope| {
        let writers: Vec<_> = (0..WRITERS)
            .map(|writer| {
                let folder = folder.path();
                scope.spawn(move || {
                    let mut store = PointStore::open(folder).unwrap();
                    for number in 0..EACH {
                        let number = number * WRITERS + writer;
                        store.put(key(number), &point(number)).unwrap();
                    }
                })
            })
            .collect();
        let mut before = 0;
        while !writers.iter().all(|writer| writer.is_finished()) {
            let (numbers, warnings) = read(folder.path(), WRITERS * EACH);
            assert!(warnings.is_empty() && numbers.len() >= before, "{warnings:?}");
            before = numbers.len();
        }
    });
    assert_eq!(read(folder.path(), WRITERS * EACH), ((0..WRITERS * EACH).collect(), vec![]));
    assert_eq!(PointStore::open(folder.path()).unwrap().logs.len(), 4);
}

#[test]
fn foreign_files_are_left_alone() {
    let (folder, _) = stored(3);
    let put = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    put("notes.txt", b"FREEpts\0");
    put("README", b"");
    fs::create_dir(folder.path().join("a.points")).unwrap();
    assert_eq!(read(folder.path(), 3), (vec![0, 1, 2], vec![]));
    put("b.points", b"not a log at all");
    put("c.points", b"FREEpts\0\x09\0\0\0 of a later version");
    let (numbers, warnings) = read(folder.path(), 3);
    assert_eq!(numbers, [0, 1, 2]);
    assert!(warnings[0].contains("b.points: not a log of points of freeact"), "{warnings:?}");
    assert!(warnings[1].contains("c.points: a log of points of another format version"), "{warnings:?}");
    // What is not a log outlives the store, and so does its directory.
    PointStore::open(folder.path()).unwrap().remove().unwrap();
    assert!(folder.path().join("notes.txt").exists() && folder.path().join("a.points").is_dir());
}

#[test]
fn a_directory_that_cannot_be_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, b"").unwrap();
    let error = PointStore::open(&file.join("below")).unwrap_err();
    assert!(error.to_string().contains("below"), "{error}");
    // A store whose directory was removed says so, and goes on when it is there again.
    let below = folder.path().join("store");
    let mut store = PointStore::open(&below).unwrap();
    fs::remove_dir(&below).unwrap();
    assert!(store.put(key(1), &point(1)).unwrap_err().to_string().contains("store"));
    assert!(store.is_empty());
    fs::create_dir(&below).unwrap();
    store.put(key(1), &point(1)).unwrap();
    assert_eq!(read(&below, 3).0, [1]);
}

#[test]
fn keys_are_told_apart_by_every_bit_of_what_they_are_made_of() {
    let of = |word: &str, number: f64, list: &[f64]| PointKey::of(&(word, number, list)).unwrap();
    let one = of("a", 1.0, &[2.0]);
    assert_eq!(one, of("a", 1.0, &[2.0]));
    for other in [
        of("b", 1.0, &[2.0]),
        of("a", 1.0 + f64::EPSILON, &[2.0]),
        of("a", 1.0, &[]),
        of("a", 1.0, &[2.0, 0.0]),
        of("a", 1.0, &[-2.0]),
    ] {
        assert_ne!(one, other);
    }
}
