//! The wiring of a patch as the rescaling reads it: cords, readers, signals, and the places of elements in the document.

use std::collections::BTreeMap;

use patchcord_core::circuit::{Circuit, Cord};
use patchcord_core::elements::{Family, Jacks, Kind, REFERENCES, SettingQuantity, Transfer};
use patchcord_core::patch::Amount;
use patchcord_expr::Formula;
use serde_json::Value;

/// The name of ground. Its 0 V are 0 in every scale.
const GROUND: &str = "ground";

/// The place of an element in the document. The instances of a macro share it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Place {
    /// The keys from the root of the document to the element.
    pub path: Vec<String>,
    /// The name of the instance whose macro contains the element. `None` outside of macros.
    pub instance: Option<String>,
}

/// The elements and cords of a circuit. Elements have the indices of the circuit.
pub(super) struct Wiring<'c> {
    pub circuit: &'c Circuit,
    /// The cords into each element, each with the element from which it comes.
    pub cords: Vec<Vec<(usize, Cord)>>,
    /// The cords from each element: the element that each leads to, and its index among the cords of that element.
    pub readers: Vec<Vec<(usize, usize)>>,
    /// The place of each element. `None` for references.
    pub places: Vec<Option<Place>>,
    /// The scale of each output that a signal or a drive has, by the index of the element. An output without a scale has
    /// no entry.
    pub scales: BTreeMap<usize, Vec<usize>>,
    /// Whether each output has a signal.
    pub has_signal: Vec<bool>,
}

impl<'c> Wiring<'c> {
    /// The wiring of a circuit.
    pub(super) fn new(circuit: &'c Circuit) -> Self {
        let count = circuit.elements().len();
        let cords: Vec<Vec<(usize, Cord)>> = (0..count).map(|element| circuit.cords(element)).collect();
        let mut readers = vec![Vec::new(); count];
        for (element, own) in cords.iter().enumerate() {
            for (index, (from, _)) in own.iter().enumerate() {
                readers[*from].push((element, index));
            }
        }
        let (mut scales, mut has_signal) = (BTreeMap::<usize, Vec<usize>>::new(), vec![false; count]);
        let is_ground = |element: usize| circuit.element(element).name == GROUND;
        let signals = circuit.signals()[..circuit.patch().signals.len()].iter();
        for signal in signals.filter(|signal| !is_ground(signal.element)) {
            has_signal[signal.element] = true;
            if let Some(scale) = signal.scale {
                scales.entry(signal.element).or_default().push(scale);
            }
        }
        for (element, entry) in circuit.elements().into_iter().enumerate() {
            if let Some(scale) = entry.scale {
                scales.entry(element).or_default().push(scale);
            }
        }
        Wiring { circuit, cords, readers, places: places(circuit), scales, has_signal }
    }

    /// The number of elements, with references and drives.
    pub(super) fn len(&self) -> usize {
        self.cords.len()
    }

    /// The name of an element.
    pub(super) fn name(&self, element: usize) -> &'c str {
        let circuit: &'c Circuit = self.circuit;
        &circuit.element(element).name
    }

    /// The name of an element with its line in the text of the patch, for messages: "A3 (line 50)".
    pub(super) fn located(&self, element: usize) -> String {
        let (patch, name) = (self.circuit.patch(), self.name(element));
        let entry = patch.elements.get(name).or_else(|| patch.drives.get(name));
        match entry.and_then(|entry| patch.text().get(..entry.span.start)) {
            Some(before) => format!("{name} (line {})", before.matches('\n').count() + 1),
            None => name.to_owned(),
        }
    }

    /// The kind of an element.
    pub(super) fn kind(&self, element: usize) -> &'static Kind {
        self.circuit.element(element).kind
    }

    /// Whether an element is a reference, also ground.
    pub(super) fn is_reference(&self, element: usize) -> bool {
        self.kind(element).family == Family::Reference
    }

    /// The voltage of a reference. `None` for other elements.
    pub(super) fn reference(&self, element: usize) -> Option<f64> {
        let own = self.is_reference(element).then(|| self.name(element))?;
        REFERENCES.iter().find(|(name, _)| *name == own).map(|(_, volts)| *volts)
    }

    /// Whether an element is ground.
    pub(super) fn is_ground(&self, element: usize) -> bool {
        self.is_reference(element) && self.name(element) == GROUND
    }

    /// The outputs that are plugged into an input, without ground.
    pub(super) fn sources(&self, element: usize, input: &str) -> Vec<usize> {
        let cords = self.cords[element].iter();
        let own = cords.filter(|(_, cord)| self.kind(element).inputs[cord.input].name == input);
        own.map(|(from, _)| *from).filter(|from| !self.is_ground(*from)).collect()
    }

    /// The output whose scale an input has. If a comparing input is grounded, that with which it is compared.
    pub(super) fn source(&self, element: usize, input: &str) -> Option<usize> {
        let own = self.sources(element, input).first().copied();
        let against = || self.sources(element, "against").first().copied();
        if input == "in" { own.or_else(against) } else { own }
    }

    /// Whether a cord leads to a jack with a gain.
    pub(super) fn has_gain(&self, element: usize, cord: usize) -> bool {
        self.kind(element).inputs[self.cords[element][cord].1.input].jacks == Jacks::Gains
    }

    /// Whether the inputs of an element act on the rate of its output, per machine second.
    pub(super) fn integrates(&self, element: usize) -> bool {
        self.kind(element).transfer == Transfer::Integrating
    }

    /// The gains that the machine has for an element. Empty if it has all gains.
    pub(super) fn gains(&self, element: usize) -> &'static [f64] {
        self.circuit.input_gains(element)
    }

    /// Whether the output of an element is its setting times its input.
    pub(super) fn is_pot(&self, element: usize) -> bool {
        match self.kind(element).name {
            "pot" => true,
            "free-pot" => self.sources(element, "end").is_empty() && !self.has_reference_ends(element),
            _ => false,
        }
    }

    /// Whether both ends of a free pot are references.
    pub(super) fn has_reference_ends(&self, element: usize) -> bool {
        self.kind(element).name == "free-pot"
            && self.cords[element].iter().all(|(from, _)| self.is_reference(*from))
    }

    /// The voltages at the top and at the other end of a free pot between two references. `None` for other elements.
    pub(super) fn reference_ends(&self, element: usize) -> Option<[f64; 2]> {
        let volts = |input: &str| {
            let mut cords = self.cords[element].iter();
            let own = cords.find(|(_, cord)| self.kind(element).inputs[cord.input].name == input);
            own.and_then(|(from, _)| self.reference(*from))
        };
        self.has_reference_ends(element).then(|| Some([volts("in")?, volts("end")?]))?
    }

    /// The only cord from a pot, if it leads to a jack with a gain and no signal is read there: the element and the index
    /// of the cord. The setting of the pot then makes any ratio of the scales possible. A cord into a macro from outside
    /// does not count, because its gain is the same in all instances.
    pub(super) fn gain_behind(&self, element: usize) -> Option<(usize, usize)> {
        let [(reader, cord)] = self.readers[element][..] else { return None };
        let instance =
            |element: usize| self.places[element].as_ref().and_then(|place| place.instance.as_ref());
        let is_free = self.is_pot(element)
            && !self.has_signal[element]
            && self.has_gain(reader, cord)
            && (instance(reader).is_none() || instance(reader) == instance(element));
        is_free.then_some((reader, cord))
    }

    /// The formula of a setting. `None` if the patch does not give it, and if it is no number.
    pub(super) fn formula(&self, element: usize, setting: &str) -> Option<&'c Formula> {
        let circuit: &'c Circuit = self.circuit;
        let entry = circuit.element(element);
        match &entry.settings[entry.kind.setting(setting)?].as_ref()?.value {
            Amount::Formula(formula) => Some(formula),
            _ => None,
        }
    }

    /// The chosen word of a setting.
    pub(super) fn word(&self, element: usize, setting: &str) -> Option<&'static str> {
        let entry = self.circuit.element(element);
        let index = entry.kind.setting(setting)?;
        match (&entry.settings[index].as_ref()?.value, entry.kind.settings[index].quantity) {
            (Amount::Choice(choice), SettingQuantity::Choice(words)) => words.get(*choice).copied(),
            _ => None,
        }
    }

    /// The value of a key of an element in the document. Dots in the key separate nested keys.
    pub(super) fn written(&self, element: usize, key: &str) -> Option<&'c Value> {
        let circuit: &'c Circuit = self.circuit;
        let place = self.places[element].as_ref()?;
        let mut keys = place.path.iter().map(String::as_str).chain(key.split('.'));
        keys.try_fold(circuit.patch().value(), |value, key| value.get(key))
    }

    /// The path of a key of an element in the document. `None` for references.
    pub(super) fn path(&self, element: usize, key: &str) -> Option<Vec<String>> {
        let place = self.places[element].as_ref()?;
        Some(place.path.iter().cloned().chain(key.split('.').map(str::to_owned)).collect())
    }

    /// An element and the same element of its macro in other instances.
    pub(super) fn twins(&self, element: usize) -> impl Iterator<Item = usize> {
        (0..self.len()).filter(move |other| *other == element || self.are_twins(element, *other))
    }

    /// Whether two elements are the same element of a macro, in different instances.
    pub(super) fn are_twins(&self, one: usize, other: usize) -> bool {
        match (&self.places[one], &self.places[other]) {
            (Some(one), Some(other)) => one.instance.is_some() && one.path == other.path,
            _ => false,
        }
    }
}

/// The places of all elements in the document.
fn places(circuit: &Circuit) -> Vec<Option<Place>> {
    let patch = circuit.patch();
    let document = patch.value();
    let mut inside = BTreeMap::new();
    for (instance, entry) in &patch.instances {
        for member in &entry.members {
            let Some(inner) = member.strip_prefix(instance.as_str()).and_then(|rest| rest.strip_prefix('.'))
            else {
                continue;
            };
            if document["macros"][&entry.macro_name]["elements"].get(inner).is_some() {
                let path =
                    ["macros", entry.macro_name.as_str(), "elements", inner].map(str::to_owned).to_vec();
                inside.insert(member.as_str(), Place { path, instance: Some(instance.clone()) });
            }
        }
    }
    let place = |name: &str, section: &str| {
        let is_written = document[section].get(name).is_some();
        let path = vec![section.to_owned(), name.to_owned()];
        if is_written { Some(Place { path, instance: None }) } else { inside.get(name).cloned() }
    };
    let elements = circuit.elements().into_iter();
    let of = |family: Family, name: &str| match family {
        Family::Reference => None,
        Family::Drive => place(name, "drives"),
        Family::Computing => place(name, "elements"),
    };
    elements.map(|element| of(element.kind.family, &element.name)).collect()
}
