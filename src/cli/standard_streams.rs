//! The argument `-`: standard input in place of a patch, standard output in place of a table.
//!
//! All other arguments are names of files and folders. A file that is named `-` is given as `./-`.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use patchcord::output::STANDARD_OUTPUT;

/// The name of a patch from standard input, in messages and documents.
pub(super) const STANDARD_INPUT_NAME: &str = "<stdin>";

/// Whether an argument means standard input or standard output.
pub(super) fn is_dash(argument: &Path) -> bool {
    argument.as_os_str() == "-"
}

/// The path of the table that `--csv` selects.
pub(super) fn table_path(argument: &Path) -> PathBuf {
    if is_dash(argument) { PathBuf::from(STANDARD_OUTPUT) } else { argument.to_owned() }
}

/// Checks that a table and a JSON document do not both go to standard output.
///
/// # Errors
/// A usage error if they do.
pub(super) fn check_table(csv: Option<&Path>, json: bool) -> Result<(), Failure> {
    let message = "with --json the table cannot go to standard output: give --csv FILE";
    if json && csv.is_some_and(is_dash) { Err(Failure::usage(message)) } else { Ok(()) }
}

/// Checks that an input that cannot be standard input has a name.
///
/// # Errors
/// A usage error if it is `-`.
pub(super) fn check_input(argument: &Path) -> Result<(), Failure> {
    let message = "\"-\" is standard input, which only a patch can be: give the name of a file, or ./- for a file \
                   with this name";
    if is_dash(argument) { Err(Failure::usage(message)) } else { Ok(()) }
}

/// Checks that an output that cannot be standard output has a name.
///
/// # Errors
/// A usage error if it is `-`.
pub(super) fn check_output(argument: &Path) -> Result<(), Failure> {
    let message = "\"-\" is standard output, which only --csv of run and linearise and --out of sweep can be: give a \
                   name, or ./- for a file or folder with this name";
    if is_dash(argument) { Err(Failure::usage(message)) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_single_dash_means_a_stream() {
        assert!(is_dash(Path::new("-")));
        assert!(["./-", "--", "a-", ""].iter().all(|name| !is_dash(Path::new(name))));
        assert_eq!(table_path(Path::new("-")), Path::new("/dev/stdout"));
        assert_eq!(table_path(Path::new("./-")), Path::new("./-"));
    }
}
