/// How a log is laid out on disk. What stands in it is the same for all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Storage {
    /// Uncompressed size at which a chunk is closed, bytes. Larger chunks compress better; a kill loses at most one chunk.
    pub chunk_size: u64,
    /// Level of zstd, 1 to 22; 0 is its own default.
    pub compression_level: u32,
    /// Whether each chunk carries an index of its messages (16 bytes a message), by which viewers jump about in long files.
    pub index: bool,
    /// Whether a command is written only where it changes. It holds until the next one, and the metadata say so.
    pub hold_commands: bool,
    /// Steps to which measured numbers are rounded; `None` keeps every bit.
    pub rounding: Option<Rounding>,
}

/// Steps (powers of two, so that rounded numbers have few bits) to which measured numbers are rounded before they are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// Of pressures, Pa.
    pub pressure: f64,
    /// Of positions, m.
    pub position: f64,
    /// Of the components of quaternions.
    pub rotation: f64,
}

impl Default for Storage {
    /// For a log that grows while a rig runs: chunks of 256 KiB, indexed, nothing left out.
    fn default() -> Self {
        Storage {
            chunk_size: 256 * 1024,
            compression_level: 0,
            index: true,
            hold_commands: false,
            rounding: None,
        }
    }
}

impl Storage {
    /// For an archive of recordings read from text: no index (viewers scan such files), commands held, and numbers rounded to
    /// steps well below a file's three decimals of kPa and mm and six of a quaternion, which come back as printed:
    /// 2^-4 Pa, 2^-22 m (0.24 um, printed to 1 um), 2^-22 (2.4e-7, printed to 1e-6).
    pub fn archive() -> Self {
        Storage {
            chunk_size: 4 * 1024 * 1024,
            compression_level: 19,
            index: false,
            hold_commands: true,
            rounding: Some(Rounding {
                pressure: 0.0625,
                position: 1.0 / 4_194_304.0,
                rotation: 1.0 / 4_194_304.0,
            }),
        }
    }
}
