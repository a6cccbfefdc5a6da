//! Errors of a sweep: a bad plan, or a file that cannot be continued.

use std::path::PathBuf;

use patchcord_core::document::{ParameterRangeError, TypedNumberError, format_number};
use patchcord_core::ir::SettingError;
use patchcord_core::output::io_reason;

/// Why a plan is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The plan has no axis.
    #[error("no parameter is varied")]
    NoAxis,
    /// The text is not in one of the three forms of an axis.
    #[error(
        "\"{0}\" gives no values: write NAME=FIRST:LAST:COUNT, NAME=FIRST:LAST:COUNT:log or NAME=VALUE,VALUE,..."
    )]
    NotAnAxis(String),
    /// A value is not a finite number, or has a unit of another dimension than the parameter.
    #[error("{name}: {reason}")]
    NotANumber {
        /// Name of the parameter.
        name: String,
        /// Why the text is not a value of the parameter.
        reason: TypedNumberError,
    },
    /// The axis has an empty value, such as after a comma at the end.
    #[error("{name}: a value is missing in \"{values}\": write a number there, or remove the extra comma")]
    MissingValue {
        /// Name of the parameter.
        name: String,
        /// The text after the equals sign.
        values: String,
    },
    /// The number of points is invalid.
    #[error("{name}: number of points must be an integer from 2 to {}, got \"{text}\"", format_number(*.max as f64))]
    BadCount {
        /// Name of the parameter.
        name: String,
        /// The text that was given.
        text: String,
        /// The largest allowed number.
        max: u64,
    },
    /// An end of a logarithmic axis is not positive. The field is the parameter.
    #[error("{0}: logarithmic spacing needs positive ends: remove \":log\" or change them")]
    NotAboveZero(String),
    /// The patch has no such parameter.
    #[error(transparent)]
    Unknown(#[from] SettingError),
    /// A value is outside the range that the patch declares.
    #[error("{0}: choose a value in the range, or widen it in the patch")]
    OutsideRange(#[from] ParameterRangeError),
    /// Two axes vary the same parameter. The field is its name.
    #[error("{0} is varied twice")]
    DuplicateParameter(String),
    /// The number of combinations is too large.
    #[error("the plan has more than {max} runs: use fewer points")]
    TooManyRuns {
        /// The largest allowed number.
        max: u64,
    },
    /// The file with the values cannot be read.
    #[error("cannot read {}: {why}", .file.display())]
    Unread {
        /// Path of the file.
        file: PathBuf,
        /// The message of the operating system.
        why: String,
    },
    /// The file with the values is not a valid table. The field has at most ten faults, each with its line and with
    /// what to do.
    #[error("{}", .0.join("\n"))]
    Rows(Vec<String>),
}

/// Why a sweep file cannot be written or continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JournalError {
    /// The file cannot be read or written.
    #[error("cannot write {}: {}", .file.display(), io_reason(.error))]
    Io {
        /// Path of the file.
        file: PathBuf,
        /// The error of the operating system.
        #[source]
        error: std::io::Error,
    },
    /// Another sweep has locked the file.
    #[error("another sweep is writing {}: wait until it ends, or specify another file", .file.display())]
    Busy {
        /// Path of the file.
        file: PathBuf,
    },
    /// The file is the result of another sweep, or no sweep file.
    #[error(
        "{} does not belong to this sweep: {change}line {line} is \"{found}\", expected \"{wanted}\"; the file is \
         unchanged: specify another file, or remove this one",
        .file.display()
    )]
    OtherSweep {
        /// Path of the file.
        file: PathBuf,
        /// What has changed since the file was written, ending in "; ". Empty if unknown.
        change: String,
        /// Number of the first line that differs, from 1.
        line: u64,
        /// The line in the file.
        found: String,
        /// The line that this sweep writes.
        wanted: String,
    },
    /// Another version of the program wrote the file.
    #[error(
        "{} was written by another version of patchcord (its first line is \"{found}\", this version writes \
         \"{wanted}\"); the file is unchanged: complete it with the version that started it, or specify another file",
        .file.display()
    )]
    OtherVersion {
        /// Path of the file.
        file: PathBuf,
        /// The first line of the file, which names the version.
        found: String,
        /// The first line that this version writes.
        wanted: String,
    },
    /// The file has lines after the last row of the sweep.
    #[error("{} continues after the last row of this sweep, in line {line}; the file is unchanged", .file.display())]
    TooLong {
        /// Path of the file.
        file: PathBuf,
        /// Number of the first such line, from 1.
        line: u64,
    },
    /// A line that begins like a row is no row of the sweep.
    #[error(
        "line {line} of {} is no row of this sweep: {reason}; the file is unchanged: correct the line, or remove it \
         and all lines after it to compute them again",
        .file.display()
    )]
    BadRow {
        /// Path of the file.
        file: PathBuf,
        /// Number of the line, from 1.
        line: u64,
        /// What is wrong with the line, with the name of the column.
        reason: String,
    },
    /// The file was deleted or renamed while the sweep was running.
    #[error(
        "{} was deleted or renamed during the sweep, and no more rows were written: put it back and give the same \
         command to continue, or start again",
        .file.display()
    )]
    Removed {
        /// Path of the file.
        file: PathBuf,
    },
    /// Another file took the place of the file while the sweep was running.
    #[error(
        "{} was replaced by another file during the sweep, and no more rows were written: the new file is unchanged; \
         specify another file",
        .file.display()
    )]
    Replaced {
        /// Path of the file.
        file: PathBuf,
    },
    /// Another program changed the file while the sweep was running.
    #[error(
        "another program changed {} during the sweep, and no more rows were written: it has {found} bytes instead of \
         {expected}; the same command checks its rows and continues",
        .file.display()
    )]
    Resized {
        /// Path of the file.
        file: PathBuf,
        /// Size of the file, in bytes.
        found: u64,
        /// Size of the head and the rows that were written, in bytes.
        expected: u64,
    },
}
