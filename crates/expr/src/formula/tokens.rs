use std::ops::Range;

use super::error::FormulaError;

/// The smallest part of a formula text.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name,
    /// One of `+ - * / ^ ( ) ,`.
    Sign(char),
    End,
}

/// A token and where it is written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placed {
    pub token: Token,
    pub range: Range<usize>,
}

/// Splits a text into tokens; the last one is the end.
pub(super) fn tokens(text: &str) -> Result<Vec<Placed>, FormulaError> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some((start, first)) = next_letter(text, at) {
        let placed = placed(text, start, first)?;
        at = placed.range.end;
        found.push(placed);
    }
    found.push(Placed { token: Token::End, range: text.len()..text.len() });
    Ok(found)
}

fn next_letter(text: &str, at: usize) -> Option<(usize, char)> {
    text[at..]
        .char_indices()
        .find(|(_, letter)| !letter.is_whitespace())
        .map(|(offset, letter)| (at + offset, letter))
}

fn placed(text: &str, start: usize, first: char) -> Result<Placed, FormulaError> {
    let (token, length) = match first {
        '0'..='9' | '.' => {
            let length = number_length(&text[start..]);
            (number(text, start..start + length)?, length)
        }
        'A'..='Z' | 'a'..='z' | '_' => (Token::Name, run(&text[start..], is_name_letter)),
        '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => (Token::Sign(first), 1),
        _ => return Err(foreign(start, first)),
    };
    Ok(Placed { token, range: start..start + length })
}

fn is_name_letter(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || letter == '_'
}

fn run(text: &str, belongs: impl Fn(char) -> bool) -> usize {
    text.find(|letter| !belongs(letter)).unwrap_or(text.len())
}

fn number_length(text: &str) -> usize {
    let mantissa = run(text, |letter| letter.is_ascii_digit() || letter == '.');
    mantissa + exponent_length(&text[mantissa..])
}

// An "e" without digits is no exponent but a name that follows the number.
fn exponent_length(text: &str) -> usize {
    let Some(after) = text.strip_prefix(['e', 'E']) else {
        return 0;
    };
    let unsigned = after.strip_prefix(['+', '-']).unwrap_or(after);
    match run(unsigned, |letter| letter.is_ascii_digit()) {
        0 => 0,
        digits => text.len() - unsigned.len() + digits,
    }
}

fn number(text: &str, range: Range<usize>) -> Result<Token, FormulaError> {
    let written = &text[range.clone()];
    match written.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Token::Number(value)),
        Ok(_) => Err(FormulaError::new(range, format!("{written} is too large"))),
        Err(_) => {
            let message = format!("{written} is not a number");
            Err(FormulaError::new(range, message).with_hint("numbers look like 1, 1.5 or 1e-3"))
        }
    }
}

fn foreign(start: usize, letter: char) -> FormulaError {
    let range = start..start + letter.len_utf8();
    let meant = match letter {
        '×' | '·' | '⋅' => Some('*'),
        '÷' | ':' => Some('/'),
        '−' | '–' => Some('-'),
        '[' | '{' => Some('('),
        ']' | '}' => Some(')'),
        _ => None,
    };
    let shown = letter.escape_debug();
    FormulaError::new(range, format!("{shown} has no meaning in a formula"))
        .with_hint_if(meant.map(|sign| format!("write {sign} instead")))
}
