//! Names of quantities, functions and units in LaTeX.
//!
//! A name of one letter is a symbol, such as $x$, and longer names are upright words. Names of elements can
//! contain any characters, so those that LaTeX treats specially are escaped.

use patchcord_expr::plain_superscript;

/// The largest number of time derivatives that dots above the symbol represent.
pub(super) const MAX_DOTS: u8 = 3;

/// The names of Greek letters that are commands of LaTeX.
const GREEK_COMMANDS: [&str; 34] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu",
    "nu", "xi", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta",
    "Theta", "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi", "Psi", "Omega",
];

/// The other Greek letters. They look like Latin letters, so LaTeX has no commands for them.
const GREEK_LOOKALIKES: [(&str, &str); 14] = [
    ("omicron", "o"),
    ("Alpha", r"\mathrm{A}"),
    ("Beta", r"\mathrm{B}"),
    ("Epsilon", r"\mathrm{E}"),
    ("Zeta", r"\mathrm{Z}"),
    ("Eta", r"\mathrm{H}"),
    ("Iota", r"\mathrm{I}"),
    ("Kappa", r"\mathrm{K}"),
    ("Mu", r"\mathrm{M}"),
    ("Nu", r"\mathrm{N}"),
    ("Omicron", r"\mathrm{O}"),
    ("Rho", r"\mathrm{P}"),
    ("Tau", r"\mathrm{T}"),
    ("Chi", r"\mathrm{X}"),
];

/// Returns a quantity with its time derivatives: `\dot{x}`, `v_{\mathrm{o}}`, `\mathrm{memory}`.
///
/// Up to [`MAX_DOTS`] derivatives are dots, and more are a number: `x^{(4)}`.
pub(super) fn quantity_latex(name: &str, primes: u8) -> String {
    let (stem, indices) = stem_and_indices(name);
    let symbol = stem_latex(stem);
    let dotted = match primes {
        1 => format!(r"\dot{{{symbol}}}"),
        2 => format!(r"\ddot{{{symbol}}}"),
        3 => format!(r"\dddot{{{symbol}}}"),
        _ => symbol,
    };
    let indices: Vec<String> = indices.into_iter().map(index_latex).collect();
    let index = if indices.is_empty() { String::new() } else { format!("_{{{}}}", indices.join(",")) };
    let order = if primes > MAX_DOTS { format!("^{{({primes})}}") } else { String::new() };
    dotted + &index + &order
}

/// Returns the name of a function.
pub(crate) fn function_latex(name: &str) -> String {
    match name {
        "min" | "max" | "sin" | "cos" | "tan" | "tanh" | "exp" | "ln" => format!(r"\{name}"),
        "atan" => r"\arctan".to_owned(),
        "log10" => r"\log_{10}".to_owned(),
        _ if is_word(name) => format!(r"\operatorname{{{}}}", escaped(name)),
        _ => format!(r"\operatorname{{{}}}", words_latex(name)),
    }
}

/// Returns a unit: `\mathrm{1/s^{2}}`, `\mathrm{N\,s/m}`.
pub(super) fn unit_latex(unit: &str) -> String {
    let mut latex = String::new();
    let mut rest = unit.trim();
    let mut follows_symbol = false;
    while let Some(letter) = rest.chars().next() {
        let power_length = if follows_symbol { unit_power_length(rest) } else { 0 };
        if power_length > 0 {
            latex += &format!("^{{{}}}", plain_power(&rest[..power_length]));
            rest = &rest[power_length..];
            follows_symbol = false;
        } else {
            latex += &unit_letter(letter);
            rest = &rest[letter.len_utf8()..];
            follows_symbol = letter.is_alphabetic() || letter == ')' || letter == '%';
        }
    }
    format!(r"\mathrm{{{latex}}}")
}

/// Returns words for the inside of a formula.
pub(super) fn words_latex(words: &str) -> String {
    format!(r"\text{{{}}}", escaped(words))
}

/// Splits a name into its stem and its indices.
///
/// An index follows the first `_`. Digits after a single letter or a Greek letter are an index as well.
fn stem_and_indices(name: &str) -> (&str, Vec<&str>) {
    let (stem, index) = match name.split_once('_') {
        Some((stem, index)) if !stem.is_empty() && !index.is_empty() => (stem, Some(index)),
        _ => (name, None),
    };
    let letters = stem.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let (stem, digits) = if is_symbol(letters) { stem.split_at(letters.len()) } else { (stem, "") };
    let digits = Some(digits).filter(|digits| !digits.is_empty());
    (stem, [digits, index].into_iter().flatten().collect())
}

/// Whether a name is a single letter or a Greek letter.
fn is_symbol(name: &str) -> bool {
    is_single_letter(name) || greek_latex(name).is_some()
}

/// Whether a name is one letter from a to z or from A to Z.
fn is_single_letter(name: &str) -> bool {
    matches!(name.as_bytes(), [letter] if letter.is_ascii_alphabetic())
}

/// Returns the stem of a name.
fn stem_latex(stem: &str) -> String {
    if is_single_letter(stem) {
        return stem.to_owned();
    }
    greek_latex(stem).unwrap_or_else(|| upright_latex(stem))
}

/// Returns an index. Its letters are upright, because they are no quantities.
fn index_latex(index: &str) -> String {
    if index.bytes().all(|letter| letter.is_ascii_digit()) {
        return index.to_owned();
    }
    greek_latex(index).unwrap_or_else(|| upright_latex(index))
}

/// Returns the sign of a Greek letter; `None` if the name is no Greek letter.
fn greek_latex(name: &str) -> Option<String> {
    if GREEK_COMMANDS.contains(&name) {
        return Some(format!(r"\{name}"));
    }
    let lookalike = GREEK_LOOKALIKES.iter().find(|(greek, _)| *greek == name);
    lookalike.map(|(_, latex)| (*latex).to_owned())
}

/// Returns a name in upright letters. Other characters than those of a word are text, because a formula would
/// space them as operators.
fn upright_latex(name: &str) -> String {
    if is_word(name) { format!(r"\mathrm{{{}}}", escaped(name)) } else { words_latex(name) }
}

/// Whether a name has only characters that look the same in a formula and in a text.
fn is_word(name: &str) -> bool {
    name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_' || letter == '.')
}

/// Escapes the characters that LaTeX treats specially.
pub(crate) fn escaped(text: &str) -> String {
    text.chars().map(escaped_letter).collect()
}

/// Returns one character as LaTeX writes it.
fn escaped_letter(letter: char) -> String {
    match letter {
        '\\' => r"\textbackslash{}".to_owned(),
        '~' => r"\textasciitilde{}".to_owned(),
        '^' => r"\textasciicircum{}".to_owned(),
        '{' | '}' | '_' | '%' | '&' | '#' | '$' => format!(r"\{letter}"),
        _ => letter.to_string(),
    }
}

/// Returns the number of bytes of the power at the beginning of a text; 0 if there is none.
fn unit_power_length(text: &str) -> usize {
    let is_power = |letter: char| {
        letter.is_ascii_digit() || matches!(letter, '^' | '-' | '.') || plain_superscript(letter).is_some()
    };
    text.find(|letter| !is_power(letter)).unwrap_or(text.len())
}

/// Returns the plain digits of the power of a unit: -2 for `^-2` and for its raised form.
fn plain_power(power: &str) -> String {
    let letters = power.chars().filter(|letter| *letter != '^');
    letters.map(|letter| plain_superscript(letter).unwrap_or(letter)).collect()
}

/// Returns a character of a unit that is not part of a power. Blanks and signs of products are thin spaces.
fn unit_letter(letter: char) -> String {
    match letter {
        '*' | '·' | '⋅' => r"\,".to_owned(),
        blank if blank.is_whitespace() => r"\,".to_owned(),
        // Both signs for micro, and both for ohm.
        '\u{b5}' | '\u{3bc}' => r"{\mu}".to_owned(),
        '\u{3a9}' | '\u{2126}' => r"{\Omega}".to_owned(),
        _ if letter.is_ascii() => escaped_letter(letter),
        _ => words_latex(&letter.to_string()),
    }
}
