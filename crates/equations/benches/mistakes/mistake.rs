//! Random mistakes of the kinds that people make at the patch panel.

use std::fmt;

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::SettingQuantity;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_equations::{Detail, EquationListing, InitialValue, WrittenEquation};
use patchcord_expr::Unit;
use serde_json::{Value, json};

use crate::document::{WrittenCord, cords, edits, plug, replug, unplug, written_elements};
use crate::formula::{wrong_initial_values, wrong_settings};
use crate::inverters::inverses;
use crate::patches::compiled;
use crate::random::SplitMix64;

/// The gains that summing inputs of the machines have.
const GAINS: [&str; 4] = ["x1", "x10", "x100", "x1000"];
/// Prefixes of units.
const PREFIXES: [char; 3] = ['m', 'k', 'u'];

/// A kind of mistake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Class {
    /// A cord comes from the inverse of its output.
    Sign,
    /// A cord is in a jack with another gain.
    Gain,
    /// Two cords have exchanged their outputs.
    SwappedCords,
    /// One cord of a summing input with several cords is missing.
    MissingCord,
    /// A cord comes from a wrong output.
    MovedCord,
    /// The formula of a pot is wrong.
    PotFormula,
    /// An initial value is wrong.
    InitialValue,
    /// The unit of a scale is 1000 times too large or too small.
    ScaleUnit,
}

impl Class {
    /// All kinds, in the order of the table.
    pub(crate) const ALL: [Class; 8] = [
        Class::Sign,
        Class::Gain,
        Class::SwappedCords,
        Class::MissingCord,
        Class::MovedCord,
        Class::PotFormula,
        Class::InitialValue,
        Class::ScaleUnit,
    ];

    /// Its name in the table.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Class::Sign => "sign",
            Class::Gain => "gain",
            Class::SwappedCords => "swapped cords",
            Class::MissingCord => "missing cord",
            Class::MovedCord => "moved cord",
            Class::PotFormula => "pot formula",
            Class::InitialValue => "initial value",
            Class::ScaleUnit => "unit of a scale",
        }
    }

    /// All changes of this kind in a patch. Some of them make the patch invalid, or do not change its equations.
    fn changes(self, patch: &Patch) -> Vec<Change> {
        match self {
            Class::Sign => sign_changes(patch),
            Class::Gain => gain_changes(patch),
            Class::SwappedCords => swaps(patch),
            Class::MissingCord => missing_cords(patch),
            Class::MovedCord => moves(patch),
            Class::PotFormula => pot_changes(patch),
            Class::InitialValue => initial_changes(patch),
            Class::ScaleUnit => unit_changes(patch),
        }
    }
}

/// A change of the document of a correct patch.
#[derive(Debug, Clone)]
enum Change {
    /// A cord comes from another output.
    Replug { cord: WrittenCord, to: String },
    /// A cord is in another jack.
    Regain { cord: WrittenCord, to: &'static str },
    /// Two cords have exchanged their outputs.
    Swap(WrittenCord, WrittenCord),
    /// A cord is missing.
    Unplug(WrittenCord),
    /// A key of an element or of a scale has another value.
    Set { section: &'static str, name: String, key: &'static str, value: Value },
}

impl Change {
    /// Makes the change.
    fn apply(&self, document: &mut Value) {
        match self {
            Change::Replug { cord, to } => replug(document, cord, to),
            Change::Regain { cord, to } => {
                unplug(document, cord);
                plug(document, &cord.element, to, &cord.source);
            }
            Change::Swap(one, other) => {
                replug(document, one, &other.source);
                replug(document, other, &one.source);
            }
            Change::Unplug(cord) => unplug(document, cord),
            Change::Set { section, name, key, value } => document[*section][name][*key] = value.clone(),
        }
    }
}

impl fmt::Display for Change {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Change::Replug { cord, to } => {
                write!(formatter, "{to} is plugged into {} in place of {}", cord.element, cord.source)
            }
            Change::Regain { cord, to } => {
                let WrittenCord { element, jack, source, .. } = cord;
                write!(formatter, "{source} is plugged into {to} of {element} in place of {jack}")
            }
            Change::Swap(one, other) => {
                let [one, other] = [one, other].map(|cord| format!("{} to {}", cord.source, cord.element));
                write!(formatter, "the cords from {one} and from {other} are swapped")
            }
            Change::Unplug(cord) => {
                write!(formatter, "the cord from {} to {} is missing", cord.source, cord.element)
            }
            Change::Set { section, name, key, value } => {
                write!(formatter, "{section}/{name}/{key} is {value}")
            }
        }
    }
}

/// A patch with one mistake. It has no errors, but its wiring has other equations than that of the correct patch.
pub(crate) struct Mistake {
    /// Its kind.
    pub class: Class,
    /// The change, as a clause.
    pub description: String,
    /// The edits of the correct document.
    pub edits: Vec<Edit>,
    /// The wrong patch.
    pub patch: Patch,
    /// The circuit of the wrong patch.
    pub circuit: Circuit,
    /// The program of the wrong patch.
    pub program: Program,
}

impl Mistake {
    /// A random mistake in a correct patch. Each kind that applies is equally likely. `None` if none applies.
    pub(crate) fn random(correct: &Patch, random: &mut SplitMix64) -> Option<Mistake> {
        let (circuit, program) = compiled(correct)?;
        let laws = laws(&circuit, &program);
        let mut classes = Class::ALL.to_vec();
        while !classes.is_empty() {
            let class = classes.swap_remove(random.below(classes.len()));
            let mut changes = class.changes(correct);
            while !changes.is_empty() {
                let change = changes.swap_remove(random.below(changes.len()));
                let mistake = Mistake::made(correct, class, &change);
                // The change of a unit is no mistake if all settings follow the scales, for example.
                let found = mistake.filter(|mistake| self::laws(&mistake.circuit, &mistake.program) != laws);
                if found.is_some() {
                    return found;
                }
            }
        }
        None
    }

    /// A changed patch. `None` if it has errors.
    fn made(correct: &Patch, class: Class, change: &Change) -> Option<Mistake> {
        let mut document = correct.value().clone();
        change.apply(&mut document);
        let edits = edits(correct.value(), &document);
        let patch = correct.with_edits(correct.file(), &edits).ok()?;
        let (circuit, program) = compiled(&patch)?;
        Some(Mistake { class, description: change.to_string(), edits, patch, circuit, program })
    }
}

/// The derived equations and initial values. The conditions of modes are left out, because patches do not state them.
fn laws(circuit: &Circuit, program: &Program) -> Vec<String> {
    let listing = EquationListing::new(circuit, program, Detail::Signals);
    let equations = listing.equations.iter().map(WrittenEquation::text);
    equations.chain(listing.initial.iter().map(InitialValue::text)).collect()
}

/// The outputs that a cord can come from: drives, elements, and all others that the patch uses.
fn outputs(patch: &Patch, cords: &[WrittenCord]) -> Vec<String> {
    let mut outputs: Vec<String> = patch.drives.keys().chain(written_elements(patch)).cloned().collect();
    for cord in cords {
        if !outputs.contains(&cord.source) {
            outputs.push(cord.source.clone());
        }
    }
    outputs
}

/// Whether a cord is at a summing input.
fn is_summing(patch: &Patch, cord: &WrittenCord) -> bool {
    patch.elements.get(&cord.element).is_some_and(|entry| {
        entry.kind.has_gains() && entry.kind.input(&cord.jack).is_some_and(|(input, _)| input == 0)
    })
}

/// Cords from the inverse of their output.
fn sign_changes(patch: &Patch) -> Vec<Change> {
    let changes = cords(patch).into_iter().flat_map(|cord| {
        let mut inverses = inverses(patch, &cord.source);
        inverses.retain(|inverse| *inverse != cord.element);
        inverses.into_iter().map(move |inverse| Change::Replug { cord: cord.clone(), to: inverse.to_owned() })
    });
    changes.collect()
}

/// Cords in a jack with another gain.
fn gain_changes(patch: &Patch) -> Vec<Change> {
    let has_gain = |cord: &WrittenCord| is_summing(patch, cord) && GAINS.contains(&cord.jack.as_str());
    let changes = cords(patch).into_iter().filter(has_gain).flat_map(|cord| {
        let others: Vec<&'static str> = GAINS.into_iter().filter(|gain| *gain != cord.jack).collect();
        others.into_iter().map(move |to| Change::Regain { cord: cord.clone(), to })
    });
    changes.collect()
}

/// Pairs of cords that have exchanged their outputs. No element drives itself afterwards.
fn swaps(patch: &Patch) -> Vec<Change> {
    let cords = cords(patch);
    let mut found = Vec::new();
    for (index, one) in cords.iter().enumerate() {
        for other in &cords[index + 1..] {
            let is_loop = one.source == other.element || other.source == one.element;
            if one.source != other.source && !is_loop {
                found.push(Change::Swap(one.clone(), other.clone()));
            }
        }
    }
    found
}

/// Summing inputs with several cords, without one of them.
fn missing_cords(patch: &Patch) -> Vec<Change> {
    let mut cords = cords(patch);
    cords.retain(|cord| is_summing(patch, cord));
    let has_others =
        |cord: &&WrittenCord| cords.iter().filter(|other| other.element == cord.element).count() > 1;
    cords.iter().filter(has_others).cloned().map(Change::Unplug).collect()
}

/// Cords from an output that is neither the right one nor its inverse.
fn moves(patch: &Patch) -> Vec<Change> {
    let cords = cords(patch);
    let outputs = outputs(patch, &cords);
    let mut found = Vec::new();
    for cord in &cords {
        let inverses = inverses(patch, &cord.source);
        let is_other = |output: &&String| {
            **output != cord.source && **output != cord.element && !inverses.contains(&output.as_str())
        };
        let moved = outputs.iter().filter(is_other);
        found.extend(moved.map(|to| Change::Replug { cord: cord.clone(), to: to.clone() }));
    }
    found
}

/// Wrong settings of pots.
fn pot_changes(patch: &Patch) -> Vec<Change> {
    let is_name = |text: &str| {
        text == "time_scale" || patch.parameters.contains_key(text) || patch.scales.contains_key(text)
    };
    let mut found = Vec::new();
    for name in written_elements(patch) {
        let Some(entry) = patch.elements.get(name) else { continue };
        for (setting, amount) in entry.kind.settings.iter().zip(&entry.settings) {
            if setting.quantity != SettingQuantity::Fraction || amount.is_none() {
                continue;
            }
            let key = setting.name;
            let wrong = wrong_settings(&patch.value()["elements"][name][key], is_name);
            found.extend(wrong.into_iter().map(|value| set("elements", name, key, value)));
        }
    }
    found
}

/// Wrong initial values.
fn initial_changes(patch: &Patch) -> Vec<Change> {
    let mut found = Vec::new();
    for name in written_elements(patch) {
        let wrong = wrong_initial_values(patch, &patch.value()["elements"][name]["initial"]);
        found.extend(wrong.into_iter().map(|value| set("elements", name, "initial", value)));
    }
    found
}

/// Units of scales that are 1000 times too large or too small.
fn unit_changes(patch: &Patch) -> Vec<Change> {
    let mut found = Vec::new();
    for (name, scale) in &patch.scales {
        let unit = scale.unit.text();
        let prefixed = PREFIXES.map(|prefix| format!("{prefix}{unit}"));
        let without_prefix = unit.strip_prefix(PREFIXES).map(str::to_owned);
        for other in prefixed.into_iter().chain(without_prefix) {
            let Ok(parsed) = Unit::parse(&other) else { continue };
            let ratio = parsed.factor() / scale.unit.factor();
            let is_prefix = [1e3, 1e-3].iter().any(|power| (ratio / power - 1.0).abs() < 1e-9);
            if is_prefix && parsed.dimension() == scale.unit.dimension() {
                found.push(set("scales", name, "unit", json!(other)));
            }
        }
    }
    found
}

/// The change of a key of an element or scale.
fn set(section: &'static str, name: &str, key: &'static str, value: Value) -> Change {
    Change::Set { section, name: name.to_owned(), key, value }
}
