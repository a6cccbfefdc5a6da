use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Severity};
use patchcord_core::elements::REGISTRY;
use patchcord_core::ir::Program;
use patchcord_core::solve::Machine;

use super::*;

#[test]
fn an_element_that_the_machine_does_not_have_is_refused() {
    let mut document = shipped("thesis/fig-8-16.json");
    document.apply(&add("multiplier")).unwrap();
    assert!(document.patch().elements.contains_key("M2"));
    let refused = refusal(&mut document, &add("multiplier"));
    assert_eq!(
        refused.message,
        "an element of kind multiplier needs 1 multiplier, but the solartron-1451 has 2 multipliers, and M1, M2 use \
         2: remove one of them first"
    );
    let refused = refusal(&mut document, &add("comparator"));
    assert_eq!(
        refused.message,
        "an element of kind comparator needs 1 relay, but the solartron-1451 has no relays"
    );
}

#[test]
fn a_chosen_name_must_be_free_and_valid() {
    let mut document = lesson();
    let named = |name: &str| Command::AddElement { kind: "pot".to_owned(), name: Some(name.to_owned()) };
    for (name, expected) in
        [("P1", "P1 exists already: "), ("x", "x exists already: "), ("+100", "\"+100\" cannot name")]
    {
        let refused = refusal(&mut document, &named(name));
        assert!(refused.message.starts_with(expected), "{}", refused.message);
    }
    document.apply(&named("P4")).unwrap();
    document.apply(&add("pot")).unwrap();
    assert_eq!(document.undo_label(), Some("add P5"));
}

#[test]
fn without_known_names_a_message_has_no_list() {
    let mut document = Document::empty(None, &TableAccess::None);
    let refused = refusal(&mut document, &Command::RemoveElement { name: "A9".to_owned() });
    assert_eq!(refused.message, "there is no element A9 to remove");
    let refused = refusal(&mut document, &set("A9", "initial", json!(1)));
    assert_eq!(refused.message, "there is no element A9");
    let refused = refusal(&mut document, &plug("A9", "x1", "+100"));
    assert_eq!(refused.message, "there is no element A9 with inputs");
}

#[test]
fn of_every_new_element_only_the_cords_are_missing() {
    let mut document = Document::empty(None, &TableAccess::None);
    for kind in REGISTRY {
        document
            .apply(&add(kind.name))
            .unwrap_or_else(|refusal| panic!("{}: {}", kind.name, refusal.message));
    }
    let patch = document.patch();
    assert_eq!(patch.elements.len() + patch.drives.len(), REGISTRY.len());
    assert_eq!(patch.scales.keys().collect::<Vec<_>>(), ["volt"]);
    let report = Circuit::new(patch).unwrap_err();
    let errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    for finding in errors {
        assert_eq!(finding.code, Code::NO_DRIVER, "{}", finding.message);
    }
}

#[test]
fn an_oscillator_is_built_from_an_empty_patch() {
    let mut document = Document::empty(Some("solartron-1451"), &TableAccess::None);
    assert_eq!(document.patch().title, "Untitled");
    assert_eq!(document.patch().run.longest_repetition(), Some(10.0));
    let commands = [
        add("integrator"),
        add("integrator"),
        add("inverter"),
        plug("A2", "x1", "A1"),
        plug("S1", "in", "A2"),
        plug("A1", "x1", "S1"),
        set("A1", "initial", json!(50)),
    ];
    for command in &commands {
        document.apply(command).unwrap();
    }
    // A1' = A2 and A2' = -A1, so A1 = 50 cos t and A2 = -50 sin t.
    let circuit = Circuit::new(document.patch()).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap();
    let mut machine = Machine::new(&program, 1e-3).unwrap();
    machine.operate(1.0).unwrap();
    for (name, expected) in [("A1", 50.0 * 1_f64.cos()), ("A2", -50.0 * 1_f64.sin())] {
        assert!((machine.voltage(name).unwrap() - expected).abs() < 1e-9, "{name}");
    }
    for _ in &commands {
        document.undo().unwrap();
    }
    assert_eq!(
        document.patch().text(),
        Document::empty(Some("solartron-1451"), &TableAccess::None).patch().text()
    );
}
