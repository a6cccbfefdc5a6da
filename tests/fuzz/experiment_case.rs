//! Random experiments and effects.

use serde_json::Value;

use super::case::Case;
use super::changes::changed_document;
use super::command_lines::once_in;
use super::corpus::{Corpus, Document, Files};
use super::csv_damage::damaged_csv;
use super::document::Node;
use super::number_text::edge_number;
use crate::common::random::SplitMix64;

/// The name of the experiment of a case.
const EXPERIMENT: &str = "case.experiment.json";
/// The folder with the effects of a case.
pub(crate) const EFFECTS: &str = "effects";

/// A command that examines an experiment. The experiment, its patch or its data are changed.
pub(crate) fn experiment_case(corpus: &Corpus, random: &mut SplitMix64) -> Case {
    let Document { node, mut files } = random.pick(&corpus.experiments).clone();
    let names: Vec<String> = files.keys().cloned().collect();
    if names.is_empty() || once_in(3, random) {
        files.insert(EXPERIMENT.to_owned(), changed_document(corpus, node, random).1);
    } else {
        let name = random.pick(&names);
        let changed = changed_file(corpus, name, &files[name], random);
        files.insert(name.clone(), changed);
        files.insert(EXPERIMENT.to_owned(), node.json().into_bytes());
    }
    check_case(corpus, files, random)
}

/// A command that examines a valid experiment.
pub(crate) fn plain_experiment_case(corpus: &Corpus, random: &mut SplitMix64) -> Case {
    let Document { node, mut files } = random.pick(&corpus.valid_experiments).clone();
    files.insert(EXPERIMENT.to_owned(), node.json().into_bytes());
    check_case(corpus, files, random)
}

/// A command that examines the experiment among these files.
fn check_case(corpus: &Corpus, mut files: Files, random: &mut SplitMix64) -> Case {
    let mut arguments = ["gap", EXPERIMENT, "--check", "--threads", "2"].map(str::to_owned).to_vec();
    if once_in(2, random) {
        arguments.push("--json".to_owned());
    }
    if once_in(5, random) {
        add_effects(corpus, &mut files, random);
        arguments.extend(["--effects".to_owned(), EFFECTS.to_owned()]);
    }
    if once_in(5, random) {
        arguments.extend(["--seed".to_owned(), edge_number(random)]);
    }
    Case::of(files, arguments)
}

/// A changed data file or patch of an experiment.
fn changed_file(corpus: &Corpus, name: &str, bytes: &[u8], random: &mut SplitMix64) -> Vec<u8> {
    match serde_json::from_slice::<Value>(bytes) {
        Ok(value) if name.ends_with(".json") => changed_document(corpus, Node::of(&value), random).1,
        _ => damaged_csv(bytes, random),
    }
}

/// A command that lists or describes effects.
pub(crate) fn effect_case(corpus: &Corpus, random: &mut SplitMix64) -> Case {
    let mut files = Files::new();
    add_effects(corpus, &mut files, random);
    let mut arguments = ["effects", "--effects", EFFECTS].map(str::to_owned).to_vec();
    arguments.extend(["--json", "--markdown", "own0"].get(random.below(5)).map(|word| (*word).to_owned()));
    Case::of(files, arguments)
}

/// Adds one or two changed effects.
fn add_effects(corpus: &Corpus, files: &mut Files, random: &mut SplitMix64) {
    for number in 0..=random.below(2) {
        let (_, bytes) = changed_document(corpus, random.pick(&corpus.effects).node.clone(), random);
        files.insert(format!("{EFFECTS}/own{number}.json"), bytes);
    }
}
