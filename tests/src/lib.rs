//! End-to-end checks of freeact: runs of the binary, agreement with published numbers, bad input.
//!
//! The checks are in `tests/tests`; here is how they run the program and read what it prints.

pub mod images;
pub mod plateau;
pub mod um_module;

use std::{
    env,
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
};

/// What a run of the program left.
#[derive(Debug)]
pub struct Outcome {
    /// Exit code; -1 when a signal ended it.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Outcome {
    /// The outcome, which must be a success.
    #[track_caller]
    pub fn succeeded(self) -> Self {
        assert_eq!(self.code, 0, "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
        self
    }

    /// Standard error without the breaks that wrap it for a terminal.
    pub fn message(&self) -> String {
        self.stderr.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
    }

    /// Standard output as JSON.
    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        match serde_json::from_str(&self.stdout) {
            Ok(value) => value,
            Err(error) => panic!("not JSON ({error}):\n{}\nstderr:\n{}", self.stdout, self.stderr),
        }
    }
}

/// The folder of the project.
pub fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_owned)
}

/// Writes the paper's FREE, `length_mm` long, as `free.toml` into a folder.
pub fn describe_free(folder: &Path, length_mm: f64) {
    let text = fs::read_to_string(data("actuators/buffinton-2020.toml")).expect("the paper's FREE");
    assert!(text.contains("length_mm = 130.0"));
    let text = text.replace("length_mm = 130.0", &format!("length_mm = {length_mm:.1}"));
    fs::write(folder.join("free.toml"), text).expect("writes");
}

/// Runs a line, whose words with an @ are files of the folder.
pub fn freeact_in(folder: &Path, line: &str) -> Outcome {
    freeact(line.split_whitespace().map(|word| match word.strip_prefix('@') {
        Some(name) => folder.join(name).into_os_string(),
        None => word.into(),
    }))
}

/// A file below the folder `data` of the project.
pub fn data(name: &str) -> PathBuf {
    project().join("data").join(name)
}

/// Real recordings of single FREEs, where they are at hand: they may be used in place, not copied into the project. The
/// folder is looked for beside the project, or where the variable `FREEACT_MEASURED` says.
pub fn measured(name: &str) -> Option<PathBuf> {
    let beside = || project().parent().map(|parent| parent.join("shared/data/measured"));
    let folder = env::var_os("FREEACT_MEASURED").map(PathBuf::from).or_else(beside)?.join(name);
    folder.exists().then_some(folder)
}

/// Builds a package in the profile of the tests; the folder that holds what was built.
pub fn build(arguments: &[&str]) -> PathBuf {
    // A test runs from target/PROFILE/deps.
    let test = env::current_exe().expect("the path of this test");
    let folder = test.ancestors().nth(2).expect("a test runs two folders below its profile's");
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet"]).args(arguments).current_dir(project());
    if folder.file_name() == Some(OsStr::new("release")) {
        build.arg("--release");
    }
    assert!(build.status().expect("cargo runs").success(), "{arguments:?} does not build");
    folder.to_owned()
}

/// The program, built once per run of the tests.
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| build(&["--package", "freeact", "--bin", "freeact"]).join("freeact"))
}

/// Runs the program.
pub fn freeact<I: IntoIterator<Item = S>, S: AsRef<OsStr>>(arguments: I) -> Outcome {
    let output = Command::new(program()).args(arguments).output().expect("the program starts");
    Outcome {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Runs the program with arguments written as one line, split at spaces (no argument may hold one).
pub fn freeact_line(line: &str) -> Outcome {
    freeact(line.split_whitespace())
}

/// A table read from a CSV text: names of columns, and rows of text.
pub struct Table {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows, one text a column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a CSV text without quoted fields.
    pub fn parse(text: &str) -> Self {
        let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
        let columns = lines.next().map(split).unwrap_or_default();
        Table { columns, rows: lines.map(split).collect() }
    }

    /// Reads a CSV file.
    #[track_caller]
    pub fn read(path: &Path) -> Self {
        Self::parse(&fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
    }

    /// Number in a row at a named column; NaN where the field is empty.
    #[track_caller]
    pub fn number(&self, row: &[String], column: &str) -> f64 {
        let index = self.columns.iter().position(|name| name == column);
        let index = index.unwrap_or_else(|| panic!("no column {column} in {:?}", self.columns));
        row[index].parse().unwrap_or(f64::NAN)
    }
}
