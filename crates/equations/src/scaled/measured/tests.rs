//! The peaks of amplifiers that overload.

use patchcord_core::patch::Patch;

use super::measured_peaks;

#[test]
fn an_overload_has_the_voltage_without_the_limit_if_it_is_known() {
    // The summer would have -300 V. The open amplifier has no feedback, so it demands 1e6 times 50 V.
    let text = r#"{"patchcord": 1, "elements": {
            "B1": {"kind": "summer", "in": {"x1": ["+100", "+100", "+100"]}},
            "B2": {"kind": "open-amplifier", "in": {"x1": ["P1"]}},
            "P1": {"kind": "pot", "in": "+100", "setting": 0.5}},
        "run": {"for": 1, "step": 0.1}}"#;
    let patch = Patch::parse("p.json", text).unwrap_or_else(|report| panic!("{report}"));
    let found = measured_peaks(&patch, &["B1", "B2", "P1"]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found, [300.0, 200.0, 50.0]);
}
