//! Names that a patch does not use yet, for the parameters, instances and macros that an extended patch adds.

/// The first of stem1, stem2, ... that is not taken.
pub(crate) fn numbered_name(stem: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let names = (1..).map(|number| format!("{stem}{number}"));
    names.into_iter().find(|name| !is_taken(name)).unwrap_or_default()
}

/// The name if it is not taken, else the first of name_1, name_2, ... that is not. Formulas can contain all of these.
pub(crate) fn unused_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if is_taken(name) { numbered_name(&format!("{name}_"), is_taken) } else { name.to_owned() }
}

/// The name if it is not taken, else the first of name-2, name-3, ... that is not. It is for macros, which formulas do
/// not name.
pub(crate) fn unused_hyphenated_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if !is_taken(name) {
        return name.to_owned();
    }
    (2..).map(|number| format!("{name}-{number}")).find(|name| !is_taken(name)).unwrap_or_default()
}
