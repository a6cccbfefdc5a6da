//! One case: a folder of files and the arguments of the command.

use std::path::Path;
use std::{fs, io};

use super::changes::changed_document;
use super::command_lines::{PATCH, ROWS, SWEEP, once_in, patch_command};
use super::corpus::{Corpus, Document, Files};
use super::csv_damage::damaged_csv;
use super::document::Node;
use super::experiment_case::{effect_case, experiment_case};
use super::number_text::{changed_number, usual_number};
use super::random_patch::random_patch;
use crate::common::random::SplitMix64;

/// The factor between the seeds of two series of cases.
const SERIES: u64 = 1_000_000_007;

/// A folder of files, and a command that runs in it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Case {
    /// The files, by their path in the folder.
    pub files: Files,
    /// The arguments of the command.
    pub arguments: Vec<String>,
    /// The seed of the damage to the table of a sweep, after which the sweep is continued. `None` if it is not.
    pub damage_seed: Option<u64>,
}

impl Case {
    /// The case with this number in the series of a seed.
    pub(crate) fn new(corpus: &Corpus, seed: u64, number: u64) -> Case {
        let mut random = SplitMix64(seed.wrapping_mul(SERIES).wrapping_add(number));
        let random = &mut random;
        let (files, arguments) = match random.below(100) {
            0..3 if corpus.has_slow_cases => (Files::new(), slideway(random)),
            0..15 => experiment_case(corpus, random),
            15..22 => effect_case(corpus, random),
            _ => patch_case(corpus, random),
        };
        // No argument of a command contains a zero byte.
        let arguments: Vec<String> = arguments.iter().map(|word| word.replace('\0', "")).collect();
        let continues = arguments.iter().any(|word| word == SWEEP) && once_in(2, random);
        let damage_seed = continues.then_some(random.0);
        Case { files, arguments, damage_seed }
    }

    /// Writes the files into a folder.
    ///
    /// # Errors
    /// If the system refuses a name.
    pub(crate) fn write(&self, folder: &Path) -> io::Result<()> {
        for (name, bytes) in &self.files {
            let path = folder.join(name);
            if let Some(parent) = path.parent() {
                fs::create_dir_all(parent)?;
            }
            fs::write(path, bytes)?;
        }
        Ok(())
    }
}

/// Files and a command for a shipped patch with changes, or a random one.
fn patch_case(corpus: &Corpus, random: &mut SplitMix64) -> (Files, Vec<String>) {
    let (document, bytes, mut files) = match random.below(10) {
        0 | 1 => {
            let document = random_patch(random);
            let bytes = document.json().into_bytes();
            (document, bytes, Files::new())
        }
        2 => changed_patch(corpus, Document { node: random_patch(random), files: Files::new() }, random),
        3 | 4 => changed_patch(corpus, random.pick(&corpus.bad_patches).clone(), random),
        _ => changed_patch(corpus, random.pick(&corpus.patches).clone(), random),
    };
    let arguments = patch_command(&document, random);
    if arguments.iter().any(|word| word == ROWS) {
        files.insert(ROWS.to_owned(), rows(&document, random));
    }
    files.insert(PATCH.to_owned(), bytes);
    (files, arguments)
}

/// A changed patch, its text, and its files, of which some are changed too.
fn changed_patch(corpus: &Corpus, document: Document, random: &mut SplitMix64) -> (Node, Vec<u8>, Files) {
    let mut files = document.files;
    for bytes in files.values_mut() {
        if once_in(2, random) {
            *bytes = damaged_csv(bytes, random);
        }
    }
    let (node, bytes) = changed_document(corpus, document.node, random);
    (node, bytes, files)
}

/// A file of parameter values for a sweep, half of the time damaged.
fn rows(document: &Node, random: &mut SplitMix64) -> Vec<u8> {
    let names: Vec<String> = document.names_in("parameters").into_iter().take(2).collect();
    let mut text = format!("{}\n", names.join(","));
    for _ in 0..3 {
        let cells: Vec<String> = names
            .iter()
            .map(|name| {
                let parameter = document.get("parameters").and_then(|section| section.get(name));
                parameter.and_then(|parameter| parameter.get("value")).map_or("1".to_owned(), Node::json)
            })
            .collect();
        text += &format!("{}\n", cells.join(","));
    }
    if once_in(2, random) { damaged_csv(text.as_bytes(), random) } else { text.into_bytes() }
}

/// A prediction for a slideway. Its step is short enough that a run has few events in each step.
fn slideway(random: &mut SplitMix64) -> Vec<String> {
    let required = [("--oil", "2.5"), ("--weight", "433"), ("--stiffness", "45")];
    let optional = [
        ("--area", "697"),
        ("--ridge-width", "50"),
        ("--ridge-height", "2.5"),
        ("--by", "10"),
        ("--threshold", "0.25"),
        ("--window", "0.04"),
    ];
    let mut words = vec!["slideway".to_owned(), "--step".to_owned(), "1e-3".to_owned()];
    for (index, (option, usual)) in required.iter().chain(&optional).enumerate() {
        if index < required.len() || once_in(2, random) {
            let value = if once_in(2, random) { changed_number(usual, random) } else { (*usual).to_owned() };
            words.extend([(*option).to_owned(), value]);
        }
    }
    if once_in(3, random) {
        let name = random.pick(&["M", "K", "f", "Fs", "VcL", "Tc"]);
        words.extend(["--set".to_owned(), format!("{name}={}", usual_number(random))]);
    }
    let outputs = ["--json", "--out=slideway.json", "--plot=profile.svg"];
    words.extend(outputs.get(random.below(5)).map(|word| (*word).to_owned()));
    words
}
