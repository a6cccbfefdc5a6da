//! `patchcord new`

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::failure::Failure;
use super::files::unwritable;
use super::{say, say_json};
use patchcord::output::write_new;

#[derive(Args)]
pub(super) struct Arguments {
    /// The file to write, such as spring.json; its name becomes the title
    file: PathBuf,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// A mass on a spring; "TITLE" stands where the title goes.
const FIRST_PATCH: &str = include_str!("first_patch.json");

pub(super) fn new(arguments: &Arguments) -> Result<(), Failure> {
    let file = &arguments.file;
    write(file).map_err(|failure| failure.told_as_json(arguments.json))?;
    if arguments.json {
        return say_json(&json!({"ok": true, "files": [file.display().to_string()]}));
    }
    let [patch, drawing, picture] =
        [file.clone(), file.with_extension("schematic.svg"), file.with_extension("svg")]
            .map(|path| quoted(&path));
    say(&format!(
        "wrote {}\n\nRead its notes, then:\n  patchcord check {patch} --voltages\n  \
         patchcord draw {patch} --plot {drawing}\n  patchcord run {patch} --plot {picture}\n",
        file.display()
    ))
}

fn write(file: &Path) -> Result<(), Failure> {
    let shown = file.display();
    if file.extension().is_none_or(|ending| ending != "json") {
        return Err(Failure::usage(format!("patches are files that end in .json: call it {shown}.json")));
    }
    write_new(file, first_patch(file).as_bytes()).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            Failure::usage(format!("{shown} is there already: choose another name, or remove it first"))
        }
        _ => unwritable(file, &error),
    })
}

fn first_patch(file: &Path) -> String {
    FIRST_PATCH.replacen("\"TITLE\"", &Value::from(title(file)).to_string(), 1)
}

/// The file's name as a title: "my-first_patch.json" is "My first patch".
fn title(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().replace(['-', '_'], " ");
    let mut letters = stem.trim().chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// A path as a shell takes it.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |letter: char| letter.is_alphanumeric() || "/._-".contains(letter);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_the_names_of_files_in_words() {
        let titles = [("my-first_patch.json", "My first patch"), ("a/b.c.json", "B.c"), ("öl.json", "Öl")];
        assert!(titles.iter().all(|(file, wanted)| title(Path::new(file)) == *wanted));
    }

    #[test]
    fn names_with_spaces_are_quoted() {
        let shown = [("a/b.json", "a/b.json"), ("a b.json", "'a b.json'"), ("it's.json", r"'it'\''s.json'")];
        assert!(shown.iter().all(|(path, wanted)| quoted(Path::new(path)) == *wanted));
    }
}
