//! Binary files of the project (maps, models): a header that names and guards the content, then the content.
//!
//! Layout: 8 bytes magic, u32 little-endian format version, 32 bytes BLAKE3 of the body, body (postcard).
//! A file is written beside its target and renamed when the disk has it, so that a kill or a loss of power leaves either the old
//! file or the new one.

use serde::{Serialize, de::DeserializeOwned};
use std::{
    fs::{self, File},
    io::{self, Write},
    path::{Path, PathBuf},
};

/// Kind of a binary file: its magic bytes, the version now written and its name in messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// First eight bytes of the file.
    pub magic: [u8; 8],
    /// Format version.
    pub version: u32,
    /// What the file is called in messages.
    pub name: &'static str,
}

/// A map of a FREE or of a module.
pub const MAP: Kind = Kind { magic: *b"FREEmap\0", version: 4, name: "map" };
/// The same as it was written before maps told what computed them.
pub const MAP_VERSION_1: Kind = Kind { version: 1, ..MAP };
/// The same before maps had named axes, loads, energies and errors.
pub const MAP_VERSION_2: Kind = Kind { version: 2, ..MAP };
/// The same before states of modules told how near their FREEs are to each other.
pub const MAP_VERSION_3: Kind = Kind { version: 3, ..MAP };
/// A fitted model.
pub const MODEL: Kind = Kind { magic: *b"FREEmdl\0", version: 3, name: "model" };
/// The same before models had error bars and domains other than boxes.
pub const MODEL_VERSION_1: Kind = Kind { version: 1, ..MODEL };
/// The same before models of single FREEs had error bars.
pub const MODEL_VERSION_2: Kind = Kind { version: 2, ..MODEL };

/// Why a binary file cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum ArtefactError {
    /// The operating system refused.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The first bytes are not those of this kind.
    #[error("{path}: not a freeact {expected} file (it begins with {found:?}); give a file made by `freeact {maker}`", path = path.display())]
    WrongMagic {
        /// The file.
        path: PathBuf,
        /// Kind that was asked for.
        expected: &'static str,
        /// Command that makes one.
        maker: &'static str,
        /// What stands there.
        found: String,
    },
    /// Written by a version that this one does not know.
    #[error("{path}: {name} format version {found} is not known here (this program reads up to {known}); use a newer freeact", path = path.display())]
    WrongVersion {
        /// The file.
        path: PathBuf,
        /// Kind of file.
        name: &'static str,
        /// Version in the file.
        found: u32,
        /// Newest version known.
        known: u32,
    },
    /// The content does not match its checksum, or ends early.
    #[error("{path}: the {name} file is damaged ({detail}); make it again or fetch a whole copy", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Kind of file.
        name: &'static str,
        /// What was found.
        detail: String,
    },
}

const HEADER: usize = 8 + 4 + 32;

/// Serialises `content` into the bytes of a file of `kind`.
pub fn to_bytes<T: Serialize>(kind: Kind, content: &T) -> Result<Vec<u8>, String> {
    let body = postcard::to_stdvec(content).map_err(|error| error.to_string())?;
    let mut bytes = Vec::with_capacity(HEADER + body.len());
    bytes.extend_from_slice(&kind.magic);
    bytes.extend_from_slice(&kind.version.to_le_bytes());
    bytes.extend_from_slice(blake3::hash(&body).as_bytes());
    bytes.extend_from_slice(&body);
    Ok(bytes)
}

/// Writes `content` as a file of `kind`, atomically.
pub fn write<T: Serialize>(path: &Path, kind: Kind, content: &T) -> Result<(), ArtefactError> {
    let damaged = |detail| ArtefactError::Damaged { path: path.to_owned(), name: kind.name, detail };
    let bytes = to_bytes(kind, content).map_err(damaged)?;
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let io_error = |source| ArtefactError::Io { path: path.to_owned(), source };
    let written = File::create(&beside).and_then(|mut file| {
        file.write_all(&bytes)?;
        file.sync_all()
    });
    written.map_err(io_error)?;
    fs::rename(&beside, path).map_err(io_error)
}

/// Format version that the bytes of a file claim; `None` where they are too few.
pub fn version(bytes: &[u8]) -> Option<u32> {
    let four: [u8; 4] = bytes.get(8..12)?.try_into().ok()?;
    Some(u32::from_le_bytes(four))
}

/// Reads a file of `kind`.
pub fn read<T: DeserializeOwned>(path: &Path, kind: Kind) -> Result<T, ArtefactError> {
    let bytes = fs::read(path).map_err(|source| ArtefactError::Io { path: path.to_owned(), source })?;
    from_bytes(path, kind, &bytes)
}

/// Reads the bytes of a file of `kind`; `path` is for messages.
pub fn from_bytes<T: DeserializeOwned>(path: &Path, kind: Kind, bytes: &[u8]) -> Result<T, ArtefactError> {
    let path = path.to_owned();
    if bytes.len() < 8 || bytes[..8] != kind.magic {
        let found = String::from_utf8_lossy(&bytes[..bytes.len().min(8)]).into_owned();
        let maker = if kind.magic == MAP.magic { "map" } else { "fit" };
        return Err(ArtefactError::WrongMagic { path, expected: kind.name, maker, found });
    }
    let damaged =
        |path, detail: &str| ArtefactError::Damaged { path, name: kind.name, detail: detail.to_owned() };
    if bytes.len() < HEADER {
        return Err(damaged(path, "it ends inside its header"));
    }
    let version = version(bytes).unwrap_or_default();
    if version != kind.version {
        return Err(ArtefactError::WrongVersion {
            path,
            name: kind.name,
            found: version,
            known: kind.version,
        });
    }
    let body = &bytes[HEADER..];
    if blake3::hash(body).as_bytes()[..] != bytes[12..HEADER] {
        return Err(damaged(path, "its checksum does not match its content"));
    }
    postcard::from_bytes(body).map_err(|error| ArtefactError::Damaged {
        path,
        name: kind.name,
        detail: error.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damage_is_told_from_strangeness() {
        let bytes = to_bytes(MAP, &vec![1.5f64, -2.0]).unwrap();
        let path = Path::new("x.map");
        assert_eq!(from_bytes::<Vec<f64>>(path, MAP, &bytes).unwrap(), [1.5, -2.0]);
        let message = |bytes: &[u8]| from_bytes::<Vec<f64>>(path, MAP, bytes).unwrap_err().to_string();
        assert!(message(b"PK\x03\x04 a zip").contains("not a freeact map"));
        assert!(message(&bytes[..20]).contains("ends inside its header"));
        assert!(message(&bytes[..bytes.len() - 1]).contains("checksum"));
        let mut flipped = bytes.clone();
        *flipped.last_mut().unwrap() ^= 1;
        assert!(message(&flipped).contains("checksum"));
        let mut future = bytes;
        future[8] = 99;
        assert!(message(&future).contains("version 99"));
    }
}
