//! The changes that are tried: gains, cords, signs, pots, scales, initial values and the time scale.

use std::collections::HashSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::{Jacks, Kind, SettingQuantity};
use patchcord_core::patch::{Edit, ElementEntry};
use patchcord_expr::{Unit, format_significant, round_significant};
use serde_json::{Map, Value, json};

use super::Candidate;

/// The gains that summing inputs of the machines have.
const GAINS: [&str; 4] = ["x1", "x10", "x100", "x1000"];

/// The order of the mistakes: the likeliest ones have the least cost.
mod cost {
    pub(super) const GAIN: u32 = 10;
    pub(super) const SIGN: u32 = 10;
    pub(super) const INITIAL: u32 = 10;
    pub(super) const UNUSED_CORD: u32 = 12;
    pub(super) const POT: u32 = 14;
    pub(super) const UNIT: u32 = 12;
    pub(super) const SCALE: u32 = 16;
    pub(super) const TIME_SCALE: u32 = 16;
    pub(super) const INVERTER: u32 = 20;
    pub(super) const REMOVED_CORD: u32 = 22;
    pub(super) const SIGNAL_SIGN: u32 = 24;
    pub(super) const MOVED_CORD: u32 = 26;
    pub(super) const ADDED_CORD: u32 = 30;
    /// A gain and a pot that do not fit each other make a change of one of them likelier.
    pub(super) const FITTING: u32 = 5;
}

/// All candidates, in the order of the patch.
pub(super) fn candidates(circuit: &Circuit) -> Vec<Candidate> {
    let patch = circuit.patch();
    let cords: usize = patch.elements.values().map(|entry| entry.plugs.len()).sum();
    let is_large = cords.saturating_mul(patch.elements.len()) > MAX_PAIRS;
    let mut found = Found { circuit, candidates: Vec::new(), is_large };
    for (name, entry) in &circuit.patch().elements {
        if circuit.patch().value()["elements"].get(name).is_some() {
            found.element(name, entry);
        }
    }
    found.scales();
    found.signals();
    found.time_scale();
    found.candidates
}

/// The candidates so far.
struct Found<'a> {
    circuit: &'a Circuit,
    candidates: Vec<Candidate>,
    /// Whether the patch is too large to try every cord from every output.
    is_large: bool,
}

impl Found<'_> {
    /// Adds a candidate.
    fn push(&mut self, cost: u32, description: String, edits: Vec<Edit>) {
        self.candidates.push(Candidate { description, edits, cost });
    }

    /// The changes at one element.
    fn element(&mut self, name: &str, entry: &ElementEntry) {
        if entry.kind.has_gains() {
            self.gains(name, entry);
            self.added_cords(name, entry);
        }
        self.sources(name, entry);
        self.settings(name, entry);
    }

    /// The cords of an element with gains, as in the document.
    fn cords(&self, name: &str) -> Map<String, Value> {
        self.circuit.patch().value()["elements"][name]["in"].as_object().cloned().unwrap_or_default()
    }

    /// A cord in a jack with another gain, or no cord.
    fn gains(&mut self, name: &str, entry: &ElementEntry) {
        for plug in entry.plugs.iter().filter(|plug| GAINS.contains(&plug.jack.value.as_str())) {
            let (jack, source) = (&plug.jack.value, &plug.from.value);
            let without = without_cord(self.cords(name), jack, source);
            for other in GAINS.iter().filter(|other| *other != jack) {
                let with = with_cord(without.clone(), other, source);
                let fits = fits_pot(self.circuit, source, gain(other))
                    && !fits_pot(self.circuit, source, gain(jack));
                let decades = (gain(other) / gain(jack)).log10().abs() as u32;
                let cost = if fits { cost::GAIN - cost::FITTING } else { cost::GAIN + 3 * (decades - 1) };
                let description = format!("plug {source} into {other} of {name} in place of {jack}");
                self.push(cost, description, vec![Edit::at(["elements", name, "in"], Value::Object(with))]);
            }
            let description = format!("remove the cord from {source} to {name}");
            let edit = Edit::at(["elements", name, "in"], Value::Object(without));
            self.push(cost::REMOVED_CORD, description, vec![edit]);
        }
    }

    /// A further cord to an element.
    fn added_cords(&mut self, name: &str, entry: &ElementEntry) {
        let read = self.read_outputs();
        for source in self.outputs() {
            let is_plugged = entry.plugs.iter().any(|plug| plug.from.value == source);
            if is_plugged || source == name {
                continue;
            }
            let is_read = read.contains(&source);
            if is_read && self.is_large {
                continue;
            }
            let cost = if is_read { cost::ADDED_CORD } else { cost::UNUSED_CORD };
            for jack in GAINS {
                let fits = fits_pot(self.circuit, &source, gain(jack));
                let with = with_cord(self.cords(name), jack, &source);
                let description = format!("plug {source} into {jack} of {name}");
                let edit = Edit::at(["elements", name, "in"], Value::Object(with));
                self.push(if fits { cost } else { cost + cost::FITTING }, description, vec![edit]);
            }
        }
    }

    /// A cord from another output, or through an inverter.
    fn sources(&mut self, name: &str, entry: &ElementEntry) {
        let read = self.read_outputs();
        for (index, plug) in entry.plugs.iter().enumerate() {
            let source = &plug.from.value;
            for other in self.outputs() {
                if other == *source || other == name {
                    continue;
                }
                let cost = if self.is_inverse(source, &other) {
                    cost::SIGN
                } else if read.contains(&other) && self.is_large {
                    continue;
                } else if read.contains(&other) {
                    cost::MOVED_CORD
                } else {
                    cost::UNUSED_CORD
                };
                if let Some(edit) = self.replugged(name, entry, index, &other) {
                    self.push(cost, format!("plug {other} into {name} in place of {source}"), vec![edit]);
                }
            }
            let inverter = self.new_name();
            if let Some(edit) = self.replugged(name, entry, index, &inverter) {
                let added = Edit::at(["elements", &inverter], json!({"kind": "inverter", "in": source}));
                let description = format!("put an inverter between {source} and {name}");
                self.push(cost::INVERTER, description, vec![edit, added]);
            }
        }
    }

    /// The change of one cord to another source.
    fn replugged(&self, name: &str, entry: &ElementEntry, index: usize, to: &str) -> Option<Edit> {
        let plug = &entry.plugs[index];
        let (jack, source) = (&plug.jack.value, &plug.from.value);
        let input = input_of(entry.kind, jack)?;
        if entry.kind.has_gains() && input == 0 {
            let without = without_cord(self.cords(name), jack, source);
            return Some(Edit::at(["elements", name, "in"], Value::Object(with_cord(without, jack, to))));
        }
        let value = &self.circuit.patch().value()["elements"][name][jack.as_str()];
        match value {
            Value::String(_) => Some(Edit::at(["elements", name, jack.as_str()], json!(to))),
            Value::Array(list) => {
                let replaced =
                    list.iter().map(|item| if item == source.as_str() { json!(to) } else { item.clone() });
                Some(Edit::at(["elements", name, jack.as_str()], Value::Array(replaced.collect())))
            }
            _ => None,
        }
    }

    /// The settings of an element: that of a pot, and the initial value.
    fn settings(&mut self, name: &str, entry: &ElementEntry) {
        let written = self.circuit.patch().value()["elements"][name].clone();
        for (setting, value) in entry.kind.settings.iter().zip(&entry.settings) {
            if value.is_none() {
                continue;
            }
            let present = &written[setting.name];
            if setting.quantity == SettingQuantity::Fraction {
                self.pot(name, setting.name, present);
            } else if setting.name == "initial" {
                let negative = negated(present);
                let edit = Edit::at(["elements", name, "initial"], negative.clone());
                self.push(
                    cost::INITIAL,
                    format!("give {name} the initial value {}", shown(&negative)),
                    vec![edit],
                );
                for factor in POWERS {
                    let other = multiplied(present, factor);
                    let edit = Edit::at(["elements", name, "initial"], other.clone());
                    let description = format!("give {name} the initial value {}", shown(&other));
                    self.push(cost::INITIAL + cost::FITTING, description, vec![edit]);
                }
            }
        }
    }

    /// The setting of a pot times powers of ten, times or over the time scale, and times or over scales and parameters.
    fn pot(&mut self, name: &str, setting: &str, present: &Value) {
        let mut push = |cost: u32, value: Value| {
            let edit = Edit::at(["elements", name, setting], value.clone());
            let description = format!("set {name} to {}", shown(&value));
            self.candidates.push(Candidate { description, edits: vec![edit], cost });
        };
        for factor in POWERS {
            push(cost::POT, multiplied(present, factor));
        }
        let patch = self.circuit.patch();
        let mut names: Vec<&str> = if patch.time_scale == 1.0 { Vec::new() } else { vec!["time_scale"] };
        names.extend(patch.parameters.keys().chain(patch.scales.keys()).map(String::as_str));
        for factor in names {
            push(cost::POT + 2, json!(format!("({}) * {factor}", plain(present))));
            push(cost::POT + 2, json!(format!("({}) / {factor}", plain(present))));
        }
    }

    /// Scales a thousand times larger or smaller, as after a wrong prefix of a unit.
    fn scales(&mut self) {
        let patch = self.circuit.patch();
        for (name, scale) in &patch.scales {
            self.units(name, scale.unit.text());
            let present = &patch.value()["scales"][name]["per_volt"];
            for factor in [1e3, 1e-3, 10.0, 0.1, 100.0, 0.01, 1e6, 1e-6] {
                let other = multiplied(present, factor);
                let unit = scale.unit.text();
                let description = format!("let 1 V of the scale {name} be {} {unit}", shown(&other));
                let cost =
                    if [1e3, 1e-3].contains(&factor) { cost::SCALE } else { cost::SCALE + cost::FITTING };
                self.push(cost, description, vec![Edit::at(["scales", name.as_str(), "per_volt"], other)]);
            }
        }
    }

    /// The unit of a scale with another prefix.
    fn units(&mut self, name: &str, unit: &str) {
        let others = self.circuit.patch().scales.iter().filter(|(other, _)| *other != name);
        let others: Vec<&str> = others.map(|(_, scale)| scale.unit.text()).collect();
        let present = Unit::parse(unit).map_or(f64::NAN, |unit| unit.factor());
        let stripped = unit.strip_prefix(['m', 'k', 'u']).unwrap_or_default();
        let renamed = ["m", "k", "u"].map(|prefix| format!("{prefix}{unit}"));
        for other in renamed.into_iter().chain([stripped.to_owned()]) {
            let Ok(parsed) = Unit::parse(&other) else { continue };
            let ratio = parsed.factor() / present;
            let is_prefix = [1e3, 1e-3, 1e6, 1e-6].iter().any(|power| (ratio / power - 1.0).abs() < 1e-9);
            if is_prefix && Unit::parse(unit).is_ok_and(|unit| unit.dimension() == parsed.dimension()) {
                // A prefix that another scale has too is likelier.
                let first = |text: &str| text.chars().take(2).collect::<String>();
                let is_common = others.iter().any(|text| first(text) == first(&other));
                let cost = if is_common { cost::UNIT - cost::FITTING } else { cost::UNIT };
                let edit = Edit::at(["scales", name, "unit"], json!(other));
                self.push(cost, format!("give the scale {name} the unit {other}"), vec![edit]);
            }
        }
    }

    /// Signals with the opposite sign.
    fn signals(&mut self) {
        for (name, signal) in &self.circuit.patch().signals {
            let factor = -signal.factor;
            let description =
                format!("give the signal {name} the factor {}", format_significant(factor, DIGITS));
            self.push(
                cost::SIGNAL_SIGN,
                description,
                vec![Edit::at(["signals", name.as_str(), "factor"], json!(factor))],
            );
        }
    }

    /// No time scale.
    fn time_scale(&mut self) {
        let time_scale = self.circuit.time_scale();
        if time_scale != 1.0 {
            let edit = vec![Edit::at(["time_scale"], json!(1))];
            self.push(cost::TIME_SCALE, "set time_scale to 1".to_owned(), edit);
        }
    }

    /// The outputs that can be plugged in: drives, elements of the document and references.
    fn outputs(&self) -> Vec<String> {
        let patch = self.circuit.patch();
        let references = ["+100", "-100"].map(str::to_owned);
        patch.drives.keys().chain(patch.elements.keys()).cloned().chain(references).collect()
    }

    /// The outputs that are read by a cord or a signal.
    fn read_outputs(&self) -> HashSet<String> {
        let patch = self.circuit.patch();
        let cords =
            patch.elements.values().flat_map(|entry| &entry.plugs).map(|plug| plug.from.value.clone());
        cords.chain(["+100", "-100"].map(str::to_owned)).collect()
    }

    /// Whether one of two elements inverts the other with gain 1.
    fn is_inverse(&self, one: &str, other: &str) -> bool {
        let inverts = |element: &str, source: &str| {
            self.circuit.patch().elements.get(element).is_some_and(|entry| {
                let is_amplifier = ["inverter", "summer"].contains(&entry.kind.name);
                is_amplifier
                    && matches!(entry.plugs.as_slice(), [plug] if plug.from.value == source
                        && ["x1", "in"].contains(&plug.jack.value.as_str()))
            })
        };
        inverts(one, other) || inverts(other, one)
    }

    /// A name that no element has.
    fn new_name(&self) -> String {
        let patch = self.circuit.patch();
        let is_free = |name: &String| !patch.elements.contains_key(name) && !patch.drives.contains_key(name);
        (1..).map(|index| format!("N{index}")).find(is_free).unwrap_or_default()
    }
}

/// Products of the numbers of cords and elements up to which every cord is tried from every output.
const MAX_PAIRS: usize = 10_000;
/// Powers of ten by which settings are often wrong.
const POWERS: [f64; 6] = [10.0, 0.1, 100.0, 0.01, 1000.0, 0.001];
/// Significant digits of a changed number. Fewer than those of f64, so that 0.1 x 3 is 0.3.
const DIGITS_KEPT: usize = 12;
/// Significant digits of a factor in a description.
const DIGITS: usize = 6;

/// The index of the input to which a jack belongs.
fn input_of(kind: &Kind, jack: &str) -> Option<usize> {
    let index = kind.input(jack)?.0;
    let is_known = kind.inputs[index].jacks != Jacks::Gains || index == 0;
    is_known.then_some(index)
}

/// The gain in the name of a jack.
fn gain(jack: &str) -> f64 {
    jack.trim_start_matches('x').parse().unwrap_or(1.0)
}

/// Whether the powers of ten in the setting of a pot are those of the gain behind it: "k / 10" fits x10, "k" fits x1.
/// False if the source is no pot with a formula.
fn fits_pot(circuit: &Circuit, source: &str, gain: f64) -> bool {
    let Some(text) = circuit.patch().value()["elements"][source]["setting"].as_str() else { return false };
    let compact: String = text.split_whitespace().collect();
    let powers = ["10", "100", "1000"];
    let by_division = powers.iter().find(|power| {
        compact.ends_with(&format!("/{power}"))
            || compact.contains(&format!("/{power}*"))
            || compact.contains(&format!("/{power}/"))
    });
    let decimals = [("0.1*", 10.0), ("0.01*", 100.0), ("0.001*", 1000.0)];
    let by_decimal = decimals.iter().find(|(prefix, _)| compact.starts_with(prefix)).map(|(_, gain)| *gain);
    by_division.map(|power| gain_of(power)).or(by_decimal).unwrap_or(1.0) == gain
}

/// The number in a text such as "100".
fn gain_of(power: &str) -> f64 {
    power.parse().unwrap_or(1.0)
}

/// The cords of an element without one of them.
fn without_cord(mut cords: Map<String, Value>, jack: &str, source: &str) -> Map<String, Value> {
    let mut is_empty = false;
    match cords.get_mut(jack) {
        Some(Value::Array(list)) => {
            if let Some(position) = list.iter().position(|item| item == source) {
                list.remove(position);
            }
            is_empty = list.is_empty();
        }
        Some(Value::String(_)) => is_empty = true,
        _ => {}
    }
    if is_empty {
        cords.shift_remove(jack);
    }
    cords
}

/// The cords of an element with a further one.
fn with_cord(mut cords: Map<String, Value>, jack: &str, source: &str) -> Map<String, Value> {
    let list = cords.entry(jack.to_owned()).or_insert_with(|| json!([]));
    if let Value::String(only) = list {
        *list = json!([only]);
    }
    if let Value::Array(list) = list {
        list.push(json!(source));
    }
    cords
}

/// A formula or number as the text of a formula.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// A formula or number as a message shows it.
fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), |text| format!("\"{text}\""))
}

/// A number, without decimals if it is whole.
fn json_number(number: f64) -> Value {
    if number.fract() == 0.0 && number.abs() < 1e15 { json!(number as i64) } else { json!(number) }
}

/// The negative of a formula or number.
fn negated(value: &Value) -> Value {
    match (value.as_f64(), value.as_str()) {
        (Some(number), _) => json_number(-number),
        (None, Some(text)) => match text.strip_prefix('-') {
            Some(positive) if !positive.contains(['+', '-']) => json!(positive.trim_start()),
            _ if text.contains(['+', '-']) => json!(format!("-({text})")),
            _ => json!(format!("-{text}")),
        },
        _ => Value::Null,
    }
}

/// A formula or number times a power of ten. A factor at the end of the formula is changed if it has one.
fn multiplied(value: &Value, factor: f64) -> Value {
    if let Some(number) = value.as_f64() {
        return json_number(round_significant(number * factor, DIGITS_KEPT));
    }
    let text = plain(value);
    if let Some((rest, last)) = text.rsplit_once('/')
        && let Ok(divisor) = last.trim().parse::<f64>()
    {
        let divisor = divisor / factor;
        let rest = rest.trim_end();
        return if divisor == 1.0 {
            json!(rest)
        } else {
            json!(format!("{rest} / {}", format_significant(divisor, DIGITS)))
        };
    }
    if factor >= 1.0 {
        json!(format!("({text}) * {}", format_significant(factor, DIGITS)))
    } else {
        json!(format!("({text}) / {}", format_significant(1.0 / factor, DIGITS)))
    }
}
