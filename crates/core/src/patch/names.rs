//! What may name a thing of a patch.

use crate::document::{Code, Diagnostic, Span, TIME_SCALE};
use crate::elements::REFERENCES;
use patchcord_expr::Callee;

/// Columns of the recorded table that are no signals.
const COLUMNS: [&str; 3] = ["t", "run", "phase"];

/// What is wrong with the name of something that formulas name.
pub fn quantity_name(name: &str, span: Span, noun: &str) -> Option<Diagnostic> {
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let reserved = name == "pi" || name == TIME_SCALE || Callee::named(name).is_some();
    let hint = if reserved {
        "the name has a meaning of its own in formulas"
    } else {
        "formulas read letters, digits and _, a letter first"
    };
    (!starts || !plain || reserved).then(|| bad_name(name, span, noun, hint))
}

/// What is wrong with the name of something that cords name or that can be recorded.
pub fn outlet_name(name: &str, span: Span, noun: &str) -> Option<Diagnostic> {
    let plain = name.chars().all(|c| c.is_alphanumeric() || "_-.".contains(c));
    let starts = name.starts_with(char::is_alphabetic);
    let reserved = COLUMNS.contains(&name) || is_reference(name);
    let hint = if reserved {
        "the machine uses this name itself"
    } else {
        "use letters, digits, _ - . and a letter first"
    };
    (!starts || !plain || reserved).then(|| bad_name(name, span, noun, hint))
}

/// Whether a name is that of +100, -100 or ground.
pub(crate) fn is_reference(name: &str) -> bool {
    REFERENCES.iter().any(|(reference, _)| *reference == name)
}

fn bad_name(name: &str, span: Span, noun: &str, hint: &str) -> Diagnostic {
    let message = format!("\"{name}\" cannot name {}", with_article(noun));
    Diagnostic::at(Code::BadName, span, message).hint(hint)
}

/// Two things of one name.
pub fn same_name(name: &str, span: Span, noun: &str, first: &str) -> Diagnostic {
    let message = format!("the {noun} {name} has the name of {}", with_article(first));
    Diagnostic::at(Code::DuplicateName, span, message).hint("rename one of them")
}

fn with_article(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}
