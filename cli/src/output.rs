//! What a command prints. A reader that goes away early (`| head`) ends the output, not the program with an error.

use crate::failure::Failure;
use std::{fs, io::Write, path::Path};

/// Prints text on standard output as it is.
pub fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    drop(out.write_all(text.as_bytes()).and_then(|()| out.flush()));
}

/// Prints a value as JSON on standard output, with a line break.
pub fn print_json(value: &serde_json::Value) {
    print(&format!("{value:#}\n"));
}

/// Writes text to a file, or to standard output where no file is given.
pub fn write(text: &str, path: Option<&Path>) -> Result<(), Failure> {
    match path {
        Some(path) => save(path, text.as_bytes()),
        None => {
            print(text);
            Ok(())
        }
    }
}

/// Writes a file.
pub fn save(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    fs::write(path, bytes).map_err(Failure::at(path))
}

/// Makes a directory, with those above it.
pub fn make_directory(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path).map_err(Failure::at(path))
}
