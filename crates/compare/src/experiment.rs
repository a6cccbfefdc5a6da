//! The experiment of a comparison: a document of the client, with the names of the patch and of the data.
//!
//! The text is that of an experiment file. So a user can save it, and `patchcord gap` gives the same result.

use patchcord_core::patch::Patch;
use patchcord_ident::{Experiment, GivenFiles};
use serde_json::{Map, Value};

use crate::command::NamedText;
use crate::message::experiment_message;

/// The name of the experiment in reports.
const FILE: &str = "comparison.experiment.json";

/// The name of a file without its folder.
pub(crate) fn base_name(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// The title of a patch, or the name of its file if it has none.
fn title(patch: &Patch) -> &str {
    if patch.title.is_empty() { base_name(patch.file()) } else { &patch.title }
}

/// The text of an experiment file: the document of the client with the names of the patch and of the data.
///
/// # Errors
/// The message if the document names other files.
pub(crate) fn experiment_text(
    document: &Map<String, Value>,
    patch: &Patch,
    data: &NamedText,
) -> Result<String, String> {
    if let Some(key) = ["patch", "data"].into_iter().find(|key| document.contains_key(*key)) {
        return Err(format!("the experiment of a comparison has no key \"{key}\": the opened file is used"));
    }
    let mut whole = Map::new();
    // The key comes first. A title of the client replaces this one.
    whole.insert("title".to_owned(), format!("{}, compared with {}", title(patch), data.name).into());
    whole.insert("patch".to_owned(), base_name(patch.file()).into());
    whole.insert("data".to_owned(), data.name.as_str().into());
    whole.extend(document.clone());
    Ok(format!("{:#}\n", Value::Object(whole)))
}

/// Reads an experiment with its patch and its data.
///
/// # Errors
/// The message if it has faults.
pub(crate) fn read_experiment(patch: &Patch, data: &NamedText, text: &str) -> Result<Experiment, String> {
    let files = GivenFiles { patch, data: &[(data.name.as_str(), data.text.as_str())] };
    Experiment::parse_given(&files, FILE, text).map_err(|error| experiment_message(&error))
}
