//! Cords in the document with other gains, and with new pots.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::decision::Decision;
use super::wiring::Wiring;
use crate::fixes::is_free_name;

/// The value of "in" of an element after a decision. `None` if none of its cords changes.
///
/// `added` has the names of the pots that are put into cords, by the index of the cord.
///
/// # Errors
/// If the document does not have the cords as the circuit has them.
pub(super) fn changed_jacks(
    wiring: &Wiring<'_>,
    element: usize,
    decision: &Decision,
    added: &BTreeMap<usize, String>,
) -> Result<Option<Value>, String> {
    let cords = &wiring.cords[element];
    let is_changed =
        |cord: usize| decision.gains[element][cord] != cords[cord].1.gain || added.contains_key(&cord);
    if !(0..cords.len()).any(is_changed) {
        return Ok(None);
    }
    let listed = listed(wiring, element);
    if listed.len() != cords.len() {
        let element = wiring.located(element);
        return Err(format!("the cords of {element} cannot be changed: write them in the element itself"));
    }
    let mut jacks: Map<String, Value> = Map::new();
    for (cord, (jack, source)) in listed.into_iter().enumerate() {
        let gain = decision.gains[element][cord];
        let name = match gain == cords[cord].1.gain {
            true => jack.clone(),
            false => jack_name(wiring, element, cord, gain),
        };
        let source = added.get(&cord).map_or_else(|| source.clone(), |pot| json!(pot));
        match jacks.entry(name).or_insert_with(|| json!([])) {
            Value::Array(list) => list.push(source),
            other => *other = json!([source]),
        }
    }
    simplify(&mut jacks, wiring.written(element, "in"));
    Ok(Some(Value::Object(jacks)))
}

/// A jack that had a name without a list keeps this form, if it has one cord.
fn simplify(jacks: &mut Map<String, Value>, written: Option<&Value>) {
    let was_single = |jack: &String| written.and_then(|jacks| jacks.get(jack)).is_some_and(Value::is_string);
    for (_, list) in jacks.iter_mut().filter(|(jack, _)| was_single(jack)) {
        if let Some([only]) = list.as_array().map(Vec::as_slice) {
            *list = only.clone();
        }
    }
}

/// The name of the jack of an input with a gain.
pub(super) fn jack_name(wiring: &Wiring<'_>, element: usize, cord: usize, gain: f64) -> String {
    let input = &wiring.kind(element).inputs[wiring.cords[element][cord].1.input];
    if wiring.has_gain(element, cord) { format!("{}{gain}", input.name) } else { input.name.to_owned() }
}

/// The source of a cord, as the document has it.
pub(super) fn written_source<'c>(wiring: &Wiring<'c>, element: usize, cord: usize) -> Option<&'c Value> {
    listed(wiring, element).get(cord).map(|(_, source)| *source)
}

/// The cords of an element of the document: the name of the jack and the source of each.
fn listed<'c>(wiring: &Wiring<'c>, element: usize) -> Vec<(&'c String, &'c Value)> {
    let written = wiring.written(element, "in").and_then(Value::as_object);
    written.into_iter().flatten().flat_map(sources).collect()
}

/// A name for a pot that is put into a cord.
pub(super) fn new_pot_name(wiring: &Wiring<'_>, element: usize, cord: usize) -> String {
    let inner = wiring.places[element].as_ref().and_then(|place| place.path.last());
    let base = format!("PT_{}_{}", inner.map_or("", String::as_str), cord + 1);
    let elements = &wiring.circuit.patch().elements;
    let is_free = |name: &String| {
        let is_inside = elements.keys().any(|known| known.ends_with(&format!(".{name}")));
        !is_inside && is_free_name(wiring.circuit, name)
    };
    let numbered = (2..).map(|number| format!("{base}_{number}"));
    std::iter::once(base.clone()).chain(numbered).find(is_free).unwrap_or_default()
}

/// The sources at a jack of the document, each with the name of the jack.
fn sources<'v>((jack, value): (&'v String, &'v Value)) -> Vec<(&'v String, &'v Value)> {
    match value {
        Value::Array(list) => list.iter().map(|source| (jack, source)).collect(),
        only => vec![(jack, only)],
    }
}

#[cfg(test)]
mod tests {
    use patchcord_core::circuit::Circuit;
    use patchcord_core::patch::Patch;

    use super::*;

    #[test]
    fn cords_move_to_other_jacks_and_keep_their_order() {
        let text = r#"{"patchcord": 1, "elements": {
            "A": {"kind": "integrator", "in": {"x1": ["B", "+100"], "x10": "B", "reset": "B"}},
            "B": {"kind": "inverter", "in": "A"}}}"#;
        let circuit =
            Circuit::new(&Patch::parse("p.json", text).unwrap()).unwrap_or_else(|report| panic!("{report}"));
        let wiring = Wiring::new(&circuit);
        let element = (0..wiring.len()).find(|element| wiring.name(*element) == "A").unwrap();
        let mut decision = Decision::none(&wiring);
        let changed = |decision: &Decision, added: &[(usize, &str)]| {
            let added = added.iter().map(|(cord, pot)| (*cord, (*pot).to_owned())).collect();
            changed_jacks(&wiring, element, decision, &added).unwrap()
        };
        assert_eq!(changed(&decision, &[]), None);
        decision.gains[element][1] = 10.0;
        let expected = json!({"x1": ["B"], "x10": ["+100", "B"], "reset": "B"});
        assert_eq!(changed(&decision, &[]), Some(expected));
        decision.gains[element][1] = 0.5;
        let expected = json!({"x1": ["B"], "x0.5": ["P"], "x10": "B", "reset": "B"});
        assert_eq!(changed(&decision, &[(1, "P")]), Some(expected));
    }

    #[test]
    fn a_new_pot_has_a_name_that_nothing_has() {
        let text = r#"{"patchcord": 1, "parameters": {"PT_A_1": {"value": 1, "unit": "1"}},
            "elements": {"A": {"kind": "integrator", "in": {"x1": ["A"]}},
                "PT_A_1_2": {"kind": "pot", "in": "A", "setting": "PT_A_1"}}}"#;
        let circuit =
            Circuit::new(&Patch::parse("p.json", text).unwrap()).unwrap_or_else(|report| panic!("{report}"));
        let wiring = Wiring::new(&circuit);
        let element = (0..wiring.len()).find(|element| wiring.name(*element) == "A").unwrap();
        assert_eq!(new_pot_name(&wiring, element, 0), "PT_A_1_3");
    }
}
