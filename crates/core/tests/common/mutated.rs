//! Randomly damaged documents.

use super::random::SplitMix64;

/// The words, numbers and punctuation characters of a JSON text.
fn tokens(text: &str) -> Vec<&str> {
    let is_punctuation = |letter: char| !(letter.is_alphanumeric() || "+-._".contains(letter));
    text.split_inclusive(is_punctuation)
        .flat_map(|chunk| {
            let punctuation = chunk.char_indices().last().filter(|(_, last)| is_punctuation(*last));
            let (word, punctuation) = chunk.split_at(punctuation.map_or(chunk.len(), |(at, _)| at));
            [word, punctuation]
        })
        .filter(|token| !token.is_empty())
        .collect()
}

/// Tokens with which a token is replaced: extreme numbers, names of jacks and kinds, unusual characters.
const REPLACEMENTS: &[&str] = &[
    "null",
    "true",
    "0",
    "-1",
    "1e308",
    "1e-308",
    "1e999",
    "NaN",
    "\"\"",
    "\"x10\"",
    "\"in\"",
    "\"A3\"",
    "A3",
    "ground",
    "µ",
    "\\",
    "\u{feff}",
    "\r\n",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "(",
    "^",
    "/",
    "summer",
    "pot",
    "multiplier",
    "diode-lower-of",
    "table",
    "[[0, 0], [1, 1e300]]",
    "unlimited",
    "N s/m",
    "kind",
];

/// The text with one token deleted, doubled, swapped with another, or replaced.
fn with_changed_token(text: &str, random: &mut SplitMix64) -> String {
    let mut tokens = tokens(text);
    let (index, other) = (random.below(tokens.len()), random.below(tokens.len()));
    match random.below(5) {
        0 => drop(tokens.remove(index)),
        1 => tokens.insert(index, tokens[index]),
        2 => tokens.swap(index, other),
        3 => tokens[index] = tokens[other],
        _ => tokens[index] = *random.pick(REPLACEMENTS),
    }
    tokens.concat()
}

/// The text with one byte deleted or replaced, or truncated at that byte.
fn with_changed_byte(text: &str, random: &mut SplitMix64) -> String {
    let mut bytes = text.as_bytes().to_vec();
    let index = random.below(bytes.len());
    match random.below(8) {
        0 => bytes.truncate(index),
        1..4 => drop(bytes.remove(index)),
        _ => bytes[index] = *random.pick(b"{}[],:\"\\ 0123456789.eE+-abxyzABS\n/*"),
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The text with one to three random changes.
pub(crate) fn mutated(text: &str, random: &mut SplitMix64) -> String {
    let changes = 1 + random.below(3);
    (0..changes).fold(text.to_owned(), |text, _| match random.below(3) {
        _ if text.is_empty() => text,
        0 => with_changed_byte(&text, random),
        _ => with_changed_token(&text, random),
    })
}
