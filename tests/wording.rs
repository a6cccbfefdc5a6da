//! The prose of the project: short sentences in the documents, and none of the words that a reader has to decode.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::docs::{documents, files_with_endings};

/// Words and phrases with a plainer equivalent, such as "report" for "tell" and "next to" for "beside". The second part
/// are metaphors. "room" is not in the list: the room of docs/lessons.md is a room. "The study" is called "the
/// thesis" everywhere.
const BANNED: [&str; 61] = [
    "told",
    "tell",
    "tells",
    "telling",
    "untold",
    "foretell",
    "foretells",
    "mistold",
    "anew",
    "goes on",
    "go on",
    "gone on",
    "going on",
    "gone through",
    "gone",
    "goes through",
    "came to",
    "comes out as",
    "held against",
    "held beside",
    "know of",
    "knows of",
    "reckon",
    "reckons",
    "reckoned",
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
    "so much",
    "such as are",
    "which is what",
    "aloft",
    "convoy",
    "convoys",
    "wing",
    "wings",
    "fence",
    "fences",
    "dust",
    "hope",
    "hopes",
    "hoped",
    "hoping",
    "promise",
    "promises",
    "promised",
    "journey",
    "journeys",
    "house",
    "houses",
    "show of",
    "shows of",
    "the study",
    "go through with",
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
        .map(|(index, part)| if index % 2 == 0 { part } else { "CODE" })
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

/// A part of a Rust source.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Token {
    /// A comment, with the signs that begin it.
    Comment,
    /// A text in quotes.
    Text,
    /// An identifier, a keyword or a number.
    Word,
    /// Any other sign, or a character in quotes.
    Sign,
}

/// The length of `source` up to the end of the first `end` from byte `from` on, or to the end of the source.
fn length_to(source: &str, from: usize, end: &str) -> usize {
    source[from..].find(end).map_or(source.len(), |at| from + at + end.len())
}

/// The length of a text in quotes at the beginning of a source. A backslash escapes the letter after it.
fn text_length(source: &str) -> usize {
    let mut is_escaped = false;
    let end = source.char_indices().skip(1).find(|(_, letter)| {
        let is_end = *letter == '"' && !is_escaped;
        is_escaped = *letter == '\\' && !is_escaped;
        is_end
    });
    end.map_or(source.len(), |(at, _)| at + 1)
}

/// The length of a character in quotes at the beginning of a source; 1 if the quote begins a lifetime.
fn character_length(source: &str) -> usize {
    let mut letters = source.char_indices().skip(1);
    match (letters.next(), letters.next()) {
        (Some((_, '\\')), Some((at, escaped))) => length_to(source, at + escaped.len_utf8(), "'"),
        (Some(_), Some((at, '\''))) => at + 1,
        _ => 1,
    }
}

/// The kind and the length of the token at the beginning of a source that is not empty.
fn token(source: &str) -> (Token, usize) {
    if source.starts_with("//") {
        return (Token::Comment, source.find('\n').unwrap_or(source.len()));
    }
    if source.starts_with("/*") {
        return (Token::Comment, length_to(source, 2, "*/"));
    }
    let word = source.find(|letter: char| !letter.is_alphanumeric() && letter != '_').unwrap_or(source.len());
    if word > 0 {
        let rest = &source[word..];
        let hashes = rest.len() - rest.trim_start_matches('#').len();
        let is_raw = ["r", "br", "cr"].contains(&&source[..word]) && rest[hashes..].starts_with('"');
        let end = format!("\"{}", "#".repeat(hashes));
        return if is_raw {
            (Token::Text, length_to(source, word + hashes + 1, &end))
        } else {
            (Token::Word, word)
        };
    }
    match source.chars().next() {
        Some('"') => (Token::Text, text_length(source)),
        Some('\'') => (Token::Sign, character_length(source)),
        letter => (Token::Sign, letter.map_or(source.len(), char::len_utf8)),
    }
}

/// The tokens of a Rust source, in order.
fn tokens(source: &str) -> Vec<(Token, &str)> {
    let (mut rest, mut found) = (source, Vec::new());
    while !rest.is_empty() {
        let (kind, length) = token(rest);
        found.push((kind, &rest[..length]));
        rest = &rest[length..];
    }
    found
}

/// The comments and messages of a Rust source, each on its line. A text without a space is a name or a key and is
/// omitted, and so is all other code.
fn prose(source: &str) -> String {
    let tokens = tokens(source).into_iter();
    tokens
        .map(|(kind, text)| match kind {
            Token::Comment => plain(text),
            Token::Text if text.contains(' ') => text.to_owned(),
            _ => " ".to_owned() + &"\n".repeat(text.matches('\n').count()),
        })
        .collect()
}

/// The parts of an identifier in lower case: "as", "it" and "were" of `as_it_were` and of `AsItWere`.
fn identifier_parts(identifier: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    for letter in identifier.chars() {
        let is_upper_after_lower =
            letter.is_uppercase() && parts.last().is_some_and(|part| part.ends_with(char::is_lowercase));
        if letter == '_' || is_upper_after_lower {
            parts.push(String::new());
        }
        if letter != '_' {
            parts.last_mut().unwrap().push(letter);
        }
    }
    parts.iter().map(|part| part.to_lowercase()).collect()
}

/// Names of fields of reports with a banned word. They are keys of JSON documents that scripts read.
const KEYS: [&str; 3] = ["beside", "gone_through", "tells"];

/// The identifiers of a Rust source with a banned word, in alphabetical order, except [`KEYS`].
fn banned_identifiers(source: &str) -> Vec<&str> {
    let words = tokens(source).into_iter().filter(|(kind, _)| *kind == Token::Word);
    let words: BTreeSet<&str> = words.map(|(_, text)| text).filter(|word| !KEYS.contains(word)).collect();
    let texts: Vec<String> = words.iter().map(|word| identifier_parts(word).join(" ")).collect();
    // Most sources have none, and one text is faster to search than many.
    if banned(&texts.join(" ")).is_empty() {
        return Vec::new();
    }
    let is_banned = |(_, text): &(&str, String)| !banned(text).is_empty();
    words.into_iter().zip(texts).filter(is_banned).map(|(word, _)| word).collect()
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
    assert_eq!(prose(r#"json["told"] = 1; // what is told"#).trim(), "// what is told");
    assert_eq!(prose(r#"print("so many words")"#).trim(), "\"so many words\"");
    assert_eq!(banned("  \"note\": \"the house of a wing\","), ["wing", "house"]);
}

#[test]
fn prose_is_found_in_all_texts_and_comments() {
    let message =
        "print(\"begins here \\\n  and is told \\\"again\\\" here\", told);\n/* a wing */ let wing = 'x';\n";
    let lines: Vec<Vec<&str>> = prose(message).lines().map(banned).collect();
    assert_eq!(lines, [vec![], vec!["told"], vec!["wing"]]);
    assert_eq!(banned(&prose("let told = r#\"a \"raw\" hope\"#; fn f<'a>(told: &'a str) {}")), ["hope"]);
    assert_eq!(banned(&prose("let signs = ['\"', '\\'', 'a']; // a fence")), ["fence"]);
    assert_eq!(banned_across("// This will go", "// on here."), ["go on"]);
    assert_eq!(banned_across("// It was", "// told."), [""; 0]);
}

#[test]
fn banned_words_are_found_in_identifiers() {
    assert_eq!(identifier_parts("GoneOnFrom"), ["gone", "on", "from"]);
    assert_eq!(
        banned_identifiers("struct UntoldWing; fn is_gone_on(tells: bool) {}"),
        ["UntoldWing", "is_gone_on"]
    );
    assert_eq!(banned_identifiers("const MOST_HOPES: usize = 3; let switching = \"told\";"), ["MOST_HOPES"]);
}

/// The banned words that begin on a line, where they may end on the next line.
fn banned_across(line: &str, next: &str) -> Vec<&'static str> {
    let both = banned(&format!("{line} {next}"));
    if both.is_empty() {
        return both;
    }
    let (on_line, on_next) = (banned(line), banned(next));
    both.into_iter().filter(|word| on_line.contains(word) || !on_next.contains(word)).collect()
}

/// The banned words in a file, each with its line. `prose` selects the prose of the file and keeps its lines.
fn faults(file: &Path, prose: impl Fn(&str) -> String) -> Vec<String> {
    // Some tables in tests are not UTF-8.
    let bytes = fs::read(file).unwrap();
    let text = prose(&String::from_utf8_lossy(&bytes));
    // Most files have none, and one text is faster to search than many lines.
    if banned(&text).is_empty() {
        return Vec::new();
    }
    let lines: Vec<&str> = text.lines().collect();
    let words = |index: usize| banned_across(lines[index], lines.get(index + 1).copied().unwrap_or_default());
    let faults = (0..lines.len()).flat_map(|index| {
        let words = words(index).into_iter();
        words.map(move |word| format!("{}:{}: {word}", file.display(), index + 1))
    });
    faults.collect()
}

/// The prose of a document: all lines, without code.
fn plain_lines(text: &str) -> String {
    text.lines().map(|line| plain(line) + "\n").collect()
}

/// The identifiers of a Rust source with banned words, and a banned word in its name.
fn faults_in_names(file: &Path) -> Vec<String> {
    let source = fs::read_to_string(file).unwrap();
    let identifiers = banned_identifiers(&source).into_iter().map(str::to_owned);
    let path = banned(&file.display().to_string().replace('_', " ")).into_iter().map(str::to_owned);
    identifiers.chain(path).map(|name| format!("{}: {name}", file.display())).collect()
}

/// The folders with sources, patches, problems and data.
const FOLDERS: [&str; 7] = ["benches", "crates", "examples", "patches", "problems", "src", "tests"];

/// Files other than Rust sources that have notes or comments. Their whole lines are read.
const ANNOTATED: [&str; 7] = ["c", "cir", "csv", "h", "json", "py", "toml"];

/// The files of [`FOLDERS`] with these endings.
fn files(endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    FOLDERS.iter().for_each(|folder| files_with_endings(Path::new(folder), endings, &mut found));
    found
}

#[test]
fn documents_and_sources_have_no_banned_words() {
    let mut found: Vec<String> =
        documents().iter().flat_map(|document| faults(document, plain_lines)).collect();
    let mut sources = files(&["rs"]);
    sources.retain(|file| !file.ends_with("tests/wording.rs"));
    found.extend(sources.iter().flat_map(|file| faults(file, prose)));
    found.extend(sources.iter().flat_map(|file| faults_in_names(file)));
    found.extend(files(&ANNOTATED).iter().flat_map(|file| faults(file, str::to_owned)));
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

/// A page with the laws of elements, whose formulas have the names of settings.
const PAGE_OF_LAWS: &str = "docs/elements.md";

/// Names with an underscore that are prose: a library of other authors.
const NAMES_IN_PROSE: [&str; 1] = ["ode_solvers"];

/// The identifiers in a paragraph that are not marked as code. A single letter with an index, such as v_o, is a symbol.
fn bare_identifiers(paragraph: &str) -> Vec<String> {
    let text = plain(paragraph);
    let words = text.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    let is_identifier = |word: &&str| {
        let mut parts = word.split('_');
        let is_long = parts.next().is_some_and(|first| first.len() > 1);
        is_long && word.contains('_') && word.split('_').all(|part| part.starts_with(char::is_alphabetic))
    };
    words.filter(is_identifier).filter(|word| !NAMES_IN_PROSE.contains(word)).map(str::to_owned).collect()
}

#[test]
fn identifiers_in_documents_are_marked_as_code() {
    assert_eq!(
        bare_identifiers("the key per_volt and `x_error`, v_o, snake_case"),
        ["per_volt", "snake_case"]
    );
    for document in documents().iter().filter(|document| !document.ends_with(PAGE_OF_LAWS)) {
        let text = fs::read_to_string(document).unwrap();
        let found: Vec<_> =
            paragraphs(&text).iter().flat_map(|paragraph| bare_identifiers(paragraph)).collect();
        assert!(found.is_empty(), "{}: {found:?} must be in backquotes", document.display());
    }
}
