//! One case: a folder of files, the arguments of the command, and its standard streams.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::command_lines::{SWEEP, once_in};
use super::corpus::{Corpus, Files};
use super::experiment_case::{effect_case, experiment_case};
use super::large_patch::large_case;
use super::other_commands::{figure_command, other_case, slideway};
use super::patch_case::patch_case;
use super::problem_case::problem_case;
use super::special_case::special_case;
use super::special_files::{FULL_DEVICE, Special, Specials};
use super::streams::{StandardInput, StandardOutput};
use crate::common::random::SplitMix64;

/// The factor between the seeds of two series of cases.
const SERIES: u64 = 1_000_000_007;

/// A folder of files, and a command that runs in it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Case {
    /// The files, by their path in the folder.
    pub files: Files,
    /// The special files. A protected one is also in `files`; the others are not.
    pub specials: Specials,
    /// The arguments of the command.
    pub arguments: Vec<String>,
    /// What the command reads from standard input.
    pub input: StandardInput,
    /// Where the command writes standard output.
    pub output: StandardOutput,
    /// The seed of the damage to the table of a sweep, after which the sweep is continued. `None` if it is not.
    pub damage_seed: Option<u64>,
}

impl Case {
    /// A command with regular files and without standard input.
    pub(crate) fn of(files: Files, arguments: Vec<String>) -> Case {
        // No argument of a command contains a zero byte.
        let arguments = arguments.iter().map(|word| word.replace('\0', "")).collect();
        Case { files, arguments, ..Case::default() }
    }

    /// The case with this number in the series of a seed.
    pub(crate) fn new(corpus: &Corpus, seed: u64, number: u64) -> Case {
        let mut random = SplitMix64(seed.wrapping_mul(SERIES).wrapping_add(number));
        let random = &mut random;
        let mut case = match random.below(100) {
            0..3 if corpus.has_slow_cases => Case::of(Files::new(), slideway(random)),
            3..5 if corpus.has_slow_cases => large_case(random),
            5 if corpus.has_slow_cases => Case::of(Files::new(), figure_command(random)),
            0..15 => experiment_case(corpus, random),
            15..22 => effect_case(corpus, random),
            22..24 => special_case(corpus, random),
            24..28 => other_case(random),
            28..34 => problem_case(corpus, random),
            _ => patch_case(corpus, random),
        };
        if once_in(50, random) {
            case.output = random.choose(&[StandardOutput::Full, StandardOutput::Closed]);
        }
        let has_table = case.arguments.iter().any(|word| word == SWEEP) && !case.specials.contains_key(SWEEP);
        case.damage_seed = (has_table && once_in(2, random)).then_some(random.0);
        case
    }

    /// Creates the files in a folder.
    ///
    /// # Errors
    /// If the system refuses a name.
    pub(crate) fn write(&self, folder: &Path) -> io::Result<()> {
        for (name, bytes) in &self.files {
            fs::write(with_parent(folder, name)?, bytes)?;
        }
        for (name, special) in &self.specials {
            special.create(&with_parent(folder, name)?)?;
        }
        Ok(())
    }

    /// Whether an output goes to a device without space. What is written before is complete in spite of the error.
    pub(crate) fn may_lose_output(&self) -> bool {
        let is_full = |special: &Special| *special == Special::Link(FULL_DEVICE.to_owned());
        self.output == StandardOutput::Full
            || self.specials.values().any(is_full)
            || self.arguments.iter().any(|word| word == FULL_DEVICE)
    }

    /// Whether a file or an argument contains a word.
    pub(crate) fn mentions(&self, word: &str) -> bool {
        let contains = |text: &str| words(text).any(|found| found == word);
        self.files.values().any(|bytes| contains(&String::from_utf8_lossy(bytes)))
            || self.arguments.iter().any(|argument| contains(argument))
    }
}

/// The words of a text: its parts of letters and digits.
pub(crate) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !letter.is_alphanumeric())
}

/// The path of a file in a folder. Its own folder is created.
fn with_parent(folder: &Path, name: &str) -> io::Result<PathBuf> {
    let path = folder.join(name);
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent)?;
    }
    Ok(path)
}
