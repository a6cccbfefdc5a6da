//! Text from outside, such as file names and titles, in a form that cannot control a terminal.

/// The text with every control character as an escape sequence of JSON, such as `\u001b`.
///
/// It is for a text on one line, so a line feed becomes an escape sequence, too.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::escape_controls;
///
/// assert_eq!(escape_controls("a\u{1b}[31m.json"), "a\\u001b[31m.json");
/// assert_eq!(escape_controls("weiß µ.json"), "weiß µ.json");
/// ```
pub fn escape_controls(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter.is_control() {
            true => escaped += &format!("\\u{:04x}", u32::from(letter)),
            false => escaped.push(letter),
        }
    }
    escaped
}

/// The text with control characters as escape sequences. Line feeds stay, and tabs become spaces.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::printable;
///
/// assert_eq!(printable("a\tb\n\u{7}\n"), "a b\n\\u0007\n");
/// ```
pub fn printable(text: &str) -> String {
    let lines = text.split('\n').map(|line| escape_controls(&line.replace('\t', " ")));
    lines.collect::<Vec<_>>().join("\n")
}
