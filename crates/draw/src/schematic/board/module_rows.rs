//! The rows of modules of a panel, before they have positions.
//!
//! The first row has the references and drives. Then follows a row for each kind of part that the
//! machine has or the patch uses, and at the end the key switches. All modules of a row have the same
//! jacks. An element with several parts has its jacks on the parts to which `composites` assigns them.

use super::composites::{self, LinkEnd};
use crate::plot::with_minus_sign;
use crate::schematic::symbol::{CordSource, Jack, SettingValue, Symbol, SymbolSetting};
use patchcord_core::circuit::Circuit;
use patchcord_core::machines::Part;

/// A jack: the indices of the symbol and of the jack in the symbol.
pub(super) type JackId = (usize, usize);

/// A part of an element: the index of the symbol, the kind of the part and its number.
pub(super) type PartId = (usize, Part, usize);

/// An input jack: its label, and the jack of the symbol if it has one.
pub(super) type InputSlot = (String, Option<JackId>);

/// The label of the summing junction of an amplifier.
pub(super) const JUNCTION: &str = "SJ";

/// A module without a position.
#[derive(Default)]
pub(super) struct ModuleSpec {
    /// The name of the element or of the part; empty for a part that is not used.
    pub name: String,
    /// The kind of the element; empty if the heading of the row contains it.
    pub kind: String,
    /// The setting, or the element to which an auxiliary part belongs.
    pub note: String,
    /// The input jacks from the top down, with and without cords.
    pub inputs: Vec<InputSlot>,
    /// The number of output jacks.
    pub outputs: usize,
    /// The symbol whose output the module has.
    pub symbol: Option<usize>,
    /// The part of an element that the module is; `None` for references, drives and switches.
    pub part: Option<PartId>,
    /// The name of the reference; `None` for any other module.
    pub reference: Option<&'static str>,
}

/// A row of modules of one kind. It may need several lines.
pub(super) struct ModuleRow {
    /// The heading, such as the name of the kind of part.
    pub heading: String,
    /// The number of modules in a line.
    pub across: usize,
    /// The modules from left to right.
    pub modules: Vec<ModuleSpec>,
}

impl ModuleRow {
    /// Returns a row. A module does not repeat a kind that the heading contains.
    fn new(heading: String, across: usize, mut modules: Vec<ModuleSpec>) -> ModuleRow {
        let repeating = modules.iter_mut().filter(|module| heading.contains(&module.kind));
        repeating.for_each(|module| module.kind.clear());
        ModuleRow { heading, across, modules }
    }
}

/// Returns the rows of a panel from the top down; rows without modules are omitted.
pub(super) fn of(circuit: &Circuit, symbols: &[Symbol]) -> Vec<ModuleRow> {
    let builder = RowBuilder { circuit, symbols, links: symbols.iter().map(composites::links).collect() };
    let mut rows = vec![builder.sources()];
    rows.extend(Part::ALL.iter().map(|part| builder.part_row(*part)));
    rows.push(builder.switches());
    rows.retain(|row| !row.modules.is_empty());
    rows
}

/// The symbols of a circuit and, for each, the links between its parts.
struct RowBuilder<'a> {
    /// The circuit, for its machine and its parts.
    circuit: &'a Circuit,
    /// The symbols of all elements and drives.
    symbols: &'a [Symbol],
    /// For each symbol, the links between its parts, output first.
    links: Vec<Vec<[LinkEnd; 2]>>,
}

impl RowBuilder<'_> {
    /// Returns the number of cords and links from the output of a symbol.
    fn output_count(&self, index: usize) -> usize {
        let jacks = self.symbols.iter().flat_map(|symbol| &symbol.jacks);
        let cords = jacks.filter(|jack| matches!(jack.from, CordSource::Output(from, _) if from == index));
        cords.count() + self.links[index].iter().filter(|[from, _]| *from == LinkEnd::ElementOutput).count()
    }

    /// Returns the number of cords and links from a reference.
    fn reference_count(&self, name: &'static str) -> usize {
        let jacks = self.symbols.iter().flat_map(|symbol| &symbol.jacks);
        let cords = jacks.filter(|jack| matches!(jack.from, CordSource::Reference(other) if other == name));
        let links = self.links.iter().flatten().filter(|[from, _]| *from == LinkEnd::Reference(name));
        cords.count() + links.count()
    }

    /// Returns the row of references, with a jack for every cord, and drives.
    fn sources(&self) -> ModuleRow {
        let references = patchcord_core::elements::REFERENCES.iter().map(|(name, _)| ModuleSpec {
            name: with_minus_sign(name),
            outputs: self.reference_count(name).max(1),
            reference: Some(name),
            ..ModuleSpec::default()
        });
        let drives = (0..self.symbols.len())
            .filter(|index| self.circuit.patch().drives.contains_key(&self.symbols[*index].name));
        let drives = drives.map(|index| self.main_module(index, &[]));
        ModuleRow::new("references and drives".to_owned(), 12, references.chain(drives).collect())
    }

    /// Returns the row of elements without machine parts, which are the key switches.
    fn switches(&self) -> ModuleRow {
        let without = (0..self.symbols.len()).filter(|index| {
            let name = &self.symbols[*index].name;
            self.circuit.patch().elements.contains_key(name) && self.circuit.parts_of(name).is_empty()
        });
        let modules = without.map(|index| self.main_module(index, &[])).collect();
        ModuleRow::new("key switches".to_owned(), 12, modules)
    }

    /// Returns the row of all parts of one kind that the machine has or the patch uses.
    fn part_row(&self, part: Part) -> ModuleRow {
        let jacks = self.jacks_of(part);
        let used = self.used_parts(part);
        let mut modules: Vec<ModuleSpec> = used.into_iter().map(|part| self.module(part, &jacks)).collect();
        if let Some(owned) = self.circuit.machine().count(part) {
            let idle = || ModuleSpec { inputs: idle(&jacks), outputs: 1, ..ModuleSpec::default() };
            modules.resize_with(owned, idle);
            let outputs = modules.iter().map(|module| module.outputs).max().unwrap_or(0);
            modules.iter_mut().for_each(|module| module.outputs = outputs);
        }
        let across = if matches!(part, Part::FixedPot | Part::FreePot) { 12 } else { 8 };
        ModuleRow::new(part.noun(), across, modules)
    }

    /// Returns the parts of one kind that elements use.
    fn used_parts(&self, part: Part) -> Vec<PartId> {
        let used = self.symbols.iter().enumerate().flat_map(|(index, symbol)| {
            let parts = self.circuit.parts_of(&symbol.name);
            let count = parts.iter().find(|(other, _)| *other == part).map_or(0, |(_, count)| *count);
            (0..count).map(move |number| (index, part, number))
        });
        used.collect()
    }

    /// Whether the output of an element is on a part of this kind.
    fn is_main(&self, index: usize, part: Part) -> bool {
        let symbol = &self.symbols[index];
        let first = self.circuit.parts_of(&symbol.name).first().map(|(first, _)| *first);
        first.is_some_and(|first| composites::main_part(symbol, first) == part)
    }

    /// Returns the labels of the input jacks of every part of a kind.
    ///
    /// For each gain there are as many jacks as the element with the most inputs of this gain needs.
    fn jacks_of(&self, part: Part) -> Vec<String> {
        let gains = match part {
            Part::Summer => self.circuit.machine().summer_gains,
            Part::Integrator => self.circuit.machine().integrator_gains,
            _ => return named_jacks(part).iter().map(|name| (*name).to_owned()).collect(),
        };
        let mains: Vec<_> = (0..self.symbols.len())
            .filter(|index| self.is_main(*index, part))
            .map(|index| self.plugs(index))
            .collect();
        let max_count = |label: &str| {
            let counts = mains.iter().map(|plugs| plugs.iter().filter(|(other, _)| other == label).count());
            counts.max().unwrap_or(0)
        };
        let labels = gains.iter().map(|gain| gain.to_string());
        let mut jacks: Vec<_> =
            labels.flat_map(|label| vec![label.clone(); max_count(&label).max(1)]).collect();
        jacks.extend((!gains.is_empty() && max_count(JUNCTION) > 0).then(|| JUNCTION.to_owned()));
        jacks
    }

    /// Returns the input jacks in use on the main module of an element.
    fn plugs(&self, index: usize) -> Vec<InputSlot> {
        let symbol = &self.symbols[index];
        let is_inverter = symbol.kind == "inverter" && !self.circuit.machine().summer_gains.is_empty();
        let label = |jack: &Jack| match is_inverter {
            true => "1".to_owned(),
            false => jack_label(&jack.input, jack.gain),
        };
        let here = symbol.jacks.iter().enumerate();
        let here = here.filter(|(_, jack)| composites::auxiliary_input(symbol, &jack.input).is_none());
        let mut plugs: Vec<_> = here.map(|(number, jack)| (label(jack), Some((index, number)))).collect();
        let is_joined = self.links[index].iter().any(|[_, to]| *to == LinkEnd::Junction);
        plugs.extend(is_joined.then(|| (JUNCTION.to_owned(), None)));
        plugs
    }

    /// Returns the module of a part of an element.
    fn module(&self, id: PartId, jacks: &[String]) -> ModuleSpec {
        let (index, part, number) = id;
        let symbol = &self.symbols[index];
        let names = self.circuit.part_names(&symbol.name, part);
        let name = names.get(number).cloned().unwrap_or_default();
        let mut module = if number == 0 && self.is_main(index, part) {
            let module = self.main_module(index, jacks);
            ModuleSpec { name: format!("{} {name}", symbol.name).trim_end().to_owned(), ..module }
        } else {
            auxiliary_module(symbol, id, name, jacks)
        };
        if part == Part::DiodePair {
            let ends = composites::diodes(symbol);
            module.inputs.iter_mut().zip(ends).for_each(|((label, _), end)| end.clone_into(label));
        }
        ModuleSpec { part: Some(id), ..module }
    }

    /// Returns the module with the output of an element.
    fn main_module(&self, index: usize, jacks: &[String]) -> ModuleSpec {
        let symbol = &self.symbols[index];
        let mut inputs = idle(jacks);
        for (label, plug) in self.plugs(index) {
            match inputs.iter_mut().find(|(other, taken)| *other == label && taken.is_none()) {
                Some((_, free)) => *free = plug,
                None => inputs.push((label, plug)),
            }
        }
        ModuleSpec {
            name: symbol.name.clone(),
            kind: symbol.kind.replace('-', " "),
            note: main_note(symbol),
            inputs,
            outputs: self.output_count(index).max(1),
            symbol: Some(index),
            ..ModuleSpec::default()
        }
    }
}

/// Returns the module of an auxiliary part, with the jacks of the element that are on it.
///
/// Its note is the setting, if it applies to the part, and the element: `0.2537 of DZ`.
fn auxiliary_module(
    symbol: &Symbol,
    (index, part, number): PartId,
    name: String,
    jacks: &[String],
) -> ModuleSpec {
    let mut inputs = idle(jacks);
    for (plug, jack) in symbol.jacks.iter().enumerate() {
        match composites::auxiliary_input(symbol, &jack.input) {
            Some(LinkEnd::Input(other, other_number, slot)) if (other, other_number) == (part, number) => {
                inputs[slot] = (jack_label(&jack.input, jack.gain), Some((index, plug)));
            }
            _ => (),
        }
    }
    let setting = noted_setting(symbol).filter(|_| composites::is_set_part(symbol, part));
    let note = setting.map(|setting| format!("{} ", setting.shown)).unwrap_or_default();
    let note = format!("{note}of {}", symbol.name);
    let outputs = usize::from(!jacks.is_empty());
    ModuleSpec { name, note, inputs, outputs, ..ModuleSpec::default() }
}

/// Returns input jacks without cords.
fn idle(jacks: &[String]) -> Vec<InputSlot> {
    jacks.iter().map(|label| (label.clone(), None)).collect()
}

/// Returns the labels of the input jacks of a part without gains.
fn named_jacks(part: Part) -> &'static [&'static str] {
    match part {
        Part::FreePot => &["in", "end"],
        Part::DiodePair => &["in", "in"],
        Part::Multiplier => &["a", "b"],
        Part::Relay => &["in", "on", "off", "against"],
        Part::TrackHold => &["in", "track"],
        // These are jacks of the integrator.
        Part::Rebound | Part::Brake | Part::ModeRelay => &[],
        _ => &["in"],
    }
}

/// Returns the label of a jack of an input.
///
/// A gain stands for a summing input: `10`. Another input is named before its gain: `brake 10`.
///
/// # Examples
///
/// ```
/// use patchcord_draw::schematic::jack_label;
///
/// assert_eq!(jack_label("x", Some(10.0)), "10");
/// assert_eq!(jack_label("brake_x", Some(1.0)), "brake 1");
/// assert_eq!(jack_label("bias_plus", None), "+VB");
/// ```
pub fn jack_label(input: &str, gain: Option<f64>) -> String {
    match gain {
        Some(gain) if input == "x" => format!("{gain}"),
        Some(gain) => format!("{} {gain}", input.trim_end_matches("_x")),
        None => input.replace("bias_plus", "+VB").replace("bias_minus", "−VB"),
    }
}

/// Returns the setting that is written on the module of an element.
fn noted_setting(symbol: &Symbol) -> Option<&SymbolSetting> {
    ["setting", "initial", "limit.upper"].iter().find_map(|name| symbol.setting(name))
}

/// Whether a module shows a setting, or may omit it because it is a number that the patch does not
/// specify.
pub(super) fn shows_setting(symbol: &Symbol, setting: &SymbolSetting) -> bool {
    let is_number = matches!(setting.value, SettingValue::Number(_));
    noted_setting(symbol).is_some_and(|noted| noted.name == setting.name) || is_number && !setting.is_given
}

/// Returns the text of the setting on the main module of an element.
fn main_note(symbol: &Symbol) -> String {
    let here = noted_setting(symbol).filter(|_| !composites::is_set_part(symbol, Part::FreePot));
    let text = here.map(|setting| match setting.name.as_str() {
        "initial" => format!("IC {}", setting.shown),
        "limit.upper" => format!("≤ {}", setting.shown),
        _ => setting.shown.clone(),
    });
    text.unwrap_or_default()
}
