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
        "the name is reserved in formulas".to_owned()
    } else if !has_valid_start || !has_valid_characters {
        quantity_name_hint(name)
    } else {
        return check_length(name, span, noun);
    };
    Some(invalid_name(name, span, noun, &hint))
}

/// The hint for a name that formulas cannot use. A name with Greek or accented letters gets an ASCII spelling.
fn quantity_name_hint(name: &str) -> String {
    let rule = "use letters, digits and _, and begin with a letter";
    if name.is_ascii() {
        return rule.to_owned();
    }
    match ascii_spelling(name) {
        Some(spelling) => format!("formulas have the letters a to z and A to Z only: write \"{spelling}\""),
        None => format!("formulas have the letters a to z and A to Z only: {rule}"),
    }
}

/// A name with its Greek and accented letters written in ASCII: "mu" for "µ". `None` if another character is left, or
/// if the result is not a valid name.
fn ascii_spelling(name: &str) -> Option<String> {
    let spelling = name.chars().map(ascii_letter).collect::<Option<String>>()?;
    check_quantity_name(&spelling, Span::default(), "").is_none().then_some(spelling)
}

/// A letter in ASCII. `None` for a letter that [`SPELLINGS`] does not have.
fn ascii_letter(letter: char) -> Option<String> {
    if letter.is_ascii() {
        return Some(letter.to_string());
    }
    let lower_case = letter.to_lowercase().next()?;
    let (_, spelling) = SPELLINGS.iter().find(|(letters, _)| letters.contains(lower_case))?;
    let is_upper_case = letter.is_uppercase();
    let first = spelling.chars().next().filter(|_| is_upper_case);
    Some(first.map_or((*spelling).to_owned(), |first| {
        format!("{}{}", first.to_ascii_uppercase(), &spelling[first.len_utf8()..])
    }))
}

/// Letters that people use in names of quantities, and their spelling in ASCII.
const SPELLINGS: [(&str, &str); 37] = [
    ("α", "alpha"),
    ("β", "beta"),
    ("γ", "gamma"),
    ("δ", "delta"),
    ("ε", "epsilon"),
    ("ζ", "zeta"),
    ("η", "eta"),
    ("θϑ", "theta"),
    ("ι", "iota"),
    ("κ", "kappa"),
    ("λ", "lambda"),
    ("μµ", "mu"),
    ("ν", "nu"),
    ("ξ", "xi"),
    ("ο", "omicron"),
    ("ρ", "rho"),
    ("σς", "sigma"),
    ("τ", "tau"),
    ("υ", "upsilon"),
    ("φϕ", "phi"),
    ("χ", "chi"),
    ("ψ", "psi"),
    ("ω", "omega"),
    ("ä", "ae"),
    ("ö", "oe"),
    ("ü", "ue"),
    ("ß", "ss"),
    ("àáâãå", "a"),
    ("çč", "c"),
    ("èéêë", "e"),
    ("ìíîï", "i"),
    ("ñ", "n"),
    ("òóôõø", "o"),
    ("ùúû", "u"),
    ("ýÿ", "y"),
    ("₀", "_0"),
    ("₁", "_1"),
];

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greek_and_accented_letters_get_an_ascii_spelling() {
        let cases = [
            ("µ", Some("mu")),
            ("ω_0", Some("omega_0")),
            ("Δx", Some("Deltax")),
            ("größe", Some("groesse")),
            ("Öl", Some("Oel")),
            ("v₀", Some("v_0")),
            ("π", None),
            ("力", None),
            ("1µ", None),
            ("µ s", None),
        ];
        for (name, expected) in cases {
            assert_eq!(ascii_spelling(name).as_deref(), expected, "{name}");
        }
    }

    #[test]
    fn the_hint_for_a_name_gives_the_spelling() {
        let hint =
            |name: &str| check_quantity_name(name, Span::default(), "parameter").unwrap().hint.unwrap();
        assert_eq!(hint("µ"), "formulas have the letters a to z and A to Z only: write \"mu\"");
        assert!(hint("力").ends_with("only: use letters, digits and _, and begin with a letter"));
        assert_eq!(hint("F s"), "use letters, digits and _, and begin with a letter");
        assert_eq!(hint("sin"), "the name is reserved in formulas");
    }
}
