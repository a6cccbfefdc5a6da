//! The prose of the project: short sentences in the documents, and none of the words that a reader has to decode.

use std::fs;
use std::path::{Path, PathBuf};

use crate::docs::{documents, sources};

/// Words and phrases with a plainer equivalent, such as "report" for "tell" and "next to" for "beside".
const BANNED: [&str; 34] = [
    "told",
    "tell",
    "tells",
    "telling",
    "untold",
    "foretell",
    "foretells",
    "anew",
    "goes on",
    "go on",
    "gone on",
    "going on",
    "gone through",
    "goes through",
    "came to",
    "comes out as",
    "held against",
    "held beside",
    "know of",
    "knows of",
    "reckon",
    "reckons",
    "whereabouts",
    "unrest",
    "promising",
    "beside",
    "besides",
    "wherein",
    "whereof",
    "as it were",
    "asked for",
    "so many",
    "aloft",
    "convoy",
];

/// Largest median and largest 90th percentile of the words per sentence of a document.
const MAX_WORDS: [usize; 2] = [15, 28];

/// A document with fewer sentences has no meaningful percentiles.
const MIN_SENTENCES: usize = 20;

/// The paragraphs of a Markdown text without headings, tables, pictures and code.
fn paragraphs(text: &str) -> Vec<String> {
    let (mut found, mut is_code, mut is_list) = (vec![String::new()], false, false);
    for line in text.lines() {
        if line.starts_with("```") {
            is_code = !is_code;
            continue;
        }
        let item = line.trim_start().strip_prefix("* ").or_else(|| line.trim_start().strip_prefix("- "));
        let is_blank = line.trim().is_empty();
        let after_blank = found.last().is_none_or(String::is_empty);
        is_list = item.is_some() || (is_list && (is_blank || line.starts_with(' ')));
        let is_indented = line.starts_with("    ") && after_blank && !is_list;
        let is_other = ["#", "|", "![", "<"].iter().any(|start| line.trim_start().starts_with(start));
        if is_code || is_blank || is_indented || is_other || item.is_some() {
            found.push(String::new());
        }
        if !(is_code || is_blank || is_indented || is_other) {
            let paragraph = found.last_mut().unwrap();
            *paragraph += item.unwrap_or(line);
            paragraph.push(' ');
        }
    }
    found.retain(|paragraph| !paragraph.is_empty());
    found
}

/// A paragraph in which code and the targets of links are replaced, so that they count as one word.
fn plain(paragraph: &str) -> String {
    let code: String = paragraph
        .split('`')
        .enumerate()
        .map(|(place, part)| if place % 2 == 0 { part } else { "CODE" })
        .collect();
    let mut links = code.split("](");
    let first = links.next().unwrap_or_default().to_owned();
    links.fold(first, |text, rest| text + rest.split_once(')').map_or("", |(_, rest)| rest))
}

/// The numbers of words of all sentences of a document, in ascending order.
fn sentence_lengths(text: &str) -> Vec<usize> {
    let mut lengths = Vec::new();
    for paragraph in paragraphs(text) {
        let mut words = 0;
        for word in plain(&paragraph).split_whitespace() {
            words += usize::from(word.contains(char::is_alphanumeric));
            let is_abbreviation = ["Fig.", "eq.", "No."].contains(&word);
            if word.trim_end_matches([')', '"', '*', ']']).ends_with(['.', ':', ';', '?', '!'])
                && !is_abbreviation
            {
                lengths.push(words);
                words = 0;
            }
        }
        lengths.extend((words > 0).then_some(words));
    }
    lengths.sort_unstable();
    lengths
}

#[test]
fn sentences_are_counted_without_code_and_tables() {
    let text = "# A long heading\n\nOne two three. Four `five six` [seven](eight.md): nine\nten.\n\n    code here\n\n| a | b |\n\n* An item.\n";
    assert_eq!(sentence_lengths(text), [2, 2, 3, 3]);
}

#[test]
fn documents_have_short_sentences() {
    for document in documents() {
        let lengths = sentence_lengths(&fs::read_to_string(&document).unwrap());
        if lengths.len() < MIN_SENTENCES {
            continue;
        }
        let percentiles = [50, 90].map(|percent| lengths[lengths.len() * percent / 100]);
        let is_short = percentiles.iter().zip(MAX_WORDS).all(|(words, most)| *words <= most);
        assert!(is_short, "{}: median and 90th percentile {percentiles:?} words", document.display());
    }
}

/// The comments and messages in a line of Rust. A text without a space is a name or a key and is left out.
fn prose(line: &str) -> String {
    let (code, comment) = line.split_once("//").unwrap_or((line, ""));
    let texts = code.split('"').skip(1).step_by(2).filter(|text| text.contains(' '));
    let comment = plain(comment);
    texts.chain([comment.as_str()]).collect::<Vec<_>>().join(" ")
}

/// The banned words in a text.
fn banned(text: &str) -> Vec<&'static str> {
    let words: String = text.chars().map(|sign| if sign.is_alphanumeric() { sign } else { ' ' }).collect();
    let words = words.split_whitespace().map(str::to_lowercase).collect::<Vec<_>>().join(" ");
    let words = format!(" {words} ");
    BANNED.into_iter().filter(|word| words.contains(&format!(" {word} "))).collect()
}

#[test]
fn banned_words_are_found_in_prose_only() {
    assert_eq!(banned("It was told, anew"), ["told", "anew"]);
    assert_eq!(banned("untoldness, retell"), [""; 0]);
    assert_eq!(prose(r#"json["told"] = 1; // what is told"#).trim(), "what is told");
    assert_eq!(prose(r#"print("so many words")"#).trim(), "so many words");
}

#[test]
fn documents_and_sources_have_no_banned_words() {
    let mut faults = Vec::new();
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for (number, line) in text.lines().enumerate() {
            let words = banned(&plain(line));
            faults.extend(words.iter().map(|word| format!("{}:{}: {word}", document.display(), number + 1)));
        }
    }
    let mut files: Vec<PathBuf> = Vec::new();
    ["crates", "src", "tests", "examples", "benches"]
        .iter()
        .for_each(|folder| sources(Path::new(folder), &mut files));
    files.retain(|file| !file.ends_with("tests/wording.rs"));
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for (number, line) in text.lines().enumerate() {
            let words = banned(&prose(line));
            faults.extend(words.iter().map(|word| format!("{}:{}: {word}", file.display(), number + 1)));
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}
