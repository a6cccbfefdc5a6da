//! Diagnostics about the cords into an input, for elements and for ports of macro instances.

use crate::document::{Code, Diagnostic, Placed, Span};
use crate::elements::{Input, Jacks, Kind};

/// The diagnostic for two cords into one jack or port, which would connect two outputs with each other.
///
/// `first` and `second` are the outputs, and `element` is the element or the instance that has the input.
pub(crate) fn outputs_tied(
    element: &str,
    input: &str,
    first: &Placed<String>,
    second: &Placed<String>,
) -> Diagnostic {
    let (first, second, span) = (&first.value, &second.value, second.span);
    let message = format!("the outputs of {first} and {second} are tied together at {input} of {element}");
    Diagnostic::at(Code::OUTPUTS_TIED, span, message).hint("add them in a summer, and plug in its output")
}

/// The diagnostic for an input without a cord.
///
/// `input` is the text for the input in messages, and `hint` is a [`cord_hint`].
pub(crate) fn no_cord(element: &str, input: &str, hint: String, span: Span) -> Diagnostic {
    Diagnostic::at(Code::NO_DRIVER, span, format!("no cord goes into {input} of {element}")).hint(hint)
}

/// The hint for an input without enough cords: how to write them, and the purpose of the input if it is known.
pub(crate) fn cord_hint(notation: &str, purpose: &str) -> String {
    let purpose = if purpose.is_empty() { String::new() } else { format!(" (purpose: {purpose})") };
    format!("write {notation}, with the name of an output, or \"ground\" for 0 V{purpose}")
}

/// The cords of an input as a document has them, with the word NAME for each output.
pub(crate) fn cord_notation(kind: &Kind, input: &Input) -> String {
    let (jack, cords) = match input.jacks {
        Jacks::One | Jacks::Any => (input.name.to_owned(), "\"NAME\"".to_owned()),
        Jacks::Exactly(count) => (input.name.to_owned(), format!("[{}]", vec!["\"NAME\""; count].join(", "))),
        Jacks::Gains => (format!("{}1", input.name), "[\"NAME\"]".to_owned()),
    };
    let plug = format!("\"{jack}\": {cords}");
    if kind.has_gains() { format!("\"in\": {{{plug}}}") } else { plug }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::{Family, find};

    #[test]
    fn the_notation_of_cords_depends_on_the_kind() {
        let cases = [
            ("pot", r#""in": "NAME""#),
            ("summer", r#""in": {"x1": ["NAME"]}"#),
            ("diode-lower-of", r#""in": ["NAME", "NAME"]"#),
        ];
        for (kind, expected) in cases {
            let kind = find(Family::Computing, kind).unwrap();
            assert_eq!(cord_notation(kind, &kind.inputs[0]), expected);
        }
    }
}
