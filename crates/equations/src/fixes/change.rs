//! Single changes of a patch, and what they mean for the document and for the wiring.

use std::collections::BTreeMap;

use patchcord_core::patch::Edit;
use serde_json::{Value, json};

use super::document::{plug, replug, unplug};
use super::influence::Part;
use super::netlist::{Link, Rewiring};
use super::panel::{Panel, WiredCord};

/// A single change. Cords and outputs are indices of a [`Panel`].
#[derive(Debug, Clone)]
pub(super) enum Change {
    /// A cord is plugged into a jack with another gain.
    Regain { cord: usize, jack: String, gain: f64 },
    /// A cord comes from another output.
    Replug { cord: usize, output: usize },
    /// An inverter is put into a cord.
    Invert { cord: usize },
    /// A cord is removed.
    Unplug { cord: usize },
    /// A cord is added at a jack with a gain.
    Plug { element: usize, input: usize, jack: String, gain: f64, output: usize },
    /// Two cords exchange their outputs.
    Exchange { cords: [usize; 2] },
    /// A value of the document is another one.
    Set(Setting),
}

/// Another value in the document.
#[derive(Debug, Clone)]
pub(super) struct Setting {
    /// The keys from the root of the document to the value.
    pub path: Vec<String>,
    /// The new value.
    pub value: Value,
    /// The change as a command.
    pub description: String,
    /// What it affects.
    pub part: Part,
}

impl Change {
    /// The change as a command, such as "plug B1 into P1 in place of A2".
    pub(super) fn description(&self, panel: &Panel<'_>) -> String {
        let name = |output: usize| &panel.outputs[output].name;
        match self {
            Change::Regain { cord, jack, .. } => {
                let place = &panel.cords[*cord].place;
                format!("plug {} into {jack} of {} in place of {}", place.source, place.element, place.jack)
            }
            Change::Replug { cord, output } => {
                let source = &panel.cords[*cord].place.source;
                format!("plug {} into {} in place of {source}", name(*output), target(panel, *cord))
            }
            Change::Invert { cord } => {
                let source = &panel.cords[*cord].place.source;
                format!("put an inverter between {source} and {}", target(panel, *cord))
            }
            Change::Unplug { cord } => {
                let source = &panel.cords[*cord].place.source;
                format!("remove the cord from {source} to {}", target(panel, *cord))
            }
            Change::Plug { element, jack, output, .. } => {
                format!("plug {} into {jack} of {}", name(*output), panel.circuit.element(*element).name)
            }
            Change::Exchange { cords } => {
                let [one, other] = cords.map(|cord| {
                    format!("from {} to {}", panel.cords[cord].place.source, target(panel, cord))
                });
                format!("exchange the outputs of the cords {one} and {other}")
            }
            Change::Set(setting) => setting.description.clone(),
        }
    }

    /// The edits of the document. `None` if the document does not have a cord as the circuit has it.
    pub(super) fn edits(&self, panel: &Panel<'_>) -> Option<Vec<Edit>> {
        if let Change::Set(setting) = self {
            return Some(vec![Edit::at(setting.path.clone(), setting.value.clone())]);
        }
        let document = &panel.circuit.patch().value()["elements"];
        let mut entries: BTreeMap<&str, Value> = BTreeMap::new();
        for name in self.elements(panel) {
            entries.insert(name, document.get(name)?.clone());
        }
        let added = self.plug_cords(panel, &mut entries)?;
        let changed = entries.iter().flat_map(|(name, entry)| changed_keys(name, &document[*name], entry));
        Some(changed.chain(added).collect())
    }

    /// Changes the cords in the entries of elements, by their names. Returns the edits for a further element. `None` if
    /// the document does not have a cord as the circuit has it.
    fn plug_cords(&self, panel: &Panel<'_>, entries: &mut BTreeMap<&str, Value>) -> Option<Vec<Edit>> {
        match self {
            Change::Regain { cord, jack, .. } => {
                let place = &panel.cords[*cord].place;
                let entry = entries.get_mut(place.element.as_str())?;
                unplug(entry, place)?;
                plug(entry, jack, &place.source)?;
            }
            Change::Replug { cord, output } => {
                let place = &panel.cords[*cord].place;
                replug(entries.get_mut(place.element.as_str())?, place, &panel.outputs[*output].name)?;
            }
            Change::Invert { cord } => {
                let place = &panel.cords[*cord].place;
                replug(entries.get_mut(place.element.as_str())?, place, &panel.new_name)?;
                let inverter = json!({"kind": "inverter", "in": place.source});
                return Some(vec![Edit::at(["elements", panel.new_name.as_str()], inverter)]);
            }
            Change::Unplug { cord } => {
                let place = &panel.cords[*cord].place;
                unplug(entries.get_mut(place.element.as_str())?, place)?;
            }
            Change::Plug { jack, output, .. } => {
                let entry = entries.values_mut().next()?;
                plug(entry, jack, &panel.outputs[*output].name)?;
            }
            Change::Exchange { cords } => {
                let [one, other] = cords.map(|cord| &panel.cords[cord].place);
                replug(entries.get_mut(one.element.as_str())?, one, &other.source)?;
                replug(entries.get_mut(other.element.as_str())?, other, &one.source)?;
            }
            Change::Set(_) => {}
        }
        Some(Vec::new())
    }

    /// The names of the elements whose cords change.
    fn elements<'p>(&self, panel: &'p Panel<'_>) -> Vec<&'p str> {
        let of_cord = |cord: usize| panel.cords[cord].place.element.as_str();
        match self {
            Change::Regain { cord, .. }
            | Change::Replug { cord, .. }
            | Change::Invert { cord }
            | Change::Unplug { cord } => vec![of_cord(*cord)],
            Change::Plug { element, .. } => vec![panel.circuit.element(*element).name.as_str()],
            Change::Exchange { cords } => cords.map(of_cord).to_vec(),
            Change::Set(_) => Vec::new(),
        }
    }

    /// The part of the circuit that the change affects.
    pub(super) fn part(&self, panel: &Panel<'_>) -> Part {
        let wired = |cords: &[usize]| {
            let elements = cords.iter().map(|cord| Some(panel.cords[*cord].wired?.element));
            elements.collect::<Option<Vec<usize>>>().map_or(Part::All, Part::Elements)
        };
        match self {
            Change::Regain { cord, .. }
            | Change::Replug { cord, .. }
            | Change::Invert { cord }
            | Change::Unplug { cord } => wired(&[*cord]),
            Change::Plug { element, .. } => Part::Elements(vec![*element]),
            Change::Exchange { cords } => wired(cords),
            Change::Set(setting) => setting.part.clone(),
        }
    }

    /// The cords of the elements that change. `None` if the change is none of cords between elements of the circuit.
    pub(super) fn rewiring(&self, panel: &Panel<'_>) -> Option<Rewiring> {
        let mut rewiring = Rewiring::default();
        let from = |output: usize| panel.outputs[output].element;
        match self {
            Change::Regain { cord, gain, .. } => {
                change_link(panel, &mut rewiring, *cord, |link| link.factor = *gain)?;
            }
            Change::Replug { cord, output } => {
                let output = from(*output)?;
                change_link(panel, &mut rewiring, *cord, |link| link.from = output)?;
            }
            Change::Invert { cord } => {
                change_link(panel, &mut rewiring, *cord, |link| link.factor = -link.factor)?;
            }
            Change::Unplug { cord } => {
                let WiredCord { element, index, .. } = panel.cords[*cord].wired?;
                let mut links = links(panel, element);
                links.remove(index);
                rewiring.set(element, links);
            }
            Change::Plug { element, input, gain, output, .. } => {
                let mut links = links(panel, *element);
                links.push(Link { input: *input, from: from(*output)?, factor: *gain });
                rewiring.set(*element, links);
            }
            Change::Exchange { cords: [one, other] } => {
                let [first, second] =
                    [panel.cords[*one].wired?.link.from, panel.cords[*other].wired?.link.from];
                change_link(panel, &mut rewiring, *one, |link| link.from = second)?;
                change_link(panel, &mut rewiring, *other, |link| link.from = first)?;
            }
            Change::Set(_) => return None,
        }
        Some(rewiring)
    }
}

/// The element that a cord leads to, with the jack if another cord comes from the same output.
fn target(panel: &Panel<'_>, cord: usize) -> String {
    let cord = &panel.cords[cord];
    match panel.is_ambiguous(cord) {
        true => format!("{} of {}", cord.place.jack, cord.place.element),
        false => cord.place.element.clone(),
    }
}

/// The edits of the keys of an element whose values differ.
fn changed_keys(name: &str, before: &Value, after: &Value) -> Vec<Edit> {
    let entries = after.as_object().into_iter().flatten();
    let changed = entries.filter(|(key, value)| before.get(key) != Some(*value));
    changed.map(|(key, value)| Edit::at(["elements", name, key.as_str()], value.clone())).collect()
}

/// The cords of an element of the circuit.
fn links(panel: &Panel<'_>, element: usize) -> Vec<Link> {
    panel.cords_into(element).map(|wired| wired.link).collect()
}

/// Changes one cord of a rewiring. `None` if it leads to an instance of a macro.
fn change_link(
    panel: &Panel<'_>,
    rewiring: &mut Rewiring,
    cord: usize,
    change: impl FnOnce(&mut Link),
) -> Option<()> {
    let WiredCord { element, index, .. } = panel.cords[cord].wired?;
    let mut links = rewiring.links(element).map_or_else(|| links(panel, element), <[Link]>::to_vec);
    change(links.get_mut(index)?);
    rewiring.set(element, links);
    Some(())
}

#[cfg(test)]
mod tests {
    use patchcord_core::circuit::Circuit;
    use patchcord_core::patch::Patch;

    use super::*;

    /// A sum of a constant and of two cords from one output, and the product of an output with itself.
    fn circuit() -> Circuit {
        let text = r#"{"patchcord": 1, "elements": {
            "A": {"kind": "integrator", "in": {"x1": ["+100", "B"], "x10": ["B"]}},
            "B": {"kind": "inverter", "in": "A"},
            "M": {"kind": "multiplier", "mode": "product", "a": "A", "b": "A"}}}"#;
        Circuit::new(&Patch::parse("p.json", text).unwrap()).unwrap_or_else(|report| panic!("{report}"))
    }

    /// The edits of a change, each with the last key of its path.
    fn edits(change: &Change, panel: &Panel<'_>) -> Vec<(String, Value)> {
        let edits = change.edits(panel).unwrap().into_iter();
        edits.map(|edit| (edit.path()[2..].join("/"), edit.value().clone())).collect()
    }

    #[test]
    fn two_cords_of_one_element_exchange_their_outputs() {
        let circuit = circuit();
        let panel = Panel::new(&circuit);
        let change = Change::Exchange { cords: [0, 2] };
        let expected = json!({"x1": ["B", "B"], "x10": ["+100"]});
        assert_eq!(edits(&change, &panel), [("in".to_owned(), expected)]);
        assert_eq!(
            change.description(&panel),
            "exchange the outputs of the cords from +100 to A and from B to x10 of A"
        );
        let rewiring = change.rewiring(&panel).unwrap();
        let links = rewiring.links(3).unwrap();
        assert_eq!(
            links.iter().map(|link| (link.from, link.factor)).collect::<Vec<_>>(),
            [(4, 1.0), (4, 1.0), (0, 10.0)]
        );
    }

    #[test]
    fn a_cord_in_another_jack_stays_a_cord_of_its_output() {
        let circuit = circuit();
        let panel = Panel::new(&circuit);
        let change = Change::Regain { cord: 1, jack: "x10".to_owned(), gain: 10.0 };
        assert_eq!(edits(&change, &panel), [("in".to_owned(), json!({"x1": ["+100"], "x10": ["B", "B"]}))]);
        assert_eq!(change.description(&panel), "plug B into x10 of A in place of x1");
        assert_eq!(change.part(&panel), Part::Elements(vec![3]));
    }

    #[test]
    fn the_inputs_of_a_square_are_distinguished() {
        let circuit = circuit();
        let panel = Panel::new(&circuit);
        let b = panel.outputs.iter().position(|output| output.name == "B").unwrap();
        let change = Change::Replug { cord: 5, output: b };
        assert_eq!(edits(&change, &panel), [("b".to_owned(), json!("B"))]);
        assert_eq!(change.description(&panel), "plug B into b of M in place of A");
    }

    #[test]
    fn an_added_inverter_has_a_new_name() {
        let circuit = circuit();
        let panel = Panel::new(&circuit);
        let change = Change::Invert { cord: 3 };
        let inverter = json!({"kind": "inverter", "in": "A"});
        let expected = [("in".to_owned(), json!("N1")), (String::new(), inverter)];
        assert_eq!(edits(&change, &panel), expected);
        assert_eq!(change.rewiring(&panel).unwrap().links(4).unwrap()[0].factor, -1.0);
    }
}
