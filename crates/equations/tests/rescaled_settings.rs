//! The settings of rescaled patches: short numbers, pots that can be set for all values of the parameters, and nothing to
//! change if the patch is rescaled again.

use patchcord_core::document::Code;
use patchcord_core::patch::Patch;
use patchcord_equations::RescaledPatch;
use serde_json::json;

use crate::rescale::{case, check_same_signals, compiled, misscaled, rescaled, shipped};

/// Most digits of a number that changes.
const MOST_DIGITS: usize = 5;
/// Largest difference of a signal, as a share of its peak.
const TOLERANCE: f64 = 1e-9;

/// The significant digits of a number, also of the gain in the name of a jack. 0 for other names.
fn digits(token: &str) -> usize {
    let number = token.rsplit('x').next().unwrap_or_default();
    if !number.starts_with(|letter: char| letter.is_ascii_digit()) {
        return 0;
    }
    let mantissa = number.split('e').next().unwrap_or_default().replace('.', "");
    mantissa.trim_matches('0').len()
}

/// The changes with a number that has many digits.
fn long_changes(rescaled: &RescaledPatch) -> Vec<String> {
    let is_separator = |letter: char| !(letter.is_ascii_alphanumeric() || letter == '.' || letter == '_');
    let is_long = |text: &&String| text.split(is_separator).any(|token| digits(token) > MOST_DIGITS);
    rescaled.changes.iter().map(|change| &change.after).filter(is_long).cloned().collect()
}

#[test]
fn digits_of_numbers_are_counted() {
    let cases =
        [("x142.857", 6), ("brake_x1000", 1), ("0.0250", 2), ("time_scale", 0), ("1.5e-3", 2), ("", 0)];
    for (token, expected) in cases {
        assert_eq!(digits(token), expected, "{token}");
    }
}

#[test]
fn another_time_scale_has_no_long_numbers() {
    let files = [
        "problems/three-masses",
        "problems/bouncing-ball",
        "problems/dry-friction",
        "problems/relay-oscillator",
        "thesis/fig-8-17",
    ];
    for file in files {
        let rescaled = rescaled(&shipped(file), Some(7.0));
        assert_eq!(long_changes(&rescaled), Vec::<String>::new(), "{file}");
    }
    let rescaled = rescaled(&shipped("problems/bouncing-ball"), Some(7.0));
    assert_eq!(rescaled.patch.value()["elements"]["PG"]["setting"], "0.5 / time_scale");
}

#[test]
fn other_scales_have_no_long_numbers() {
    for case in [case("problems/saturated-integrator", 0.3, &[]), case("thesis/fig-8-09", 1.0, &[])] {
        assert_eq!(long_changes(&rescaled(&misscaled(&case), None)), Vec::<String>::new());
    }
}

#[test]
fn pots_can_be_set_for_all_values_of_the_parameters() {
    let lessons =
        ["driven-oscillator", "mass-and-spring", "stick-slip", "two-phase-oscillator", "van-der-pol"];
    for lesson in lessons {
        let rescaled = rescaled(&shipped(&format!("lessons/{lesson}")), Some(7.0));
        let warnings = compiled(&rescaled.patch).0.warnings();
        let is_about_range = warnings.findings.iter().any(|finding| finding.code == Code::SETTING_RANGE);
        assert!(!is_about_range, "{lesson}: {warnings}");
    }
}

#[test]
fn a_rescaled_patch_needs_no_other_scales() {
    for file in ["thesis/fig-8-16-coulomb", "thesis/fig-8-15", "lessons/mass-and-spring"] {
        let once = rescaled(&shipped(file), None);
        let again = rescaled(&once.patch, None);
        assert!(again.changes.is_empty(), "{file}: {:?}", again.changes);
        assert_eq!(again.patch.text(), once.patch.text(), "{file}");
    }
}

/// The pots of the two instances have settings of different sizes. One of them is 0.
#[test]
fn a_macro_keeps_one_gain_for_all_of_its_instances() {
    let text = r#"{"patchcord": 1,
        "parameters": {"k": {"value": 0.5, "unit": "1", "range": [0.2, 1]}},
        "macros": {"decay": {"inputs": {"u": "drive"}, "outputs": {"y": "A"},
            "settings": {"rate": {"unit": "1"}, "loss": {"unit": "1"}},
            "elements": {
                "P": {"kind": "pot", "in": "u", "setting": "rate"},
                "Q": {"kind": "pot", "in": "A", "setting": "loss"},
                "A": {"kind": "integrator", "in": {"x1": ["P", "Q"]}, "initial": 30}}}},
        "elements": {
            "a": {"kind": "decay", "u": "b", "rate": 0.5, "loss": 0},
            "b": {"kind": "decay", "u": "B", "rate": 0.05, "loss": "k"},
            "B": {"kind": "inverter", "in": "a"}},
        "signals": {"x": {"at": "a"}, "y": {"at": "b"}}, "run": {"for": 2, "step": 0.01}}"#;
    let patch = Patch::parse("decays.json", text).unwrap_or_else(|report| panic!("{report}"));
    for time in [10.0, 7.0] {
        let rescaled = rescaled(&patch, Some(time));
        let elements = &rescaled.patch.value()["macros"]["decay"]["elements"];
        let settings = ["P", "Q"].map(|pot| &elements[pot]["setting"]);
        assert_eq!(settings, ["rate / time_scale", "loss / time_scale"]);
        check_same_signals(&patch, &rescaled.patch, 2.0, TOLERANCE);
    }
    // The loss can be 1, so its pot gets the next gain. The rates are at most 0.5.
    let faster = rescaled(&patch, Some(0.5));
    let inputs = &faster.patch.value()["macros"]["decay"]["elements"]["A"]["in"];
    assert_eq!(*inputs, json!({"x1": ["P"], "x10": ["Q"]}));
    check_same_signals(&patch, &faster.patch, 2.0, TOLERANCE);
}

#[test]
fn figures_with_several_instances_of_a_macro_get_another_time_scale() {
    let patch = shipped("thesis/fig-4-07");
    let rescaled = rescaled(&patch, Some(10.0));
    assert_eq!(rescaled.patch.value()["scales"], patch.value()["scales"]);
    assert!((rescaled.time_scale - 10.0).abs() < 1e-12, "{}", rescaled.time_scale);
}
