//! Unit tests of `schema`.

use super::*;
use crate::elements::Jacks;

/// The schema of a kind's entry.
fn schema_of(kind: &str) -> Value {
    entry(REGISTRY.iter().find(|row| row.name == kind).unwrap())
}

#[test]
fn an_input_for_exactly_two_cords_requires_a_list_of_two_names() {
    let cords = &schema_of("diode-lower-of")["properties"]["in"];
    assert_eq!((&cords["minItems"], &cords["maxItems"]), (&json!(2), &json!(2)));
}

#[test]
fn the_required_keys_of_an_element_are_the_inputs_that_must_be_driven() {
    for kind in REGISTRY.iter().filter(|kind| kind.family == Family::Computing) {
        let schema = entry(kind);
        let required = schema["required"].as_array().unwrap();
        for input in kind.inputs.iter().filter(|_| kind.inputs[0].jacks != Jacks::Gains) {
            assert_eq!(required.contains(&json!(input.name)), input.required, "{} {}", kind.name, input.name);
        }
    }
}
