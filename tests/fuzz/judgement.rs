//! The rules that every answer of the command obeys.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::case::{Case, words};
use super::command_lines::{SWEEP, TABLE};
use super::problem_case::SCALED;
use super::runner::Answer;
use super::streams::{StandardOutput, prints_table};
use patchcord::{Circuit, Patch, Program};

/// The sentence with which a run that stops says that its files are complete up to an instant.
const STOPPED: &str = "the files contain the run up to";

/// The last bytes of a complete PNG file: the chunk IEND with its checksum.
const END_OF_PNG: &[u8] = b"IEND\xaeB`\x82";

/// The broken rules of an answer and of the files that it left in the folder of the case.
pub(crate) fn violations(case: &Case, folder: &Path, answer: &Answer) -> Vec<String> {
    if let Some(limit) = answer.broken_limit {
        return vec![limit.violation()];
    }
    let mut found = answer_violations(case, answer);
    let replaced = case.specials.iter().filter(|(name, special)| !special.is_kept(&folder.join(name)));
    found.extend(replaced.map(|(name, _)| format!("{name} is replaced")));
    let mut written = Vec::new();
    list_files(folder, folder, &mut written);
    let has_table = case.specials.contains_key(SWEEP) || written.iter().any(|(name, _)| name == SWEEP);
    if answer.code == Some(0) && case.arguments.iter().any(|word| word == SWEEP) && !has_table {
        found.push("does not write its table".to_owned());
    }
    for (name, bytes) in written {
        found.extend(file_violation(case, &name, &bytes, answer).map(|what| format!("{name} {what}")));
    }
    found
}

/// The broken rules of exit code, standard output and standard error.
pub(crate) fn answer_violations(case: &Case, answer: &Answer) -> Vec<String> {
    let errors = String::from_utf8_lossy(&answer.errors);
    let is_success = answer.code == Some(0);
    let is_kept = case.output == StandardOutput::Kept;
    let has_json = is_kept && case.arguments.iter().any(|word| word == "--json");
    let is_document = || serde_json::from_slice::<Value>(&answer.output).is_ok();
    let rules = [
        (answer.code.is_some(), "is ended by a signal"),
        (!errors.contains("panicked at") && answer.code != Some(101), "panics"),
        (!errors.contains("memory allocation of"), "needs more than 1 GB"),
        (answer.code.is_none_or(|code| (0..4).contains(&code) || code == 101), "has an unknown exit code"),
        (is_success || !errors.trim().is_empty(), "has an error without a message"),
        (!is_success || case.output != StandardOutput::Full, "does not report that its output is lost"),
        (!has_json || is_document(), "does not print a JSON document"),
    ];
    let broken = rules.into_iter().filter(|(is_obeyed, _)| !is_obeyed).map(|(_, what)| what.to_owned());
    broken.chain(if is_kept { output_violation(case, answer) } else { None }).collect()
}

/// The broken rule of standard output. A table may be missing after an error.
fn output_violation(case: &Case, answer: &Answer) -> Option<String> {
    let (is_success, text) = (answer.code == Some(0), String::from_utf8_lossy(&answer.output));
    if prints_table(&case.arguments) {
        let fault = content_violation(TABLE, &answer.output).filter(|_| is_success || !text.is_empty());
        return fault.map(|what| format!("standard output {what}"));
    }
    let is_infinite = is_success && infinite_words(&text).any(|word| !case.mentions(word));
    is_infinite.then(|| "prints a number that is not finite".to_owned())
}

/// The names and the contents of all regular files in a folder, with names relative to `root`. Links are not followed,
/// because they may lead to devices.
fn list_files(root: &Path, folder: &Path, found: &mut Vec<(String, Vec<u8>)>) {
    for entry in fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok) {
        let (path, Ok(file_type)) = (entry.path(), entry.file_type()) else { continue };
        if file_type.is_dir() {
            list_files(root, &path, found);
        } else if file_type.is_file()
            && let Ok(bytes) = fs::read(&path)
        {
            found.push((path.strip_prefix(root).unwrap_or(&path).display().to_string(), bytes));
        }
    }
}

/// The broken rule of a file after the command. A table of a sweep grows, so it may exist after an error.
fn file_violation(case: &Case, name: &str, bytes: &[u8], answer: &Answer) -> Option<&'static str> {
    if let Some(before) = case.files.get(name) {
        return (bytes != before).then_some("is an input that was changed");
    }
    let is_error = matches!(answer.code, Some(1 | 2));
    let says_so = || String::from_utf8_lossy(&answer.errors).contains(STOPPED);
    if name.ends_with(".tmp") {
        return Some("is a temporary file that was left");
    }
    if is_error && name != SWEEP && !case.may_lose_output() && !says_so() {
        return Some("was written in spite of an error");
    }
    if name == SCALED && !is_valid_patch(bytes) {
        return Some("is not a valid patch");
    }
    content_violation(name, bytes)
}

/// Whether a file is a patch with a circuit and a program, on a machine that has all parts.
fn is_valid_patch(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let circuit = Patch::parse(SCALED, &text).and_then(|mut patch| {
        patch.machine = None;
        Circuit::new(&patch)
    });
    circuit.is_ok_and(|circuit| Program::new(&circuit).is_ok())
}

/// The broken rule of the content of a file: it is incomplete, or has a number that is not finite.
pub(crate) fn content_violation(name: &str, bytes: &[u8]) -> Option<&'static str> {
    let text = String::from_utf8_lossy(bytes);
    match name.rsplit('.').next().unwrap_or_default() {
        "csv" if !text.ends_with('\n') => Some("has an incomplete line"),
        "csv" if has_infinite_cell(&text) => Some("has a number that is not finite"),
        "svg" => picture_violation(&text),
        "png" if !bytes.ends_with(END_OF_PNG) => Some("is not a complete picture"),
        "json" if serde_json::from_slice::<Value>(bytes).is_err() => Some("is not a JSON document"),
        _ => None,
    }
}

/// The broken rule of a picture in SVG.
fn picture_violation(text: &str) -> Option<&'static str> {
    let Ok(picture) = roxmltree::Document::parse(text) else { return Some("is not a complete picture") };
    let mut attributes = picture.descendants().flat_map(|node| node.attributes());
    let has_infinite = attributes.any(|attribute| infinite_words(attribute.value()).next().is_some());
    has_infinite.then_some("has a number that is not finite")
}

/// The words of a text that stand for numbers that are not finite.
fn infinite_words(text: &str) -> impl Iterator<Item = &str> {
    words(text).filter(|word| ["NaN", "inf"].contains(word))
}

/// Whether a cell below the line of names is not a finite number.
fn has_infinite_cell(text: &str) -> bool {
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let is_infinite = |cell: &str| {
        let word = cell.trim_matches(['"', ' ', '+', '-']).to_lowercase();
        ["nan", "inf", "infinity"].contains(&word.as_str())
    };
    rows.flat_map(|row| row.split(',')).any(is_infinite)
}
