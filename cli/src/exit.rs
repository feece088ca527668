//! What the program's exit codes mean: one table, printed in the README and in `freeact --help`.

use std::process::ExitCode;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// What was asked for was done.
    Done,
    /// The work was done and what it checks does not hold.
    Disagrees,
    /// The command line makes no sense.
    Usage,
    /// The target cannot be reached; the nearest pose was printed.
    Unreachable,
    /// The request was refused.
    Refused,
    /// A file cannot be used.
    File,
    /// A computation did not finish everywhere.
    NotConverged,
    /// Stopped by Ctrl-C.
    Interrupted,
}

impl Exit {
    /// Every way to end, in the order of the codes.
    pub const ALL: [Exit; 8] = [
        Exit::Done,
        Exit::Disagrees,
        Exit::Usage,
        Exit::Unreachable,
        Exit::Refused,
        Exit::File,
        Exit::NotConverged,
        Exit::Interrupted,
    ];

    /// Number and meaning.
    fn row(self) -> (u8, &'static str) {
        match self {
            Exit::Done => (0, "done (for `solve` and `track`: every target reached)"),
            Exit::Disagrees => (
                1,
                "done, and the check failed: a replay that differs from its log, a state solved again that differs from its map",
            ),
            Exit::Usage => (2, "the command line is wrong: unknown flag, missing or impossible value"),
            Exit::Unreachable => (3, "a target is out of reach: the nearest pose was given instead"),
            Exit::Refused => (4, "refused: what was asked for would be wrong or unsafe; the reason is given"),
            Exit::File => (5, "a file cannot be read, understood or written; file, line and field are named"),
            Exit::NotConverged => (6, "a computation did not converge everywhere; what did is kept"),
            Exit::Interrupted => (130, "stopped by Ctrl-C; what was finished is kept and can be resumed"),
        }
    }

    /// The number given to the shell.
    pub fn code(self) -> u8 {
        self.row().0
    }

    /// What it means.
    pub fn meaning(self) -> &'static str {
        self.row().1
    }

    /// The table of codes, one line each.
    pub fn table() -> String {
        let mut text = String::from("Exit codes:\n");
        for exit in Exit::ALL {
            text.push_str(&format!("  {:>3}  {}\n", exit.code(), exit.meaning()));
        }
        text
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_its_own_and_in_the_table() {
        let table = Exit::table();
        for (i, exit) in Exit::ALL.into_iter().enumerate() {
            assert!(table.contains(&format!("{:>3}  {}", exit.code(), exit.meaning())));
            assert!(Exit::ALL[i + 1..].iter().all(|other| other.code() > exit.code()), "{exit:?}");
        }
        // Fixed by others: 2 is clap's code for usage, 130 the shell's for an interrupt.
        assert_eq!((Exit::Usage.code(), Exit::Interrupted.code()), (2, 130));
    }
}
