//! Converts folders of CSV recordings, each with its `rig.toml`, to logs: `convert_rigs FROM TO`.
//!
//! FROM holds one folder a rig; TO gets the same folders with `rig.toml` and one `.mcap` for each `.csv`, laid out as an archive.

use actuator::Rig;
use record::{LogHeader, Storage, read_csv, write_mcap};
use std::error::Error;
use std::path::{Path, PathBuf};

fn entries(folder: &Path) -> Result<Vec<PathBuf>, std::io::Error> {
    let mut paths = std::fs::read_dir(folder)?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<Vec<_>, std::io::Error>>()?;
    paths.sort();
    Ok(paths)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [from, to] = arguments.as_slice() else { return Err("usage: convert_rigs FROM TO".into()) };
    for folder in entries(from)?.into_iter().filter(|path| path.join("rig.toml").is_file()) {
        let rig = Rig::read(&folder.join("rig.toml"))?;
        let into = to.join(folder.file_name().unwrap_or_default());
        std::fs::create_dir_all(&into)?;
        std::fs::write(into.join("rig.toml"), &rig.text)?;
        for file in entries(&folder)?.into_iter().filter(|path| path.extension().is_some_and(|e| e == "csv"))
        {
            let (recording, findings) = read_csv(&file, &rig)?;
            if !findings.is_empty() {
                println!("{}:\n{findings}", file.display());
            }
            let header = LogHeader::of(recording.name.clone(), &rig)?;
            let path = into.join(&recording.name).with_extension("mcap");
            write_mcap(&path, &recording, &header, &Storage::archive())?;
            println!(
                "{}: {} samples, {} bytes",
                path.display(),
                recording.len(),
                std::fs::metadata(&path)?.len()
            );
        }
    }
    Ok(())
}
