//! What a command prints. A reader that goes away early (`| head`) ends the output, not the program with an error.

use crate::failure::Failure;
use std::{
    fs,
    io::{self, BufWriter, Write},
    path::Path,
};

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

/// Writes a file beside its target and renames it: whatever happens meanwhile, the target is complete or not there.
pub fn replace(path: &Path, write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let beside = Path::new(&beside);
    let written = fs::File::create(beside).map(BufWriter::new).and_then(|mut out| {
        write(&mut out)?;
        out.flush()
    });
    let outcome = written.and_then(|()| fs::rename(beside, path));
    if outcome.is_err() {
        drop(fs::remove_file(beside));
    }
    outcome.map_err(Failure::at(path))
}

/// Makes a directory, with those above it.
pub fn make_directory(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path).map_err(Failure::at(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_breaks_off_leaves_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        replace(&path, &mut |out| out.write_all(b"old")).unwrap();
        let broken = replace(&path, &mut |out| {
            out.write_all(b"ne")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(broken.unwrap_err().paragraph().contains("the disk is full"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
