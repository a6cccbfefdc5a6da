//! Splits the text of a formula into tokens.
//!
//! A number is `1`, `.5`, `2.` or `1e-3`. A name consists of ASCII letters, digits and `_`, and does
//! not begin with a digit. Dots belong to numbers only, so a name such as `L1.T` cannot be written in
//! a formula; only the expansion of macros makes such names. In an equation the primes after a name
//! belong to its token, and `=` is a sign.

use std::ops::Range;

use super::error::FormulaError;
use super::foreign_signs;
use super::language::Language;

/// The sign after the name of a quantity that means a derivative with respect to time.
pub(super) const PRIME: char = '\'';

/// The kind of a token, with the value of a number.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum TokenKind {
    /// A finite, unsigned number.
    Number(f64),
    /// A name, the name of a function, or `pi`. In an equation the name may end in primes.
    Name,
    /// One of `+ - * / ^ ( ) ,`, and in an equation also `=`.
    Sign(char),
    /// The end of the text.
    End,
}

/// A token and the bytes of the text that it covers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Token {
    /// The kind, with the value of a number.
    pub kind: TokenKind,
    /// The bytes of the token. The range of the end is empty, at the end of the text.
    pub range: Range<usize>,
}

/// Splits a text into tokens. Blanks are skipped, and the last token is [`TokenKind::End`].
pub(super) fn tokenize(text: &str, language: Language) -> Result<Vec<Token>, FormulaError> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some((start, first)) = next_letter(text, at) {
        let token = token_at(text, start, first, language)?;
        at = token.range.end;
        found.push(token);
    }
    found.push(Token { kind: TokenKind::End, range: text.len()..text.len() });
    Ok(found)
}

/// Returns the first character from byte `at` that is not blank, and its position.
fn next_letter(text: &str, at: usize) -> Option<(usize, char)> {
    text[at..]
        .char_indices()
        .find(|(_, letter)| !letter.is_whitespace())
        .map(|(offset, letter)| (at + offset, letter))
}

/// Reads the token that begins at byte `start` with the character `first`.
fn token_at(text: &str, start: usize, first: char, language: Language) -> Result<Token, FormulaError> {
    let is_equation = language == Language::Equation;
    if is_equation && let Some(error) = foreign_signs::error(text, start, first) {
        return Err(error);
    }
    let (kind, length) = match first {
        '0'..='9' | '.' => {
            let length = number_length(&text[start..]);
            (number(text, start..start + length)?, length)
        }
        'A'..='Z' | 'a'..='z' | '_' => (TokenKind::Name, name_length(&text[start..], is_equation)),
        '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => (TokenKind::Sign(first), 1),
        '=' if is_equation => (TokenKind::Sign(first), 1),
        _ => return Err(unexpected_character(start, first, language)),
    };
    Ok(Token { kind, range: start..start + length })
}

/// Whether a character can be part of a name after its first character.
pub(super) fn is_name_letter(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || letter == '_'
}

/// Returns the number of bytes of the name at the beginning of a text. In an equation the primes after
/// the name count.
fn name_length(text: &str, is_equation: bool) -> usize {
    let letters = prefix_length(text, is_name_letter);
    if is_equation { letters + prefix_length(&text[letters..], |letter| letter == PRIME) } else { letters }
}

/// Returns the number of leading bytes whose characters all satisfy `belongs`.
pub(super) fn prefix_length(text: &str, belongs: impl Fn(char) -> bool) -> usize {
    text.find(|letter| !belongs(letter)).unwrap_or(text.len())
}

/// Returns the number of bytes of the number at the beginning of a text: digits, dots and an exponent.
fn number_length(text: &str) -> usize {
    let mantissa = prefix_length(text, |letter| letter.is_ascii_digit() || letter == '.');
    mantissa + exponent_length(&text[mantissa..])
}

/// Returns the length in bytes of the exponent at the beginning of a text; 0 if there is none.
///
/// An "e" without digits is the start of a name, not an exponent: "2e" is "2" and "e".
fn exponent_length(text: &str) -> usize {
    let Some(after) = text.strip_prefix(['e', 'E']) else {
        return 0;
    };
    let unsigned = after.strip_prefix(['+', '-']).unwrap_or(after);
    match prefix_length(unsigned, |letter| letter.is_ascii_digit()) {
        0 => 0,
        digits => text.len() - unsigned.len() + digits,
    }
}

/// Parses a number. Several dots, and values above the range of an `f64`, are errors.
fn number(text: &str, range: Range<usize>) -> Result<TokenKind, FormulaError> {
    let written = &text[range.clone()];
    match written.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(TokenKind::Number(value)),
        Ok(_) => Err(FormulaError::new(range, format!("{written} is too large"))),
        Err(_) => {
            let message = format!("{written} is not a number");
            Err(FormulaError::new(range, message).with_hint("numbers look like 1, 1.5 or 1e-3"))
        }
    }
}

/// Returns the error for a character that no token starts with, with the ASCII sign or the rule for names
/// as hint.
fn unexpected_character(start: usize, letter: char, language: Language) -> FormulaError {
    let range = start..start + letter.len_utf8();
    let hint = match letter {
        '×' | '·' | '⋅' => Some("write * instead"),
        '÷' | ':' => Some("write / instead"),
        '−' | '–' => Some("write - instead"),
        '[' | '{' => Some("write ( instead"),
        ']' | '}' => Some("write ) instead"),
        '²' => Some("write ^2 instead"),
        '³' => Some("write ^3 instead"),
        'π' => Some("write pi instead"),
        '√' => Some("write sqrt( ... ) instead"),
        '|' => Some("write abs( ... ) for a magnitude"),
        '\\' => Some("write plain text in place of LaTeX: a / b, sqrt(a), and x' for a derivative"),
        ';' if language == Language::Equation => Some("write a list with a text for each equation"),
        _ if letter.is_alphabetic() => Some("names consist of the letters a to z and A to Z, digits and _"),
        _ => None,
    };
    let shown = letter.escape_debug();
    FormulaError::new(range, format!("{shown} is not allowed in {}", language.noun()))
        .with_hint_if(hint.map(str::to_owned))
}
