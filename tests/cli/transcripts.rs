//! Pages with commands, their outputs and files: the commands run in order, and the page shows what they print now.
//!
//! A command is an indented line that begins with `patchcord`. If a fenced block follows it, the block is its output. A
//! comment `<!-- file NAME -->` before a block says that the reader saves the block as this file. With `<!-- written NAME -->`
//! the block is a file that a command has written.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

use super::{code, errors, out, without_elapsed_time};

/// What a fenced block of a page contains.
enum Block {
    /// The output of a command.
    Output(String),
    /// A file that the reader saves under this name.
    Saved(String),
    /// A file with this name that a command has written.
    Written(String),
}

/// A folder in which the commands of a page run. It has the shipped problems.
pub(super) fn folder_with_problems() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("problems")).unwrap();
    for path in fs::read_dir("problems").unwrap().map(|entry| entry.unwrap().path()) {
        fs::copy(&path, folder.path().join(&path)).unwrap();
    }
    folder
}

/// The output of a command in a folder. The command succeeds and prints no warning.
pub(super) fn printed(command: &str, folder: &Path) -> String {
    let mut process = Command::new(env!("CARGO_BIN_EXE_patchcord"));
    let process = process.env("PATCHCORD_PROGRESS", "0").args(command.split_whitespace()).current_dir(folder);
    let ran = process.output().unwrap();
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""), "{command}");
    out(&ran)
}

/// A page with the present outputs of its commands, which run in this folder.
pub(super) fn refreshed(page: &str, folder: &Path) -> String {
    let mut fresh = String::new();
    let mut next: Option<Block> = None;
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        fresh += &format!("{line}\n");
        if line.starts_with("```") {
            let quoted = lines.by_ref().take_while(|line| *line != "```").map(|line| line.to_owned() + "\n");
            fresh += &content(quoted.collect(), next.take(), folder);
            fresh += "```\n";
        } else if !line.is_empty() {
            next = block_after(line, folder);
        }
    }
    fresh
}

/// What a block directly after this line contains. `None` if the block is neither an output nor a file.
fn block_after(line: &str, folder: &Path) -> Option<Block> {
    if let Some(command) = line.strip_prefix("    patchcord ") {
        return Some(Block::Output(printed(command, folder)));
    }
    let name = |mark: &str| line.strip_prefix(mark)?.strip_suffix(" -->").map(str::to_owned);
    name("<!-- file ").map(Block::Saved).or_else(|| name("<!-- written ").map(Block::Written))
}

/// The present content of a block. An output that differs only in the time that a run took stays as it is.
fn content(quoted: String, block: Option<Block>, folder: &Path) -> String {
    match block {
        Some(Block::Output(output)) if without_elapsed_times(&output) == without_elapsed_times(&quoted) => {
            quoted
        }
        Some(Block::Output(output)) => output,
        Some(Block::Saved(name)) => {
            fs::write(folder.join(name), &quoted).unwrap();
            quoted
        }
        Some(Block::Written(name)) => fs::read_to_string(folder.join(name)).unwrap(),
        None => quoted,
    }
}

/// The lines of an output without the times that runs took.
fn without_elapsed_times(output: &str) -> Vec<String> {
    output.lines().map(without_elapsed_time).collect()
}

#[test]
fn blocks_of_a_page_are_replaced_by_outputs() {
    let folder = tempfile::tempdir().unwrap();
    let page = "Text.\n\n<!-- file a.json -->\n```json\n{}\n```\n\n    patchcord --version\n\n```text\nold\n```\n\nOther.\n\n```text\nkept\n```\n\n<!-- written a.json -->\n```json\n```\n";
    let version = printed("--version", folder.path());
    let expected = page.replace("old\n", &version).replace("-->\n```json\n```", "-->\n```json\n{}\n```");
    assert_eq!(refreshed(page, folder.path()), expected);
}
