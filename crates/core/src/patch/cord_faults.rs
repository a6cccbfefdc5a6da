//! Faults of the cords into an input: inputs with too few cords, and the diagnostics for elements and for ports of macro
//! instances.

use super::document::ElementEntry;
use crate::document::tree::{Content, KeyValue, Node};
use crate::document::{Code, Diagnostic, Placed, Span, TypedNumber, format_number, is_allowed_factor};
use crate::elements::{Input, Jacks, Kind, REFERENCES, misplaced_key_hint};
use crate::machines::REFERENCE;
use patchcord_expr::Unit;

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

/// An input of an element with fewer cords than it needs.
pub(crate) struct OpenInput<'e> {
    /// The index of the input among those of the kind.
    pub input: usize,
    /// The number of cords that it has.
    pub count: usize,
    /// The number of cords that it needs.
    pub least: usize,
    /// The first of its cords.
    pub first_cord: Option<&'e Placed<String>>,
    /// Its jack with an empty list of cords, with the position of the list.
    pub empty_jack: Option<&'e Placed<String>>,
}

/// The inputs of an element with fewer cords than they need.
///
/// An input that may be open needs no cord, but an empty list of cords is a fault: the user wrote the jack. If a jack or
/// a cord is wrong, no input counts as open: the wrong cord may be meant for it.
pub(crate) fn open_inputs(entry: &ElementEntry) -> Vec<OpenInput<'_>> {
    let input_of = |jack: &Placed<String>| entry.kind.input(&jack.value).map(|(input, _)| input);
    let plugged: Option<Vec<_>> = entry.plugs.iter().map(|plug| input_of(&plug.jack)).collect();
    let empty: Option<Vec<_>> = entry.empty_jacks.iter().map(input_of).collect();
    let (Some(plugged), Some(empty), false) = (plugged, empty, entry.is_incomplete) else {
        return Vec::new();
    };
    let open_input = |(input, row): (usize, &Input)| {
        let least = if let Jacks::Exactly(count) = row.jacks { count } else { 1 };
        let count = plugged.iter().filter(|other| **other == input).count();
        let first_cord = plugged.iter().position(|other| *other == input);
        let empty_jack = empty.iter().rposition(|other| *other == input);
        let is_open = (row.required || empty_jack.is_some()) && count < least;
        is_open.then(|| OpenInput {
            input,
            count,
            least,
            first_cord: first_cord.map(|cord| &entry.plugs[cord].from),
            empty_jack: empty_jack.map(|jack| &entry.empty_jacks[jack]),
        })
    };
    entry.kind.inputs.iter().enumerate().filter_map(open_input).collect()
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

/// The diagnostic for a value at an input that is not the name of an output. A number is meant as a constant voltage.
pub(super) fn not_a_name(node: &Node, input: &str) -> Diagnostic {
    let message = format!("\"{input}\" takes the names of outputs, not {}", node.value.noun());
    let hint = match &node.value {
        Content::Number(number) => number.parse().ok().map(constant_hint),
        _ => None,
    };
    let hint = hint.unwrap_or_else(|| "write the name of an output in quotes, or a list of names".to_owned());
    Diagnostic::at(Code::WRONG_TYPE, node.span, message).hint(hint)
}

/// The diagnostic for a number at a key of "in" that is no input: a source with its gain, or a key that belongs next to
/// "in". `None` for other values, and for an input.
pub(super) fn number_at_unknown_jack(kind: &Kind, jack: &KeyValue) -> Option<Diagnostic> {
    let number = match &jack.value.value {
        Content::Number(number) => number,
        Content::List(items) => match items.as_slice() {
            [Node { value: Content::Number(number), .. }] => number,
            _ => return None,
        },
        _ => return None,
    };
    let written = jack.key.as_str();
    let is_jack = kind.input(written).is_some() || kind.similar_jack(written).is_some();
    if is_jack || !kind.has_gains() {
        return None;
    }
    let message =
        format!("the {} has no input \"{written}\", and {number} is not the name of an output", kind.name);
    let hint = misplaced_key_hint(kind, written).unwrap_or_else(|| exchanged_gain_hint(written, number));
    Some(Diagnostic::at(Code::UNKNOWN_INPUT, jack.key_span, message).hint(hint))
}

/// The hint for a source and its gain that are exchanged: `"P1": 10` for `"x10": ["P1"]`. A gain outside the limits is
/// not repeated: no input has it.
fn exchanged_gain_hint(source: &str, gain: &str) -> String {
    match gain.parse::<f64>() {
        Ok(gain) if is_allowed_factor(gain) => format!("write \"x{gain}\": [\"{source}\"]"),
        Ok(gain) if is_allowed_factor(-gain) => format!(
            "a gain is positive, and the output is inverted: write \"x{}\": [\"{source}\"], or put an \"inverter\" in \
             front",
            -gain
        ),
        _ => format!("the gain is in the name of an input, such as \"x10\": [\"{source}\"]"),
    }
}

/// The hint for a constant voltage in volts: the reference, or a pot at a reference.
fn constant_hint(volts: f64) -> String {
    let text = format_number(volts);
    if let Some((reference, _)) = REFERENCES.iter().find(|(_, known)| *known == volts) {
        return format!("write \"{reference}\" for {text} V");
    }
    let reference = if volts > 0.0 { "+100" } else { "-100" };
    let setting = volts.abs() / REFERENCE;
    match setting <= 1.0 {
        true => format!(
            "for {text} V, write the name of a \"pot\" with \"in\": \"{reference}\" and \"setting\": {}",
            format_number(setting)
        ),
        false => format!("a constant voltage is a \"pot\" with \"in\": \"{reference}\", and at most 100 V"),
    }
}

/// Names of a fixed voltage in circuit diagrams and other programs, in lower case, and the hint about each.
const VOLTAGE_NAMES: [(&[&str], &str); 4] = [
    (
        &["ground", "gnd", "agnd", "sgnd", "earth", "common", "zero", "null"],
        "did you mean \"ground\", which is 0 V?",
    ),
    (&["+ref", "ref+", "vref", "+vref", "vref+"], "did you mean \"+100\", the positive reference?"),
    (&["-ref", "ref-", "-vref", "vref-"], "did you mean \"-100\", the negative reference?"),
    // The supplies of amplifiers have other voltages than the references, so no single one is suggested.
    (
        &["ref", "reference", "vcc", "+vcc", "-vcc", "vdd", "vee", "vss", "supply", "constant"],
        "the fixed voltages are \"+100\", \"-100\" and \"ground\"; a \"pot\" gives a share of one",
    ),
];

/// The hint for a cord from an unknown name that means a fixed voltage: another name of a reference, or a voltage such
/// as "+100V" or "5". `None` for other names, and for one that differs from an output only in its capitals, because it
/// means that output.
pub(crate) fn fixed_voltage_hint<'n>(
    name: &str,
    outputs: impl IntoIterator<Item = &'n str>,
) -> Option<String> {
    let hint = match voltage(name) {
        Some(volts) => constant_hint(volts),
        None => {
            let name = name.trim().to_lowercase();
            let (_, hint) = VOLTAGE_NAMES.iter().find(|(names, _)| names.contains(&name.as_str()))?;
            (*hint).to_owned()
        }
    };
    let is_output = outputs.into_iter().any(|output| output.eq_ignore_ascii_case(name));
    (!is_output).then_some(hint)
}

/// The voltage that a text specifies, in volts: a number alone or with a unit. `None` for other texts.
fn voltage(text: &str) -> Option<f64> {
    let volt = Unit::parse("V").ok()?;
    TypedNumber::parse(text).ok()?.in_unit(&volt).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::tree::parse;
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

    #[test]
    fn a_number_at_an_input_is_a_constant_voltage() {
        let pot = |volts: &str, reference: &str, setting: &str| {
            let keys = format!("\"in\": \"{reference}\" and \"setting\": {setting}");
            format!("for {volts} V, write the name of a \"pot\" with {keys}")
        };
        let too_large = "a constant voltage is a \"pot\" with \"in\": \"+100\", and at most 100 V";
        let cases = [
            ("5", pot("5", "+100", "0.05")),
            ("-20.5", pot("-20.5", "-100", "0.205")),
            ("100", "write \"+100\" for 100 V".to_owned()),
            ("-1e2", "write \"-100\" for -100 V".to_owned()),
            ("-0", "write \"ground\" for 0 V".to_owned()),
            ("250", too_large.to_owned()),
            ("1e999", too_large.to_owned()),
        ];
        for (number, expected) in cases {
            let finding = not_a_name(&parse(number).unwrap(), "x10");
            assert_eq!(finding.message, "\"x10\" takes the names of outputs, not a number");
            assert_eq!(finding.hint, Some(expected), "{number}");
        }
        let finding = not_a_name(&parse("null").unwrap(), "in");
        assert_eq!(finding.message, "\"in\" takes the names of outputs, not null");
    }

    #[test]
    fn a_number_at_an_unknown_jack_is_a_gain_or_a_setting() {
        let finding = |kind: &str, inputs: &str| {
            let Content::Object(entries) = parse(inputs).unwrap().value else { panic!("{inputs}") };
            number_at_unknown_jack(find(Family::Computing, kind).unwrap(), &entries[0])
        };
        let found = finding("integrator", r#"{"P1": 10}"#).unwrap();
        let message = "the integrator has no input \"P1\", and 10 is not the name of an output";
        assert_eq!((found.code, found.message.as_str()), (Code::UNKNOWN_INPUT, message));
        let inverted = "a gain is positive, and the output is inverted: write \"x2.5\": [\"A1\"], or put an \
                        \"inverter\" in front";
        let cases = [
            (r#"{"P1": 10}"#, "write \"x10\": [\"P1\"]"),
            (r#"{"P1": [0.5]}"#, "write \"x0.5\": [\"P1\"]"),
            (r#"{"A1": -2.5}"#, inverted),
            (r#"{"A1": 0}"#, "the gain is in the name of an input, such as \"x10\": [\"A1\"]"),
            (r#"{"P1": 1e12}"#, "write \"x1000000000000\": [\"P1\"]"),
            (r#"{"A1": 1e300}"#, "the gain is in the name of an input, such as \"x10\": [\"A1\"]"),
            (r#"{"A1": -1e300}"#, "the gain is in the name of an input, such as \"x10\": [\"A1\"]"),
            (r#"{"A1": 1e-13}"#, "the gain is in the name of an input, such as \"x10\": [\"A1\"]"),
            (r#"{"initial": 5}"#, "write \"initial\" next to \"in\", not in it"),
            (r#"{"min": -5}"#, "write \"limit\": {\"lower\": -10}, in volts, next to \"in\""),
        ];
        for (inputs, expected) in cases {
            let hint = finding("integrator", inputs).unwrap().hint;
            assert_eq!(hint.as_deref(), Some(expected), "{inputs}");
        }
        for inputs in [r#"{"x1": 5}"#, r#"{"10": 5}"#, r#"{"P1": "A1"}"#, r#"{"P1": [1, 2]}"#] {
            assert_eq!(finding("integrator", inputs), None, "{inputs}");
        }
        assert_eq!(finding("pot", r#"{"P1": 10}"#), None);
    }

    #[test]
    fn other_names_of_fixed_voltages_are_recognised() {
        let cases: [(&[&str], &str); 7] = [
            (&["gnd", "GND", "Earth", " gnd "], "did you mean \"ground\""),
            (&["0", "0V", "0.0 V"], "write \"ground\" for 0 V"),
            (&["100", "+100V", "+100 V", "1e2", "0.1kV"], "write \"+100\" for 100 V"),
            (&["-100V"], "write \"-100\" for -100 V"),
            (&["5", "5 V", "5000mV"], "for 5 V, write the name of a \"pot\""),
            (&["+ref", "VREF"], "did you mean \"+100\""),
            (&["VCC", "ref"], "the fixed voltages are \"+100\", \"-100\" and \"ground\""),
        ];
        for (names, expected) in cases {
            for name in names {
                let hint = fixed_voltage_hint(name, ["A1"]).unwrap_or_default();
                assert!(hint.starts_with(expected), "{name}: {hint}");
            }
        }
        for name in ["A1", "5 kg", "inf", "", "x", "grid"] {
            assert_eq!(fixed_voltage_hint(name, ["A1"]), None, "{name}");
        }
        assert_eq!(fixed_voltage_hint("GND", ["A1", "Gnd"]), None);
    }
}
