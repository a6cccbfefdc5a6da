//! Commands on patches, with the files that they read.

use super::case::Case;
use super::changes::changed_document;
use super::command_lines::{PATCH, ROWS, once_in, patch_command};
use super::corpus::{Corpus, Document, Files};
use super::csv_damage::damaged_csv;
use super::document::Node;
use super::random_patch::random_patch;
use super::streams::use_streams;
use crate::common::random::SplitMix64;

/// A command on a shipped patch with changes, or on a random one.
pub(crate) fn patch_case(corpus: &Corpus, random: &mut SplitMix64) -> Case {
    let (document, bytes, files) = match random.below(10) {
        0 | 1 => {
            let document = random_patch(random);
            let bytes = document.json().into_bytes();
            (document, bytes, Files::new())
        }
        2 => changed_patch(corpus, Document { node: random_patch(random), files: Files::new() }, random),
        3 | 4 => changed_patch(corpus, random.pick(&corpus.bad_patches).clone(), random),
        5 => changed_patch(corpus, corpus.table_patch.clone(), random),
        _ => changed_patch(corpus, random.pick(&corpus.patches).clone(), random),
    };
    let mut case = command_case(&document, bytes, files, random);
    case.input = use_streams(&mut case.arguments, random);
    case
}

/// A command on a valid patch, often on one with data files.
pub(crate) fn plain_patch_case(corpus: &Corpus, random: &mut SplitMix64) -> Case {
    let document = if once_in(2, random) { &corpus.table_patch } else { random.pick(&corpus.patches) };
    let bytes = document.node.json().into_bytes();
    command_case(&document.node, bytes, document.files.clone(), random)
}

/// A command on the document of a patch. `bytes` is its text, which may be damaged.
fn command_case(document: &Node, bytes: Vec<u8>, mut files: Files, random: &mut SplitMix64) -> Case {
    let arguments = patch_command(document, random);
    if arguments.iter().any(|word| word == ROWS) {
        files.insert(ROWS.to_owned(), rows(document, random));
    }
    files.insert(PATCH.to_owned(), bytes);
    Case::of(files, arguments)
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
