//! The peaks of amplifiers that overload.

use patchcord_core::patch::Patch;

use super::{OverloadedAmplifier, measured};

#[test]
fn an_overload_has_the_voltage_without_the_limit_if_it_is_known() {
    // The summer would have -300 V. The open amplifier has no feedback, so it demands 1e6 times 50 V.
    let text = r#"{"patchcord": 1, "elements": {
            "B1": {"kind": "summer", "in": {"x1": ["+100", "+100", "+100"]}},
            "B2": {"kind": "open-amplifier", "in": {"x1": ["P1"]}},
            "P1": {"kind": "pot", "in": "+100", "setting": 0.5}},
        "run": {"for": 1, "step": 0.1}}"#;
    let patch = Patch::parse("p.json", text).unwrap_or_else(|report| panic!("{report}"));
    let found = measured(&patch, &["B1", "P1"]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found.volts, [300.0, 50.0]);
    // B2 is no output of interest, but its overload is found.
    let mut overloads = found.overloads;
    overloads.sort_by(|one, other| one.element.cmp(&other.element));
    let overload = |element: &str, demand| OverloadedAmplifier { element: element.to_owned(), demand };
    assert_eq!(overloads, [overload("B1", Some(300.0)), overload("B2", None)]);
    let found = measured(&patch, &["B2"]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found.volts, [100.0]);
}

#[test]
fn a_patch_that_holds_on_overload_is_measured_to_the_end() {
    // A1 rises by 100 V per second. The summer overloads after 0.1 s, at 10 V of A1.
    let text = r#"{"patchcord": 1, "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["-100"]}},
            "B1": {"kind": "summer", "in": {"x10": ["A1"]}}},
        "run": {"for": 0.5, "step": 0.01, "hold_on_overload": true}}"#;
    let patch = Patch::parse("p.json", text).unwrap_or_else(|report| panic!("{report}"));
    let found = measured(&patch, &["A1", "B1"]).unwrap_or_else(|error| panic!("{error}")).volts;
    assert!((found[0] - 50.0).abs() < 1e-9 && (found[1] - 500.0).abs() < 1e-6, "{found:?}");
}
