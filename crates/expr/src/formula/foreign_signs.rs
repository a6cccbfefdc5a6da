//! Signs that people type or paste in equations: dotted letters, other primes, comparisons.

use std::ops::Range;

use super::error::FormulaError;
use super::tokens::{PRIME, is_name_letter, prefix_length};

/// Signs of several letters that are not an equals sign.
const COMPOUND_EQUALS: [&str; 3] = ["==", ":=", "=>"];

/// Signs of comparisons. The longer ones come first.
const COMPARISONS: [&str; 8] = ["<=", ">=", "!=", "<", ">", "≤", "≥", "≠"];

/// Letters that look like primes, or that put dots on the letter before them, with the order of the
/// derivative.
const OTHER_PRIMES: [(&str, usize); 3] = [("′ʹ’‘´`\u{307}", 1), ("″ʺ”“\"\u{308}", 2), ("‴\u{20db}", 3)];

/// Letters with one dot, and the same letters without it.
const ONE_DOT: (&str, &str) = ("ȧḃċḋėḟġḣṁṅȯṗṙṡṫẇẋẏżẊẎ", "abcdefghmnoprstwxyzXY");
/// Letters with two dots, and the same letters without them.
const TWO_DOTS: (&str, &str) = ("äëḧïöẗüẅẍÿẌ", "aehiotuwxyX");
/// The letters with dots that are common in words.
const LETTERS_OF_WORDS: &str = "äëïöüÿėġżċ";

/// Returns the error for a sign that equations do not have, but that people write in them.
///
/// `first` is the character at byte `start`. `None` for every other character.
pub(super) fn error(text: &str, start: usize, first: char) -> Option<FormulaError> {
    let rest = &text[start..];
    if first == PRIME {
        let end = start + prefix_length(rest, |letter| letter == PRIME);
        let message = format!("{} is not allowed here", &text[start..end]);
        return Some(FormulaError::new(start..end, message).with_hint(PRIME_HINT));
    }
    let starting = |signs: &[&'static str]| signs.iter().copied().find(|sign| rest.starts_with(sign));
    let (sign, hint) = if let Some(sign) = starting(&COMPOUND_EQUALS) {
        (sign, "write = instead".to_owned())
    } else if let Some(sign) = starting(&COMPARISONS) {
        (sign, "an equation has no conditions: use step, limit, min or max".to_owned())
    } else {
        return derivative_error(text, start, first);
    };
    let message = format!("{} is not allowed in an equation", sign.escape_debug());
    Some(FormulaError::new(start..start + sign.len(), message).with_hint(hint))
}

/// The hint for a prime that does not follow a name.
const PRIME_HINT: &str = "a prime follows the name of a quantity";

/// Returns the error for a letter that means a derivative. `None` for other letters.
fn derivative_error(text: &str, start: usize, letter: char) -> Option<FormulaError> {
    let (range, hint) = derivative_hint(text, start, letter)?;
    let message = format!("{} is not allowed in an equation", letter.escape_debug());
    Some(FormulaError::new(range, message).with_hint(hint))
}

/// Returns the hint for a letter that means a derivative: `write x'`. Its text replaces the range. `None` for other
/// letters.
fn derivative_hint(text: &str, start: usize, letter: char) -> Option<(Range<usize>, String)> {
    if order_of(letter).is_some() {
        let before = name_before(text, start);
        if before.is_empty() {
            return Some((start..start + letter.len_utf8(), PRIME_HINT.to_owned()));
        }
        let marks = &text[start..start + prefix_length(&text[start..], |mark| order_of(mark).is_some())];
        let order: usize = marks.chars().filter_map(order_of).sum();
        return Some((start - before.len()..start + marks.len(), write_derivative(before, order)));
    }
    let after = &text[start + letter.len_utf8()..];
    let is_in_word = text[..start].ends_with(char::is_alphabetic) || after.starts_with(char::is_alphabetic);
    if is_in_word && LETTERS_OF_WORDS.contains(letter) {
        return None;
    }
    let with_dots = [(ONE_DOT, 1), (TWO_DOTS, 2)];
    let (base, order) = with_dots.into_iter().find_map(|((dotted, plain), order)| {
        let index = dotted.chars().position(|known| known == letter)?;
        Some((plain.chars().nth(index)?, order))
    })?;
    let rest_of_name = &after[..prefix_length(after, is_name_letter)];
    let before = name_before(text, start);
    let range = start - before.len()..start + letter.len_utf8() + rest_of_name.len();
    // A name that ends before the letter is a factor of its own.
    let factor = if before.is_empty() { String::new() } else { format!("{before} ") };
    Some((range, write_derivative(&format!("{factor}{base}{rest_of_name}"), order)))
}

/// Returns the order of a letter that looks like a prime, or that puts dots on the letter before it. `None` for other
/// letters.
fn order_of(letter: char) -> Option<usize> {
    if letter == PRIME {
        return Some(1);
    }
    let (_, order) = OTHER_PRIMES.iter().find(|(letters, _)| letters.contains(letter))?;
    Some(*order)
}

/// Returns the hint to write a derivative with primes.
fn write_derivative(name: &str, order: usize) -> String {
    format!("write {name}{}", PRIME.to_string().repeat(order))
}

/// Returns the name that ends at byte `end`; an empty text if there is none.
fn name_before(text: &str, end: usize) -> &str {
    let before = &text[..end];
    let name = before.rfind(|letter| !is_name_letter(letter)).map_or(before, |at| {
        let width = before[at..].chars().next().map_or(0, char::len_utf8);
        &before[at + width..]
    });
    name.trim_start_matches(|letter: char| letter.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The part of the text that is at fault, the message and the hint.
    fn fault(text: &str) -> (String, String, String) {
        let found = text.char_indices().find_map(|(start, first)| error(text, start, first));
        let error = found.unwrap_or_else(|| panic!("{text} has no error"));
        (text[error.range].to_owned(), error.message, error.hint.unwrap_or_default())
    }

    #[test]
    fn letters_with_dots_and_other_primes_mean_derivatives() {
        let cases = [
            ("ẋ = v", "ẋ", "write x'"),
            ("m ẍ = F", "ẍ", "write x''"),
            ("mẍ+cẋ = F", "mẍ", "write m x''"),
            ("ẏ_1 = v", "ẏ_1", "write y_1'"),
            ("x\u{307} = v", "x\u{307}", "write x'"),
            ("2phi\u{308} = v", "phi\u{308}", "write phi''"),
            ("x’ = v", "x’", "write x'"),
            ("m x″ = F", "x″", "write x''"),
            ("m x’’ = F", "x’’", "write x''"),
            ("m x`` = F", "x``", "write x''"),
            ("m x′' = F", "x′'", "write x''"),
            ("ẍ", "ẍ", "write x''"),
            ("ü = -u", "ü", "write u''"),
            ("(a)′ = 0", "′", "a prime follows the name of a quantity"),
        ];
        for (text, part, hint) in cases {
            let (found, message, found_hint) = fault(text);
            assert_eq!((found.as_str(), found_hint.as_str()), (part, hint), "{text}");
            assert!(message.ends_with(" is not allowed in an equation"), "{message}");
        }
    }

    #[test]
    fn letters_and_their_plain_forms_are_paired() {
        for (dotted, plain) in [ONE_DOT, TWO_DOTS] {
            assert_eq!(dotted.chars().count(), plain.chars().count());
            assert!(!dotted.is_ascii() && plain.is_ascii());
        }
    }

    #[test]
    fn comparisons_and_other_signs_of_equality_get_a_hint() {
        let conditions = "an equation has no conditions: use step, limit, min or max";
        let cases = [
            ("x' == v", "==", "write = instead"),
            ("x' := v", ":=", "write = instead"),
            ("x' <= v", "<=", conditions),
            ("x' ≥ v", "≥", conditions),
        ];
        for (text, part, hint) in cases {
            // The prime of x' belongs to its name.
            let start = text.find(part).unwrap();
            let error = error(text, start, part.chars().next().unwrap()).unwrap();
            assert_eq!((&text[error.range], error.hint.as_deref()), (part, Some(hint)), "{text}");
            assert_eq!(error.message, format!("{part} is not allowed in an equation"));
        }
    }

    #[test]
    fn signs_of_equations_are_no_errors() {
        for text in ["m*x = -k^2/(a+b), 1.5", "é", "·", "−", "größe", "für"] {
            assert!(text.char_indices().all(|(start, first)| error(text, start, first).is_none()), "{text}");
        }
    }
}
