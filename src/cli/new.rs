//! `patchcord new`

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use serde_json::Value;

use super::failure::Failure;
use super::files::{path_text, path_texts, quoted};
use super::outputs::write_new_file;
use super::{print, print_json};

#[derive(Args)]
pub(super) struct Arguments {
    /// The file to write, such as spring.json; its name becomes the title
    file: PathBuf,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// The patch that is written: a mass on a spring. "TITLE" is replaced by the title.
const FIRST_PATCH: &str = include_str!("first_patch.json");

/// The result as JSON.
#[derive(Serialize)]
struct Document {
    ok: bool,
    files: Vec<String>,
}

/// Prints the commands to try next with the new patch.
pub(super) fn new(arguments: &Arguments) -> Result<(), Failure> {
    let file = &arguments.file;
    write(file)?;
    if arguments.json {
        return print_json(&Document { ok: true, files: path_texts([file]) });
    }
    let [patch, drawing, picture] =
        [file.clone(), file.with_extension("schematic.svg"), file.with_extension("svg")]
            .map(|path| quoted(&path));
    print(&format!(
        "wrote {}\n\nRead its notes, then:\n  patchcord check {patch} --voltages\n  \
         patchcord draw {patch} --plot {drawing}\n  patchcord run {patch} --plot {picture}\n",
        path_text(file)
    ))
}

/// Writes the patch. An existing file is never overwritten.
fn write(file: &Path) -> Result<(), Failure> {
    if file.extension().is_none_or(|ending| ending != "json") {
        return Err(Failure::usage(format!(
            "the name of a patch file must end in .json, such as {}.json",
            path_text(file)
        )));
    }
    write_new_file(file, first_patch(file).as_bytes())
}

/// The text of the patch for a file.
fn first_patch(file: &Path) -> String {
    FIRST_PATCH.replacen("\"TITLE\"", &Value::from(title(file)).to_string(), 1)
}

/// The title for a file name: "my-first_patch.json" gives "My first patch".
fn title(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().replace(['-', '_'], " ");
    let mut letters = stem.trim().chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_give_titles() {
        let titles = [("my-first_patch.json", "My first patch"), ("a/b.c.json", "B.c"), ("öl.json", "Öl")];
        assert!(titles.iter().all(|(file, wanted)| title(Path::new(file)) == *wanted));
    }
}
