//! Finished points of sweeps, kept on disk as they come: a directory of logs that only grow.
//!
//! A log begins with 8 bytes of magic and the format version (u32, little-endian). Records follow, each of
//!
//! | bytes | what |
//! |---|---|
//! | 4 | length n of the body, u32, little-endian |
//! | 32 | key of the point |
//! | 4 | the first bytes of the BLAKE3 of the 36 before, by which a broken length is told from a record cut off |
//! | n | body: the point (postcard) |
//! | 32 | BLAKE3 of all the record's bytes before |
//!
//! A record is one write to the end of a file that one process has to itself. So a kill leaves whole records and at most one cut
//! off behind them, and programs on several machines may share a directory. A log is never written to again by a later run.

use crate::artefact::Kind;
use serde::{Serialize, de::DeserializeOwned};
use std::{
    collections::HashMap,
    fs::{self, File, OpenOptions},
    io::{self, Read, Seek, SeekFrom, Write},
    ops::Range,
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

/// A log of points.
const LOG: Kind = Kind { magic: *b"FREEpts\0", version: 1, name: "log of points" };
/// What names of logs end in.
const EXTENSION: &str = "points";
/// Bytes of a log before its records.
const HEADER: usize = 12;
/// Bytes of a record before its body.
const HEAD: usize = 4 + 32 + 4;
/// Bytes of a record behind its body.
const TAIL: usize = 32;
/// Least time between two requests that what was written reach the disk, where it outlasts a loss of power.
const SYNC_EVERY: Duration = Duration::from_secs(1);

/// Why a point or a store cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The operating system refused.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The point has no binary form, or one of more than 4 GB.
    #[error("a point cannot be stored: {0}")]
    Encoding(String),
}

/// Name of a point: the BLAKE3 of everything that determines it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PointKey([u8; 32]);

impl PointKey {
    /// The key of the point that `ingredients` determine. Those of different kinds of points must begin with different words.
    ///
    /// # Errors
    /// [`StoreError::Encoding`] where they have no binary form.
    pub fn of<T: Serialize>(ingredients: &T) -> Result<Self, StoreError> {
        Ok(PointKey(blake3::hash(&encoded(ingredients)?).into()))
    }
}

/// Points found in a directory of logs, and a log for new ones.
#[derive(Debug)]
pub struct PointStore {
    directory: PathBuf,
    logs: Vec<PathBuf>,
    places: HashMap<PointKey, Place>,
    warnings: Vec<String>,
    own: Option<OwnLog>,
}

/// Where the body of a point lies.
#[derive(Clone, Debug)]
struct Place {
    log: usize,
    body: Range<usize>,
}

/// The log that this process writes.
#[derive(Debug)]
struct OwnLog {
    index: usize,
    file: File,
    length: usize,
    synced: Option<Instant>,
}

impl PointStore {
    /// Reads the logs of a directory, which is made where it is missing. Other files in it are left alone.
    ///
    /// # Errors
    /// [`StoreError::Io`] where the directory cannot be made or read. What is damaged is no error, but a warning.
    pub fn open(directory: &Path) -> Result<Self, StoreError> {
        let io_error = |source| StoreError::Io { path: directory.to_owned(), source };
        fs::create_dir_all(directory).map_err(io_error)?;
        let mut logs = Vec::new();
        for entry in fs::read_dir(directory).map_err(io_error)? {
            let path = entry.map_err(io_error)?.path();
            if path.extension().is_some_and(|extension| extension == EXTENSION) && path.is_file() {
                logs.push(path);
            }
        }
        logs.sort();
        let mut store = PointStore {
            directory: directory.to_owned(),
            logs,
            places: HashMap::new(),
            warnings: Vec::new(),
            own: None,
        };
        for (log, path) in store.logs.iter().enumerate() {
            let read = match fs::read(path) {
                Ok(bytes) => read_log(&bytes),
                Err(error) => (Vec::new(), Some(error.to_string())),
            };
            for (key, body) in read.0 {
                store.places.entry(key).or_insert(Place { log, body });
            }
            store.warnings.extend(read.1.map(|damage| format!("{}: {damage}", path.display())));
        }
        Ok(store)
    }

    /// What of the directory could not be used, a sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The directory.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Whether there is a point of a key.
    pub fn contains(&self, key: &PointKey) -> bool {
        self.places.contains_key(key)
    }

    /// The point of a key; `None` where it was never stored, and where its bytes have been damaged since.
    pub fn get<T: DeserializeOwned>(&self, key: &PointKey) -> Option<T> {
        let Place { log, body } = self.places.get(key)?;
        let mut record = vec![0; HEAD + body.len() + TAIL];
        let mut file = File::open(&self.logs[*log]).ok()?;
        file.seek(SeekFrom::Start((body.start - HEAD) as u64)).ok()?;
        file.read_exact(&mut record).ok()?;
        match read_record(&record) {
            Found::Whole(found, body) if found == *key => postcard::from_bytes(&record[body]).ok(),
            _ => None,
        }
    }

    /// Stores a point, where there is none of its key: when this returns, it outlasts the end of the process. A second later at
    /// most, as soon as another is stored, it outlasts a loss of power.
    ///
    /// # Errors
    /// [`StoreError`] where it was not stored. The next one begins a new log.
    pub fn put<T: Serialize>(&mut self, key: PointKey, point: &T) -> Result<(), StoreError> {
        if self.places.contains_key(&key) {
            return Ok(());
        }
        let content = encoded(point)?;
        let record = record(key, &content)?;
        let (mut own, bytes) = match self.own.take() {
            Some(own) => (own, record),
            None => (self.begin()?, [&header()[..], &record].concat()),
        };
        let path = &self.logs[own.index];
        let io_error = |source| StoreError::Io { path: path.to_owned(), source };
        own.file.write_all(&bytes).map_err(io_error)?;
        own.length += bytes.len();
        if own.synced.is_none_or(|last| last.elapsed() >= SYNC_EVERY) {
            own.file.sync_data().map_err(io_error)?;
            own.synced = Some(Instant::now());
        }
        let end = own.length - TAIL;
        self.places.insert(key, Place { log: own.index, body: end - content.len()..end });
        self.own = Some(own);
        Ok(())
    }

    /// Waits until what was stored outlasts a loss of power.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn sync(&mut self) -> Result<(), StoreError> {
        match &self.own {
            None => Ok(()),
            Some(own) => own
                .file
                .sync_data()
                .map_err(|source| StoreError::Io { path: self.logs[own.index].clone(), source }),
        }
    }

    /// Removes the logs that were read and written, and the directory where nothing else is in it.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn remove(self) -> Result<(), StoreError> {
        // Closed first: some systems remove no open file.
        drop(self.own);
        for path in self.logs {
            match fs::remove_file(&path) {
                Err(source) if source.kind() != io::ErrorKind::NotFound => {
                    return Err(StoreError::Io { path, source });
                }
                _ => {}
            }
        }
        // Other files may be in it, or other programs' logs.
        drop(fs::remove_dir(&self.directory));
        Ok(())
    }

    /// An empty log of a name that nobody else has.
    fn begin(&mut self) -> Result<OwnLog, StoreError> {
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_nanos();
        let process = std::process::id();
        for attempt in 0u32.. {
            let path = self.directory.join(format!("{since:020}-{process}-{attempt}.{EXTENSION}"));
            match OpenOptions::new().append(true).create_new(true).open(&path) {
                Ok(file) => {
                    // The name, too, shall outlast a loss of power; not every system syncs directories.
                    drop(File::open(&self.directory).and_then(|directory| directory.sync_all()));
                    self.logs.push(path);
                    return Ok(OwnLog { index: self.logs.len() - 1, file, length: 0, synced: None });
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 1000 => {}
                Err(source) => return Err(StoreError::Io { path, source }),
            }
        }
        Err(StoreError::Encoding("no free name for a log".to_owned()))
    }
}

fn encoded<T: Serialize>(content: &T) -> Result<Vec<u8>, StoreError> {
    postcard::to_stdvec(content).map_err(|error| StoreError::Encoding(error.to_string()))
}

fn header() -> [u8; HEADER] {
    let mut header = [0; HEADER];
    header[..8].copy_from_slice(&LOG.magic);
    header[8..].copy_from_slice(&LOG.version.to_le_bytes());
    header
}

fn record(key: PointKey, body: &[u8]) -> Result<Vec<u8>, StoreError> {
    let length = u32::try_from(body.len()).map_err(|error| StoreError::Encoding(error.to_string()))?;
    let mut record = Vec::with_capacity(HEAD + body.len() + TAIL);
    record.extend_from_slice(&length.to_le_bytes());
    record.extend_from_slice(&key.0);
    let check = blake3::hash(&record);
    record.extend_from_slice(&check.as_bytes()[..4]);
    record.extend_from_slice(body);
    let check = blake3::hash(&record);
    record.extend_from_slice(check.as_bytes());
    Ok(record)
}

/// What stands where a record should begin.
enum Found {
    /// A record, and where its body lies.
    Whole(PointKey, Range<usize>),
    /// The beginning of one.
    CutOff,
    /// Something else.
    Damaged,
}

fn read_record(bytes: &[u8]) -> Found {
    let Some((head, rest)) = bytes.split_at_checked(HEAD) else { return Found::CutOff };
    if blake3::hash(&head[..36]).as_bytes()[..4] != head[36..] {
        return Found::Damaged;
    }
    let (mut four, mut key) = ([0; 4], [0; 32]);
    four.copy_from_slice(&head[..4]);
    key.copy_from_slice(&head[4..36]);
    let length = u32::from_le_bytes(four) as usize;
    if rest.len() < length + TAIL {
        return Found::CutOff;
    }
    match blake3::hash(&bytes[..HEAD + length]).as_bytes()[..] == rest[length..length + TAIL] {
        true => Found::Whole(PointKey(key), HEAD..HEAD + length),
        false => Found::Damaged,
    }
}

/// The points of a log, each with the place of its body, and what is wrong with the rest. A record cut off at the end is what a
/// kill leaves, or another program that is just writing: nothing is wrong with that.
fn read_log(bytes: &[u8]) -> (Vec<(PointKey, Range<usize>)>, Option<String>) {
    let mut points = Vec::new();
    if bytes.len() < HEADER && header().starts_with(bytes) {
        return (points, None);
    }
    if !bytes.starts_with(&LOG.magic) {
        return (points, Some(format!("not a {} of freeact; it is not used", LOG.name)));
    }
    if !bytes.starts_with(&header()) {
        return (points, Some(format!("a {} of another format version; it is not used", LOG.name)));
    }
    let mut at = HEADER;
    while at < bytes.len() {
        match read_record(&bytes[at..]) {
            Found::Whole(key, body) => {
                points.push((key, at + body.start..at + body.end));
                at += body.end + TAIL;
            }
            Found::CutOff => break,
            Found::Damaged => {
                let lost = bytes.len() - at;
                let damage = format!(
                    "damaged at byte {at}; the {} points before it are used, the {lost} bytes from there are not",
                    points.len()
                );
                return (points, Some(damage));
            }
        }
    }
    (points, None)
}

#[cfg(test)]
#[path = "point_store_tests.rs"]
mod tests;
