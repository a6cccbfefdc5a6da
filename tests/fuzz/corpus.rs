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

/// A valid patch whose drive and whose function generator have their points in data files.
const TABLE_PATCH: &str = r#"{
    "patchcord": 1,
    "parameters": {"k": {"value": 0.5, "unit": "1", "range": [0, 1]}},
    "scales": {"volt": {"per_volt": 1, "unit": "V"}},
    "drives": {"u": {"kind": "table", "scale": "volt", "points": {"csv": "drive.csv", "x": "t", "y": "u"}}},
    "elements": {
        "F1": {"kind": "function-generator", "in": "u", "points": {"csv": "curve.csv"}},
        "P1": {"kind": "pot", "in": "F1", "setting": "k"},
        "A1": {"kind": "integrator", "in": {"x10": ["P1"]}}
    },
    "signals": {"x": {"at": "A1", "scale": "volt"}},
    "run": {"for": 0.1, "step": 0.001}
}"#;

/// The data files of [`TABLE_PATCH`].
const TABLES: [(&str, &[u8]); 2] = [
    ("drive.csv", b"# u: V\nt,u\n0,0\n0.02,50\n0.05,-20\n0.1,10\n"),
    ("curve.csv", b"in,out\n-100,-50\n0,0\n30,60\n100,80\n"),
];

/// All documents.
pub(crate) struct Corpus {
    /// Valid patches.
    pub patches: Vec<Document>,
    /// A valid patch with data files. The shipped ones have none.
    pub table_patch: Document,
    /// Valid problems.
    pub problems: Vec<Document>,
    /// Problems, most of which have no circuit.
    pub bad_problems: Vec<Document>,
    /// Invalid patches.
    pub bad_patches: Vec<Document>,
    /// Experiments, most of them invalid.
    pub experiments: Vec<Document>,
    /// The valid ones among them.
    pub valid_experiments: Vec<Document>,
    /// Effects.
    pub effects: Vec<Document>,
    /// The values of all documents, by key.
    pub fragments: Fragments,
    /// Whether there are cases that take seconds each: predictions for slideways, figures of the thesis, and large
    /// patches.
    pub has_slow_cases: bool,
}

impl Corpus {
    /// Reads the documents.
    pub(crate) fn load(has_slow_cases: bool) -> Corpus {
        let json_files = |folder: &str| json_files_in(&repository_path(folder));
        let mut patches = documents(shipped_files());
        patches.extend(documents(test_patch_files()));
        patches.extend(documents(vec![repository_path("src/cli/first_patch.json")]));
        let experiments_in = |folder: &str| {
            let mut found = documents(json_files(folder));
            found.retain(|document| document.node.get("outputs").is_some());
            found
        };
        let valid_experiments = experiments_in("examples/05_missing_effect");
        let mut experiments = experiments_in("crates/ident/tests/bad");
        experiments.extend(valid_experiments.iter().cloned());
        let mut problems = documents(json_files("problems"));
        problems.extend(documents(json_files("crates/equations/tests/systems")));
        problems.retain(|document| document.node.get("equations").is_some());
        let mut corpus = Corpus {
            patches,
            table_patch: table_patch(),
            problems,
            bad_problems: documents(json_files("crates/equations/tests/problems")),
            bad_patches: documents(json_files("crates/core/tests/patches/bad")),
            experiments,
            valid_experiments,
            effects: documents(json_files("patches/effects")),
            fragments: Fragments::new(),
            has_slow_cases,
        };
        let Corpus { patches, problems, bad_problems, bad_patches, experiments, effects, fragments, .. } =
            &mut corpus;
        for document in [&*patches, &*problems, &*bad_problems, &*bad_patches, &*experiments, &*effects]
            .into_iter()
            .flatten()
        {
            collect_fragments(&document.node, fragments);
        }
        corpus
    }
}

/// The document of [`TABLE_PATCH`] with its data files.
fn table_patch() -> Document {
    let value: Value = serde_json::from_str(TABLE_PATCH).unwrap();
    let files = TABLES.map(|(name, bytes)| (name.to_owned(), bytes.to_vec()));
    Document { node: Node::of(&value), files: Files::from(files) }
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
