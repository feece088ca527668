use std::{io, path::PathBuf};

/// Why a recording cannot be read or written, and where.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The operating system refused.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The `[recordings]` table of the rig says something that cannot be.
    #[error("{path}:{line}: [recordings] field `{field}`: {message}", path = path.display())]
    Layout {
        /// The rig file.
        path: PathBuf,
        /// Line, counted from one.
        line: usize,
        /// Name of the field.
        field: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// A CSV file says something that cannot be.
    #[error("{path}:{line}: {column}{message}", path = path.display(), column = in_column(column))]
    Csv {
        /// The file.
        path: PathBuf,
        /// Line, counted from one.
        line: u64,
        /// Name of the column as the file writes it; empty where no single column is at fault.
        column: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// An MCAP file is not one, or is damaged.
    #[error("{path}: {message}", path = path.display())]
    Mcap {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        message: String,
        /// The reason that the format's library gives.
        source: Option<Box<mcap::McapError>>,
    },
    /// A message of an MCAP file cannot be decoded.
    #[error("{path}: topic {topic}, message {index} at {time_ns} ns: {message}", path = path.display())]
    Message {
        /// The file.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// Which message on this topic, counted from one.
        index: usize,
        /// Log time, ns.
        time_ns: u64,
        /// What is wrong and what to do.
        message: String,
    },
    /// Recordings and rig, or recordings among each other, do not fit.
    #[error("{0}")]
    Mismatch(String),
}

fn in_column(column: &str) -> String {
    if column.is_empty() { String::new() } else { format!("column `{column}`: ") }
}
