use patchcord_core::circuit::Circuit;
use patchcord_core::document::Code;
use patchcord_core::patch::TableAccess;
use serde_json::json;

use super::*;
use crate::command::Command;
use crate::document::Document;

/// A shipped patch.
fn shipped(name: &str) -> Document {
    let text = std::fs::read_to_string(format!("../../patches/{name}")).unwrap();
    Document::open(name, &text, &TableAccess::Below("../../patches/lessons".into())).unwrap()
}

/// A patch of these sections, on the Solartron 1451.
fn patch(sections: &str) -> Document {
    let text = format!("{{\"patchcord\": 1, \"machine\": \"solartron-1451\", {sections}}}");
    Document::open("p.json", &text, &TableAccess::None).unwrap()
}

/// The findings about a document with this code.
fn found(document: &Document, code: Code) -> Vec<Finding> {
    let report = match Circuit::new(document.patch()) {
        Ok(circuit) => circuit.warnings(),
        Err(report) => *report,
    };
    let mut findings = findings(&report, document.patch(), document.pulled_jacks());
    findings.retain(|finding| finding.code == code.as_str());
    findings
}

/// The place of the only finding with this code.
fn only_place(document: &Document, code: Code) -> Place {
    let findings = found(document, code);
    assert_eq!(findings.len(), 1, "{findings:?}");
    findings[0].place.clone().expect("a place")
}

/// A place in a jack.
fn jack(element: &str, jack: &str, from: Option<&str>) -> Place {
    let [element, jack] = [element, jack].map(|name| Some(name.to_owned()));
    Place { element, jack, from: from.map(str::to_owned), ..Place::default() }
}

/// A command that pulls a cord out.
fn unplug(element: &str, jack: &str, from: &str) -> Command {
    let [element, jack, from] = [element, jack, from].map(str::to_owned);
    Command::Unplug { element, jack, from }
}

#[test]
fn a_missing_cord_is_reported_at_its_jack() {
    let mut document = shipped("lessons/mass-and-spring.json");
    assert!(Circuit::new(document.patch()).is_ok());
    document.apply(&unplug("P1", "in", "B1")).unwrap();
    assert_eq!(only_place(&document, Code::NO_DRIVER), jack("P1", "in", None));
    document.undo().unwrap();
    document.apply(&unplug("M1", "b", "B1")).unwrap();
    let finding = &found(&document, Code::NO_DRIVER)[0];
    assert_eq!(finding.place, Some(jack("M1", "b", None)));
    assert_eq!((finding.severity.as_str(), finding.line), ("error", Some(33)));
    let hint =
        "plug a cord in: from an output, or from ground for 0 V (purpose: second voltage (or \"ground\"))";
    assert_eq!(finding.hint, hint);
    document.undo().unwrap();
    // The text no longer has the jack x10, but it is empty at the panel.
    document.apply(&unplug("A1", "x10", "P1")).unwrap();
    assert_eq!(only_place(&document, Code::NO_DRIVER), jack("A1", "x10", None));
    // Without a cord that was pulled, the jack with the least gain is meant.
    let document = Document::open("p.json", document.patch().text(), &TableAccess::None).unwrap();
    assert_eq!(only_place(&document, Code::NO_DRIVER), jack("A1", "x1", None));
    let empty = patch(r#""elements": {"A1": {"kind": "integrator", "in": {"x10": []}}}"#);
    assert_eq!(only_place(&empty, Code::NO_DRIVER), jack("A1", "x10", None));
}

#[test]
fn every_open_jack_of_an_element_has_its_own_finding() {
    let document = patch(r#""elements": {"M1": {"kind": "multiplier", "mode": "product"}}"#);
    let places: Vec<_> = found(&document, Code::NO_DRIVER).into_iter().map(|finding| finding.place).collect();
    assert_eq!(places, [Some(jack("M1", "a", None)), Some(jack("M1", "b", None))]);
}

#[test]
fn two_cords_in_one_jack_are_reported_at_the_second() {
    let document = patch(
        r#""elements": {"A1": {"kind": "integrator", "in": {"x1": ["P1"]}},
                        "P1": {"kind": "pot", "in": ["A1", "+100"], "setting": 0.5}}"#,
    );
    assert_eq!(only_place(&document, Code::OUTPUTS_TIED), jack("P1", "in", Some("+100")));
}

#[test]
fn an_unknown_output_is_reported_at_its_cord() {
    let document = patch(r#""elements": {"A1": {"kind": "summer", "in": {"x1": ["A1", "Q7"]}}}"#);
    assert_eq!(only_place(&document, Code::UNKNOWN_NAME), jack("A1", "x1", Some("Q7")));
}

#[test]
fn a_gain_that_the_machine_lacks_is_reported_at_its_jack() {
    let mut document = shipped("lessons/mass-and-spring.json");
    let [element, jack_name, from] = ["A1", "x5", "P2"].map(str::to_owned);
    document.apply(&Command::Plug { element, jack: jack_name, from }).unwrap();
    assert_eq!(only_place(&document, Code::MISSING_GAIN), jack("A1", "x5", None));
}

#[test]
fn wrong_settings_and_parameters_are_reported_where_they_are_turned() {
    let mut document = shipped("lessons/mass-and-spring.json");
    let (element, setting) = ("P1".to_owned(), "setting".to_owned());
    document.apply(&Command::Setting { element, setting, value: json!("k") }).unwrap();
    let place = only_place(&document, Code::UNIT_MISMATCH);
    assert_eq!((place.element.as_deref(), place.setting.as_deref()), (Some("P1"), Some("setting")));
    let document = patch(
        r#""parameters": {"m": {"value": 20, "unit": "kg", "range": [1, 10]}},
           "elements": {"S1": {"kind": "summer", "in": {"x1": ["+100"]}, "limit": {"upper": 200}}}"#,
    );
    let place = only_place(&document, Code::OUTSIDE_RANGE);
    assert_eq!(place, Place { parameter: Some("m".to_owned()), ..Place::default() });
    let place = only_place(&document, Code::BAD_NUMBER);
    assert_eq!((place.element.as_deref(), place.setting.as_deref()), (Some("S1"), Some("limit.upper")));
}

#[test]
fn a_port_without_a_cord_is_reported_at_the_instance() {
    let mut document = shipped("lessons/heat-rod.json");
    document.apply(&unplug("C1", "right", "C2.flow")).unwrap();
    assert_eq!(only_place(&document, Code::NO_DRIVER), jack("C1", "right", None));
}

#[test]
fn a_finding_about_the_whole_patch_has_no_place() {
    let findings = found(&Document::empty(None, &TableAccess::None), Code::MISSING_KEY);
    assert_eq!((findings.len(), findings[0].place.clone()), (1, None));
    assert_eq!(findings[0].hint, "add an element");
}
