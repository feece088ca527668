//! Why a command could not do what it was asked for: an exit code and an error with its causes.

use crate::exit::Exit;
use std::{error::Error, fmt, path::Path};

/// An error on its way to the user.
#[derive(Debug)]
pub struct Failure {
    /// The code of the program.
    pub exit: Exit,
    error: Box<dyn Error + Send + Sync>,
}

/// What commands return: how they ended, or why not.
pub type Outcome = Result<Exit, Failure>;

impl Failure {
    /// An error under an exit code.
    pub fn new(exit: Exit, error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Failure { exit, error: error.into() }
    }

    /// A command line that makes no sense.
    pub fn usage(message: impl Into<String>) -> Self {
        Failure::new(Exit::Usage, message.into())
    }

    /// A request that would be wrong to carry out.
    pub fn refused(message: impl Into<String>) -> Self {
        Failure::new(Exit::Refused, message.into())
    }

    /// An end by Ctrl-C before there was anything to keep.
    pub fn interrupted() -> Self {
        Failure::new(Exit::Interrupted, "stopped before the end")
    }

    /// An error about a file whose message names it already.
    pub fn file(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Failure::new(Exit::File, error)
    }

    /// An error of the operating system about a file.
    pub fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |source| Failure::new(Exit::File, FileError { path: path.display().to_string(), source })
    }

    /// The same error, said of a file that it does not name itself.
    pub fn about(self, path: &Path) -> Self {
        Failure { exit: self.exit, error: format!("{}: {}", path.display(), self.paragraph()).into() }
    }

    /// The error and its causes, as one paragraph.
    pub fn paragraph(&self) -> String {
        let mut text = self.error.to_string();
        let mut cause = self.error.source();
        while let Some(error) = cause {
            let message = error.to_string();
            // Many errors print their cause themselves.
            if !text.contains(&message) {
                text = format!("{text}: {message}");
            }
            cause = error.source();
        }
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// The same for programs: `{"error": {"code": 5, "meaning": "...", "message": "..."}}`.
    pub fn json(&self) -> serde_json::Value {
        serde_json::json!({ "error": {
            "code": self.exit.code(), "meaning": self.exit.meaning(), "message": self.paragraph(),
        }})
    }
}

impl From<actuator::DescriptionError> for Failure {
    fn from(error: actuator::DescriptionError) -> Self {
        Failure::file(error)
    }
}

impl From<actuator::artefact::ArtefactError> for Failure {
    fn from(error: actuator::artefact::ArtefactError) -> Self {
        Failure::file(error)
    }
}

impl From<rom::ModelError> for Failure {
    fn from(error: rom::ModelError) -> Self {
        Failure::file(error)
    }
}

#[derive(Debug)]
struct FileError {
    path: String,
    source: std::io::Error,
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path, self.source)
    }
}

impl Error for FileError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&self.source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_is_told_once_and_on_one_line() {
        let missing = std::io::Error::other("no such\n  thing");
        let failure = Failure::at(Path::new("a.toml"))(missing);
        assert_eq!(failure.paragraph(), "a.toml: no such thing");
        assert_eq!(failure.json()["error"]["code"], 5);
    }
}
