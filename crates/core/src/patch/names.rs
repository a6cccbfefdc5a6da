//! The rules for names in a patch.
//!
//! Parameters, scales and settings of macros are named in formulas. Elements, drives, signals and ports are named by
//! cords and in recorded tables. The second group may contain more characters.

use crate::document::csv_table::excerpt;
use crate::document::{Code, Diagnostic, MAX_NAME_CHARACTERS, Span, TIME_SCALE, is_name_too_long};
use crate::elements::REFERENCES;
use patchcord_expr::Callee;

/// Columns of a recorded table that are not signals. No output may have such a name.
const TABLE_COLUMNS: [&str; 3] = ["t", "run", "phase"];

/// Checks a name that formulas use. `noun` is the kind of object, such as "parameter".
///
/// A valid name consists of at most 200 ASCII letters, digits and _, and does not begin with a digit. It is not "pi",
/// the time scale or a function. `None` if the name is valid.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::Span;
/// use patchcord_core::patch::check_quantity_name;
///
/// assert_eq!(check_quantity_name("k_1", Span::default(), "parameter"), None);
/// let finding = check_quantity_name("sin", Span::default(), "parameter").expect("sin is reserved");
/// assert_eq!(finding.message, "\"sin\" cannot name a parameter");
/// ```
pub fn check_quantity_name(name: &str, span: Span, noun: &str) -> Option<Diagnostic> {
    let has_valid_start = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let has_valid_characters = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let is_reserved = name == "pi" || name == TIME_SCALE || Callee::from_name(name).is_some();
    let hint = if is_reserved {
        "the name is reserved in formulas"
    } else if !has_valid_start || !has_valid_characters {
        "use letters, digits and _, and begin with a letter"
    } else {
        return check_length(name, span, noun);
    };
    Some(invalid_name(name, span, noun, hint))
}

/// Checks a name that cords use or that can be recorded. `noun` is the kind of object, such as "element".
///
/// A valid name begins with a letter and consists of at most 200 letters, digits, _, - and dots. It is not a reference
/// ("+100") or a column of recorded tables. `None` if the name is valid.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::Span;
/// use patchcord_core::patch::check_output_name;
///
/// assert_eq!(check_output_name("L1.A-2", Span::default(), "element"), None);
/// let finding = check_output_name("+100", Span::default(), "element").expect("+100 is a reference");
/// assert_eq!(finding.message, "\"+100\" cannot name an element");
/// ```
pub fn check_output_name(name: &str, span: Span, noun: &str) -> Option<Diagnostic> {
    let has_valid_characters = name.chars().all(|c| c.is_alphanumeric() || "_-.".contains(c));
    let has_valid_start = name.starts_with(char::is_alphabetic);
    let is_reserved = TABLE_COLUMNS.contains(&name) || is_reference(name);
    let hint = if is_reserved {
        "the name is reserved"
    } else if !has_valid_start || !has_valid_characters {
        "use letters, digits, _, - and ., and begin with a letter"
    } else {
        return check_length(name, span, noun);
    };
    Some(invalid_name(name, span, noun, hint))
}

/// The diagnostic for a name with too many characters. `None` if it is short enough.
fn check_length(name: &str, span: Span, noun: &str) -> Option<Diagnostic> {
    let hint = format!("use at most {MAX_NAME_CHARACTERS} characters");
    is_name_too_long(name).then(|| invalid_name(name, span, noun, &hint))
}

/// Whether a name is that of a reference: +100, -100 or ground.
pub(crate) fn is_reference(name: &str) -> bool {
    REFERENCES.iter().any(|(reference, _)| *reference == name)
}

/// The diagnostic for an invalid name. Only the beginning of a long name is shown.
fn invalid_name(name: &str, span: Span, noun: &str, hint: &str) -> Diagnostic {
    let shown = if is_name_too_long(name) { excerpt(name) } else { name.to_owned() };
    let message = format!("\"{shown}\" cannot name {}", with_article(noun));
    Diagnostic::at(Code::BAD_NAME, span, message).hint(hint)
}

/// The diagnostic for two objects with the same name. `noun` is the kind of object at `span`, and `first_noun` is the
/// kind of the other.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::Span;
/// use patchcord_core::patch::duplicate_name;
///
/// let finding = duplicate_name("A1", Span::default(), "drive", "element");
/// assert_eq!(finding.message, "the drive A1 has the name of an element");
/// ```
pub fn duplicate_name(name: &str, span: Span, noun: &str, first_noun: &str) -> Diagnostic {
    let message = format!("the {noun} {name} has the name of {}", with_article(first_noun));
    Diagnostic::at(Code::DUPLICATE_NAME, span, message).hint("rename one of them")
}

/// A noun with "a" or "an" in front.
fn with_article(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}
