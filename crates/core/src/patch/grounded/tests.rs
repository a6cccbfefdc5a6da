//! Tests of copies with grounded inputs: where "ground" is plugged in.

use crate::circuit::Circuit;
use crate::document::Code;
use crate::patch::Patch;

/// The patch of a document with these sections.
fn patch_with(sections: &str) -> Patch {
    Patch::parse("p.json", &format!("{{\"patchcord\": 1, {sections}}}")).unwrap()
}

/// The section "elements" of the copy with grounded inputs, as a text. The copy must be a valid patch.
fn grounded(sections: &str) -> String {
    let patch = patch_with(sections);
    let report = Circuit::new(&patch).unwrap_err();
    assert!(report.findings.iter().any(|finding| finding.code == Code::NO_DRIVER), "{report}");
    let copy = patch.with_grounded_inputs().unwrap();
    Circuit::new(&copy).unwrap_or_else(|report| panic!("{report}"));
    copy.value()["elements"].to_string()
}

#[test]
fn an_open_input_with_gains_is_grounded_at_the_smallest_gain_of_the_machine() {
    let cases = [
        (r#""A": {"kind": "summer"}"#, r#"{"A":{"kind":"summer","in":{"x1":["ground"]}}}"#),
        (r#""A": {"kind": "summer", "in": {}}"#, r#"{"A":{"kind":"summer","in":{"x1":["ground"]}}}"#),
        (
            r#""A": {"kind": "integrator", "in": {"x10": []}}"#,
            r#"{"A":{"kind":"integrator","in":{"x10":["ground"]}}}"#,
        ),
    ];
    // Only a machine with mode relays resets single integrators.
    let reset = r#""machine": "unlimited", "elements": {"A": {"kind": "integrator", "in": {"x1": ["A"], "reset": []}}}"#;
    assert_eq!(grounded(reset), r#"{"A":{"kind":"integrator","in":{"x1":["A"],"reset":["ground"]}}}"#);
    for machine in ["solartron-1451", "unlimited"] {
        for (element, expected) in cases {
            let sections = format!("\"machine\": \"{machine}\", \"elements\": {{{element}}}");
            assert_eq!(grounded(&sections), expected, "{machine}");
        }
    }
}

#[test]
fn every_missing_cord_of_an_input_with_two_poles_is_grounded() {
    let cases = [
        (r#""L": {"kind": "diode-lower-of"}"#, r#"{"L":{"kind":"diode-lower-of","in":["ground","ground"]}}"#),
        (
            r#""L": {"kind": "diode-lower-of", "in": []}"#,
            r#"{"L":{"kind":"diode-lower-of","in":["ground","ground"]}}"#,
        ),
        (
            r#""L": {"kind": "diode-lower-of", "in": "+100"}"#,
            r#"{"L":{"kind":"diode-lower-of","in":["+100","ground"]}}"#,
        ),
        (
            r#""L": {"kind": "diode-lower-of", "in": ["+100"]}"#,
            r#"{"L":{"kind":"diode-lower-of","in":["+100","ground"]}}"#,
        ),
        (r#""P": {"kind": "pot", "setting": 0.5}"#, r#"{"P":{"kind":"pot","setting":0.5,"in":["ground"]}}"#),
    ];
    for (element, expected) in cases {
        assert_eq!(grounded(&format!("\"elements\": {{{element}}}")), expected);
    }
}

/// A macro with a pot at its port "in". The cord of its inverter is still missing.
const MACRO: &str = r#""macros": {"half": {"inputs": {"in": "voltage"}, "outputs": {"out": "P", "other": "I"},
    "elements": {"P": {"kind": "pot", "in": "in", "setting": 0.5}, "I": {"kind": "inverter"}}}}"#;

#[test]
fn open_ports_and_open_inputs_inside_macros_are_grounded() {
    let sections =
        format!(r#"{MACRO}, "elements": {{"H": {{"kind": "half"}}, "G": {{"kind": "half", "in": "H"}}}}"#);
    let expected = r#"{"H":{"kind":"half","in":["ground"]},"G":{"kind":"half","in":"H"}}"#;
    assert_eq!(grounded(&sections), expected);
    let copy = patch_with(&sections).with_grounded_inputs().unwrap();
    let inverter = &copy.value()["macros"]["half"]["elements"]["I"];
    assert_eq!(inverter.to_string(), r#"{"kind":"inverter","in":["ground"]}"#);
}

#[test]
fn a_patch_without_open_inputs_has_no_grounded_copy() {
    let without_instance =
        format!(r#"{MACRO}, "elements": {{"A": {{"kind": "summer", "in": {{"x1": ["+100"]}}}}}}"#);
    let sections = [
        without_instance.as_str(),
        r#""elements": {"A": {"kind": "integrator", "in": {"x1": ["A"]}}}"#,
        // The wrong cord may be meant for the open input.
        r#""elements": {"A": {"kind": "summer", "in": {"y": ["+100"]}}}"#,
        r#""elements": {"P": {"kind": "pot", "setting": 0.5, "inn": "+100"}}"#,
    ];
    for sections in sections {
        assert!(patch_with(sections).with_grounded_inputs().is_none(), "{sections}");
    }
}
