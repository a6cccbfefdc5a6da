//! Why a sweep cannot be made.

use std::path::PathBuf;

use patchcord_core::document::{RangeViolation, told};
use patchcord_core::ir::SettingError;

/// What is wrong with a plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// Nothing is varied.
    #[error("nothing is varied")]
    Nothing,
    /// A text that gives no values.
    #[error(
        "\"{0}\" gives no values: write NAME=FIRST:LAST:COUNT, NAME=FIRST:LAST:COUNT:log or NAME=VALUE,VALUE,..."
    )]
    NotAnAxis(String),
    /// A value that is no number.
    #[error("\"{text}\" is not a finite number, for {name}")]
    NotANumber {
        /// The parameter.
        name: String,
        /// What was given.
        text: String,
    },
    /// A count of points that is none.
    #[error("\"{text}\" points cannot be spaced for {name}: write a whole number from 2 to {}", told(*.most as f64))]
    BadCount {
        /// The parameter.
        name: String,
        /// What was given.
        text: String,
        /// The limit.
        most: u64,
    },
    /// Logarithmic spacing from or to 0 or below.
    #[error("{0} has a logarithm above 0 only: space it without \":log\"")]
    NotAboveZero(String),
    /// A parameter that does not exist.
    #[error(transparent)]
    Unknown(#[from] SettingError),
    /// A value that the patch does not allow.
    #[error("{0}: vary it within, or widen the range in the patch")]
    OutsideRange(#[from] RangeViolation),
    /// A parameter that two axes vary.
    #[error("{0} is varied twice")]
    Twice(String),
    /// More runs than anybody will wait for.
    #[error("the plan has more than {most} runs: vary in fewer points")]
    TooMany {
        /// The limit.
        most: u64,
    },
    /// A file of rows that the system does not give.
    #[error("cannot read {}: {why}", .file.display())]
    Unread {
        /// The file.
        file: PathBuf,
        /// What the system says.
        why: String,
    },
    /// A file of rows that is no such table.
    #[error("{}: {message}", .file.display())]
    Rows {
        /// The file.
        file: PathBuf,
        /// What is wrong, with its line.
        message: String,
    },
}

/// Why a table of rows cannot be gone on with.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The file system refuses.
    #[error("cannot write {}: {error}", .file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        error: std::io::Error,
    },
    /// Another sweep writes to it at this moment.
    #[error("another sweep is writing {}: wait until it is done, or give another file", .file.display())]
    Busy {
        /// The file.
        file: PathBuf,
    },
    /// It is of another sweep, or no sweep at all.
    #[error(
        "{} is not the table of this sweep, and was left as it is: {change}line {line} is \"{found}\", and this sweep has \
         \"{wanted}\" there; give another file, or remove this one",
        .file.display()
    )]
    OfAnother {
        /// The file.
        file: PathBuf,
        /// What changed since it was written, where that can be told; empty, or ending in "; ".
        change: String,
        /// The first line that differs, from 1.
        line: u64,
        /// What stands there.
        found: String,
        /// What would.
        wanted: String,
    },
    /// Another version of the program began the file.
    #[error(
        "{} was written by another version of patchcord (its first line is \"{found}\", this version writes \"{wanted}\"), \
         and was left as it is: finish it with the version that began it, or give another file",
        .file.display()
    )]
    OtherVersion {
        /// The file.
        file: PathBuf,
        /// The first line of the file, which names the version.
        found: String,
        /// The first line that this version writes.
        wanted: String,
    },
    /// It has more lines than the sweep.
    #[error("{} goes on after the last row of this sweep, in line {line}; it was left as it is", .file.display())]
    TooLong {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: u64,
    },
}
