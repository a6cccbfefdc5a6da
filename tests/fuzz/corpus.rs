//! The shipped documents from which cases are made.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::document::Node;
use super::mutation::{Fragments, collect_fragments};
use crate::common::files::{json_files_in, repository_path, shipped_files, test_patch_files};

/// The contents of files, by path.
pub(crate) type Files = BTreeMap<String, Vec<u8>>;

/// A document with the files that it names.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    /// The document. It names its files without folders.
    pub node: Node,
    /// The files that it names.
    pub files: Files,
}

/// All documents.
pub(crate) struct Corpus {
    /// Valid patches.
    pub patches: Vec<Document>,
    /// Invalid patches.
    pub bad_patches: Vec<Document>,
    /// Experiments, most of them invalid.
    pub experiments: Vec<Document>,
    /// Effects.
    pub effects: Vec<Document>,
    /// The values of all documents, by key.
    pub fragments: Fragments,
    /// Whether there are cases that take seconds each: predictions for slideways.
    pub has_slow_cases: bool,
}

impl Corpus {
    /// Reads the documents.
    pub(crate) fn load(has_slow_cases: bool) -> Corpus {
        let json_files = |folder: &str| json_files_in(&repository_path(folder));
        let mut patches = documents(shipped_files());
        patches.extend(documents(test_patch_files()));
        patches.extend(documents(vec![repository_path("src/cli/first_patch.json")]));
        let mut experiments = documents(json_files("crates/ident/tests/bad"));
        experiments.extend(documents(json_files("examples/05_missing_effect")));
        experiments.retain(|document| document.node.get("outputs").is_some());
        let mut corpus = Corpus {
            patches,
            bad_patches: documents(json_files("crates/core/tests/patches/bad")),
            experiments,
            effects: documents(json_files("patches/effects")),
            fragments: Fragments::new(),
            has_slow_cases,
        };
        let Corpus { patches, bad_patches, experiments, effects, fragments, .. } = &mut corpus;
        for document in [&*patches, &*bad_patches, &*experiments, &*effects].into_iter().flatten() {
            collect_fragments(&document.node, fragments);
        }
        corpus
    }
}

/// The documents of these files. Files that are not JSON objects are left out.
fn documents(files: Vec<PathBuf>) -> Vec<Document> {
    files.iter().filter_map(|file| document(file)).collect()
}

/// The document of a file. `None` if it is not a JSON object.
fn document(file: &Path) -> Option<Document> {
    let text = fs::read_to_string(file).ok()?;
    let value = serde_json::from_str::<Value>(&text).ok().filter(Value::is_object)?;
    let (mut node, mut files) = (Node::of(&value), Files::new());
    take_files(&mut node, file.parent()?, &mut files);
    Some(Document { node, files })
}

/// Reads the files that a value names, relative to the folder of its document, and removes their folders from the
/// value.
fn take_files(node: &mut Node, folder: &Path, files: &mut Files) {
    match node {
        Node::Text(path) if path.ends_with(".csv") || path.ends_with(".json") => {
            let name = path.rsplit('/').next().unwrap_or_default().to_owned();
            if let Ok(bytes) = fs::read(folder.join(&*path)) {
                path.clone_from(&name);
                files.insert(name, bytes);
            }
        }
        Node::List(items) => items.iter_mut().for_each(|item| take_files(item, folder, files)),
        Node::Object(entries) => entries.iter_mut().for_each(|(_, value)| take_files(value, folder, files)),
        _ => (),
    }
}
