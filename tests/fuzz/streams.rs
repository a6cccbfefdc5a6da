//! The standard streams of a command: where it reads a patch, and where it prints.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::Path;
use std::process::Stdio;
use std::thread;

use super::command_lines::{PATCH, SWEEP, TABLE, once_in};
use super::special_files::FULL_DEVICE;
use crate::common::random::SplitMix64;

/// The argument that means standard input or standard output.
pub(crate) const DASH: &str = "-";

/// What a command reads from standard input.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) enum StandardInput {
    /// Nothing.
    #[default]
    Empty,
    /// A file or a device, by its path from the folder of the case.
    File(String),
    /// A pipe with the bytes of a file, by its path in the folder of the case.
    Pipe(String),
}

impl StandardInput {
    /// The stream for a command in a folder.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub(crate) fn stdio(&self, folder: &Path) -> io::Result<Stdio> {
        match self {
            StandardInput::Empty => Ok(Stdio::null()),
            StandardInput::File(path) => Ok(File::open(folder.join(path))?.into()),
            StandardInput::Pipe(path) => {
                let bytes = fs::read(folder.join(path))?;
                let (reader, mut writer) = io::pipe()?;
                // A command that does not read everything closes the pipe, which ends the thread.
                thread::spawn(move || writer.write_all(&bytes));
                Ok(reader.into())
            }
        }
    }

    /// The texts before and after a command for a shell.
    pub(crate) fn shell_texts(&self) -> [String; 2] {
        match self {
            StandardInput::Empty => [String::new(), String::new()],
            StandardInput::File(path) => [String::new(), format!(" < {}", quoted(path))],
            StandardInput::Pipe(path) => [format!("cat {} | ", quoted(path)), String::new()],
        }
    }
}

/// Where a command writes standard output.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) enum StandardOutput {
    /// Into a file that is examined.
    #[default]
    Kept,
    /// To a device without space.
    Full,
    /// Into a pipe that nobody reads.
    Closed,
}

impl StandardOutput {
    /// The stream of a command. `kept` is the file that is examined.
    ///
    /// # Errors
    /// If the system does not have the device, or cannot make the pipe.
    pub(crate) fn stdio(self, kept: &File) -> io::Result<Stdio> {
        Ok(match self {
            StandardOutput::Kept => kept.try_clone()?.into(),
            StandardOutput::Full => OpenOptions::new().write(true).open(FULL_DEVICE)?.into(),
            StandardOutput::Closed => {
                let (reader, writer) = io::pipe()?;
                drop(reader);
                writer.into()
            }
        })
    }

    /// The text after a command for a shell.
    pub(crate) fn shell_text(self) -> String {
        match self {
            StandardOutput::Kept => String::new(),
            StandardOutput::Full => format!(" > {FULL_DEVICE}"),
            StandardOutput::Closed => " | true".to_owned(),
        }
    }
}

/// A word that a shell reads as it is.
pub(crate) fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// Replaces a word of a command line, but not the command itself.
pub(crate) fn replace_word(arguments: &mut [String], old: &str, new: &str) {
    let words = arguments.iter_mut().skip(1).filter(|word| word.as_str() == old);
    words.for_each(|word| *word = new.to_owned());
}

/// Sometimes lets a command on a patch print its table, or read the patch from standard input, which is returned.
pub(crate) fn use_streams(arguments: &mut Vec<String>, random: &mut SplitMix64) -> StandardInput {
    if once_in(12, random) {
        [TABLE, SWEEP].iter().for_each(|table| replace_word(arguments, table, DASH));
        // A table and a document on standard output are refused, which need not be tested often.
        let keeps_json = once_in(4, random);
        arguments.retain(|word| keeps_json || word != "--json");
    }
    if !once_in(12, random) {
        return StandardInput::Empty;
    }
    replace_word(arguments, PATCH, DASH);
    let patch = PATCH.to_owned();
    if once_in(2, random) { StandardInput::File(patch) } else { StandardInput::Pipe(patch) }
}

/// Whether a command prints a table on standard output, and nothing else there.
pub(crate) fn prints_table(arguments: &[String]) -> bool {
    let value = |option: &str| {
        let pair = arguments.windows(2).find(|pair| pair[0] == option);
        pair.map(|pair| pair[1].as_str())
    };
    let is_sweep = arguments.first().is_some_and(|command| command == "sweep");
    let has_table = match is_sweep {
        true => value("--out").is_none_or(|path| path == DASH),
        false => value("--csv") == Some(DASH),
    };
    has_table && !arguments.iter().any(|word| word == "--json")
}
