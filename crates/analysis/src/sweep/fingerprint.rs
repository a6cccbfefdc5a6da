//! Fingerprints of what a sweep's rows depend on, so that an interrupted sweep is only resumed with the same inputs.
//!
//! A fingerprint is the BLAKE3 hash of a canonical text of the inputs: the patch document, the points of its tables,
//! the parameters that are set, the phases of the run, the rows of a file. It depends on no internal data structure, so
//! files stay valid across versions of the program that keep [`FORMAT_VERSION`].

use serde_json::{Map, Value};

use patchcord_core::document::Phase;
use patchcord_core::ir::{ParameterValue, Program};
use patchcord_core::patch::{Amount, Patch};
use patchcord_core::solve::RunSettings;

/// The version of the head of a sweep file. Raise it when the head, the columns or a canonical text change.
pub(super) const FORMAT_VERSION: u32 = 3;

/// Sections of a patch that no row depends on, or that the run settings already contain.
const IGNORED_SECTIONS: [&str; 7] =
    ["title", "source", "equations", "positive_feedback", "pictures", "record", "run"];
/// Keys of an entry that only people read.
const IGNORED_KEYS: [&str; 2] = ["note", "description"];
/// Hexadecimal digits of a fingerprint: 128 bits.
const DIGITS: usize = 32;

/// The fingerprint of a canonical text.
pub(super) fn of_text(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().as_str()[..DIGITS].to_owned()
}

/// The patch, its parameters and the phases of the run as one canonical text. Parameters in `varied` are omitted.
pub(super) fn canonical_run(
    patch: &Patch,
    program: &Program,
    settings: &RunSettings,
    varied: &[&str],
) -> String {
    let mut text = format!("{}\n", canonical_document(patch.value()));
    let is_constant = |parameter: &&ParameterValue| !varied.contains(&parameter.declared.name.as_str());
    for parameter in program.parameters().iter().filter(is_constant) {
        text += &format!("parameter {} {:016x}\n", parameter.declared.name, parameter.value.to_bits());
    }
    settings.phases.iter().for_each(|phase| push_phase(&mut text, phase));
    text + if settings.hold_on_overload { "hold on overload\n" } else { "" }
}

/// The points of all tables and curves, with the names of their elements. None if there are none.
pub(super) fn canonical_tables(patch: &Patch) -> Option<String> {
    let mut text = String::new();
    for (name, entry) in patch.drives.iter().chain(&patch.elements) {
        for points in entry.settings.iter().flatten().filter_map(|setting| points_of(&setting.value)) {
            text += &format!("{name} {}\n", canonical_points(points));
        }
    }
    (!text.is_empty()).then_some(text)
}

/// The numbers as hexadecimal bit patterns, so that different rows have different texts. None if there are no rows.
pub(super) fn canonical_rows<'a>(rows: impl IntoIterator<Item = &'a [f64]>) -> Option<String> {
    let lines: Vec<String> = rows.into_iter().map(canonical_numbers).collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

/// The points of a table or curve; None for other settings.
fn points_of(amount: &Amount) -> Option<&[[f64; 2]]> {
    match amount {
        Amount::Points(points) => Some(points),
        _ => None,
    }
}

/// The points as hexadecimal bit patterns: x and y of each point in turn.
fn canonical_points(points: &[[f64; 2]]) -> String {
    canonical_numbers(points.as_flattened())
}

/// Numbers as hexadecimal bit patterns, separated by blanks. No rounding can make two different numbers equal.
fn canonical_numbers(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{:016x}", number.to_bits())).collect::<Vec<_>>().join(" ")
}

/// The document without white space and without the parts that do not affect a row.
fn canonical_document(document: &Value) -> Value {
    let Value::Object(sections) = document else { return document.clone() };
    let relevant = sections.iter().filter(|(name, _)| !IGNORED_SECTIONS.contains(&name.as_str()));
    Value::Object(relevant.map(|(name, section)| (name.clone(), canonical_section(section))).collect())
}

/// A section with its entries reduced to what affects a row.
fn canonical_section(section: &Value) -> Value {
    let Value::Object(entries) = section else { return section.clone() };
    Value::Object(entries.iter().map(|(name, entry)| (name.clone(), canonical_entry(entry))).collect())
}

/// An entry without its remarks. A macro contains elements, which are treated in the same way.
fn canonical_entry(entry: &Value) -> Value {
    let Value::Object(keys) = entry else { return entry.clone() };
    let mut relevant = Map::new();
    for (key, value) in keys.iter().filter(|(key, _)| !IGNORED_KEYS.contains(&key.as_str())) {
        let value = if key == "elements" { canonical_section(value) } else { value.clone() };
        relevant.insert(key.clone(), value);
    }
    Value::Object(relevant)
}

/// One line per phase, with times as bit patterns.
fn push_phase(text: &mut String, phase: &Phase) {
    match phase {
        Phase::InitialCondition => *text += "initial condition\n",
        Phase::Operate { time, until } => {
            *text += &format!("operate {:016x}", time.to_bits());
            if let Some(until) = until {
                let becomes = until.becomes.as_ref().map_or("either", |to| to.value.as_str());
                *text += &format!(" until {} {becomes}", until.relay.value);
            }
            text.push('\n');
        }
        Phase::Hold { time } => *text += &format!("hold {:016x}\n", time.to_bits()),
        Phase::Set { changes } => {
            for change in changes {
                *text += &format!("set {} {}\n", change.parameter.value, change.to.value);
            }
        }
        Phase::Repeat { times, phases } => {
            *text += &format!("repeat {times}\n");
            phases.iter().for_each(|phase| push_phase(text, phase));
            *text += "end\n";
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::circuit::Circuit;

    const PATCH: &str = r#"{"patchcord": 1, "title": "a pot", "parameters": {"k": {"value": 0.5, "unit": "1",
        "range": [0, 1], "description": "setting"}}, "elements": {
        "P1": {"kind": "pot", "in": "+100", "setting": "k", "note": "wiper"}}, "signals": {"s": {"at": "P1"}},
        "run": {"for": 1, "step": 0.1}, "pictures": [{"title": "s", "x": "t", "y": ["s"]}]}"#;

    fn canonical(text: &str, changes: &[(String, f64)]) -> String {
        let patch = Patch::parse("p.json", text).unwrap();
        let circuit = Circuit::with_parameters(&patch, changes.iter().cloned()).unwrap();
        let program = Program::new(&circuit).unwrap();
        canonical_run(&patch, &program, &RunSettings::of(&circuit).unwrap(), &[])
    }

    #[test]
    fn the_hash_matches_published_test_vectors() {
        assert_eq!(of_text(""), "af1349b9f5f9a1a6a0404dea36dcc949");
        assert_eq!(of_text("abc"), "6437b3ac38465133ffb63b75273a8db5");
    }

    #[test]
    fn remarks_and_white_space_do_not_change_the_text() {
        let patch = canonical(PATCH, &[]);
        assert_eq!(patch, canonical(&PATCH.replace("a pot", "another title"), &[]));
        assert_eq!(patch, canonical(&PATCH.replace("wiper", "slider"), &[]));
        assert_eq!(patch, canonical(&PATCH.replace(": ", " :  "), &[]));
        assert_eq!(patch, canonical(&PATCH.replace(", \"pictures\"", "\n, \"pictures\""), &[]));
        let equations = ", \"equations\": \"s = s\", \"pictures\"";
        assert_eq!(patch, canonical(&PATCH.replace(", \"pictures\"", equations), &[]));
    }

    #[test]
    fn everything_that_affects_a_row_changes_the_text() {
        let patch = canonical(PATCH, &[]);
        for (from, to) in
            [("+100", "-100"), ("\"for\": 1", "\"for\": 2"), ("\"value\": 0.5", "\"value\": 0.6")]
        {
            assert_ne!(patch, canonical(&PATCH.replace(from, to), &[]), "{from}");
        }
        assert_ne!(patch, canonical(PATCH, &[("k".into(), 0.25)]));
    }
}
