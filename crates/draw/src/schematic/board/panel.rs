//! The panel: rows of modules with their jacks.

use std::collections::BTreeMap;

use super::Module;
use super::network::{self, Spot};
use crate::schematic::layout::Point;
use crate::schematic::symbol::{Jack, Setting, Source, Symbol, Value};
use patchcord_core::circuit::Circuit;
use patchcord_core::machines::Part;

/// Width of the panel.
pub(super) const WIDTH: f64 = 1080.0;

/// Distance of jacks, room above the first one of a module, and of the jacks from its edge.
const PITCH: f64 = 21.0;
const HEAD: f64 = 40.0;
const INSET: f64 = 11.0;

/// Room between modules, and for the heading of a row.
const GAP: f64 = 6.0;
const ROW_HEAD: f64 = 18.0;

/// The panel laid out.
pub(super) struct Laid {
    pub modules: Vec<Module>,
    /// For every symbol the module that its cords leave from.
    pub module_of: Vec<usize>,
    /// The modules of an element's parts, by the symbol, the sort of the part and its number.
    parts: BTreeMap<Place, usize>,
    /// Where the cord into a jack of a symbol is plugged in.
    pub plugs: BTreeMap<Plug, Point>,
    pub rows: Vec<(String, Point)>,
    pub bottom: f64,
    references: Vec<(&'static str, usize)>,
    /// How many output jacks of each module have a cord.
    taken: Vec<usize>,
}

impl Laid {
    /// The module of a reference.
    pub fn reference(&self, name: &str) -> usize {
        self.references.iter().find(|(other, _)| *other == name).map_or(0, |(_, module)| *module)
    }

    /// The next free output jack of a module.
    pub fn output(&mut self, module: usize) -> Point {
        self.taken[module] += 1;
        self.modules[module].outputs[self.taken[module] - 1]
    }

    /// The jack in which a link of a symbol ends.
    pub fn jack(&mut self, symbol: usize, spot: Spot) -> Option<Point> {
        let module = match spot {
            Spot::Input(part, number, _) | Spot::Output(part, number) => {
                *self.parts.get(&(symbol, part, number))?
            }
            Spot::Own | Spot::Junction => self.module_of[symbol],
            Spot::Reference(name) => self.reference(name),
        };
        let inputs = &self.modules[module].inputs;
        match spot {
            Spot::Input(.., slot) => inputs.get(slot).map(|(_, at)| *at),
            Spot::Junction => inputs.iter().find(|(label, _)| label == JUNCTION).map(|(_, at)| *at),
            _ => Some(self.output(module)),
        }
    }
}

/// A jack, by the indices of the symbol and of the jack in it.
type Plug = (usize, usize);

/// A part of an element, by the index of the symbol, its sort and its number.
type Place = (usize, Part, usize);

/// An input jack: what stands beside it, and which jack it is, where a cord can go into it.
type Slot = (String, Option<Plug>);

/// What stands beside the summing junction of an amplifier.
const JUNCTION: &str = "SJ";

/// A module before it has a place.
#[derive(Default)]
struct Wanted {
    name: String,
    kind: String,
    note: String,
    inputs: Vec<Slot>,
    outputs: usize,
    /// The symbol whose cords leave it.
    symbol: Option<usize>,
    part: Option<Place>,
    reference: Option<&'static str>,
}

/// A row of modules of one sort.
struct Shelf {
    heading: String,
    across: usize,
    modules: Vec<Wanted>,
}

impl Shelf {
    /// A row; modules do not repeat a kind that its heading says.
    fn new(heading: String, across: usize, mut modules: Vec<Wanted>) -> Shelf {
        let plain = modules.iter_mut().filter(|module| heading.contains(&module.kind));
        plain.for_each(|module| module.kind.clear());
        Shelf { heading, across, modules }
    }
}

/// Lays the panel out from a corner on: sources above, then the parts of the machine, then switches.
pub(super) fn lay(circuit: &Circuit, symbols: &[Symbol], corner: Point) -> Laid {
    let patched = Patched { circuit, symbols, links: symbols.iter().map(network::links).collect() };
    let mut shelves = vec![patched.sources()];
    shelves.extend(Part::ALL.iter().map(|part| patched.shelf(*part)));
    shelves.push(patched.switches());
    let mut laid = Laid {
        modules: vec![],
        module_of: vec![0; symbols.len()],
        parts: BTreeMap::new(),
        plugs: BTreeMap::new(),
        rows: vec![],
        bottom: corner.1,
        references: vec![],
        taken: vec![],
    };
    shelves.into_iter().filter(|shelf| !shelf.modules.is_empty()).for_each(|shelf| laid.put(shelf, corner.0));
    laid
}

/// What is plugged together: symbols, and for each the links between its parts.
struct Patched<'a> {
    circuit: &'a Circuit,
    symbols: &'a [Symbol],
    links: Vec<Vec<[Spot; 2]>>,
}

impl Patched<'_> {
    /// The number of cords and links that leave a symbol.
    fn readers(&self, index: usize) -> usize {
        let jacks = self.symbols.iter().flat_map(|symbol| &symbol.jacks);
        let cords = jacks.filter(|jack| matches!(jack.from, Source::Output(from, _) if from == index));
        cords.count() + self.links[index].iter().filter(|[from, _]| *from == Spot::Own).count()
    }

    /// The number of cords and links that leave a reference.
    fn plugged(&self, name: &'static str) -> usize {
        let jacks = self.symbols.iter().flat_map(|symbol| &symbol.jacks);
        let cords = jacks.filter(|jack| matches!(jack.from, Source::Reference(other) if other == name));
        let links = self.links.iter().flatten().filter(|[from, _]| *from == Spot::Reference(name));
        cords.count() + links.count()
    }

    /// References with a jack for every cord, and drives.
    fn sources(&self) -> Shelf {
        let references = patchcord_core::elements::REFERENCES.iter().map(|(name, _)| Wanted {
            name: name.replace('-', "−"),
            outputs: self.plugged(name).max(1),
            reference: Some(name),
            ..Wanted::default()
        });
        let drives = (0..self.symbols.len())
            .filter(|index| self.circuit.patch().drives.contains_key(&self.symbols[*index].name));
        let drives = drives.map(|index| self.main_module(index, &[]));
        Shelf::new("references and drives".to_owned(), 12, references.chain(drives).collect())
    }

    /// Elements that take no part that machines have a number of.
    fn switches(&self) -> Shelf {
        let without = (0..self.symbols.len()).filter(|index| {
            let name = &self.symbols[*index].name;
            self.circuit.patch().elements.contains_key(name) && self.circuit.parts_of(name).is_empty()
        });
        let modules = without.map(|index| self.main_module(index, &[])).collect();
        Shelf::new("key switches".to_owned(), 12, modules)
    }

    /// All parts of one sort that the machine has, or that the patch uses.
    fn shelf(&self, part: Part) -> Shelf {
        let jacks = self.jacks_of(part);
        let taken = self.taken(part);
        let mut modules: Vec<Wanted> = taken.into_iter().map(|place| self.module(place, &jacks)).collect();
        if let Some(owned) = self.circuit.machine().count(part) {
            let idle = || Wanted { inputs: idle(&jacks), outputs: 1, ..Wanted::default() };
            modules.resize_with(owned, idle);
            let outputs = modules.iter().map(|module| module.outputs).max().unwrap_or(0);
            modules.iter_mut().for_each(|module| module.outputs = outputs);
        }
        let across = if matches!(part, Part::FixedPot | Part::FreePot) { 12 } else { 8 };
        Shelf::new(part.noun(), across, modules)
    }

    /// The parts of one sort that elements take.
    fn taken(&self, part: Part) -> Vec<Place> {
        let places = self.symbols.iter().enumerate().flat_map(|(index, symbol)| {
            let parts = self.circuit.parts_of(&symbol.name);
            let count = parts.iter().find(|(other, _)| *other == part).map_or(0, |(_, count)| *count);
            (0..count).map(move |number| (index, part, number))
        });
        places.collect()
    }

    /// Whether an element's cords leave from parts of this sort.
    fn is_main(&self, index: usize, part: Part) -> bool {
        let symbol = &self.symbols[index];
        let first = self.circuit.parts_of(&symbol.name).first().map(|(first, _)| *first);
        first.is_some_and(|first| network::main_part(symbol, first) == part)
    }

    /// The input jacks that every part of a sort has: of each gain as many as the fullest element takes.
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
        let fullest = |label: &str| {
            let counts = mains.iter().map(|plugs| plugs.iter().filter(|(other, _)| other == label).count());
            counts.max().unwrap_or(0)
        };
        let labels = gains.iter().map(|gain| gain.to_string());
        let mut jacks: Vec<_> =
            labels.flat_map(|label| vec![label.clone(); fullest(&label).max(1)]).collect();
        jacks.extend((!gains.is_empty() && fullest(JUNCTION) > 0).then(|| JUNCTION.to_owned()));
        jacks
    }

    /// What is plugged into the module that an element's cords leave from.
    fn plugs(&self, index: usize) -> Vec<Slot> {
        let symbol = &self.symbols[index];
        let is_inverter = symbol.kind == "inverter" && !self.circuit.machine().summer_gains.is_empty();
        let label = |jack: &Jack| if is_inverter { "1".to_owned() } else { jack_label(jack) };
        let here = symbol.jacks.iter().enumerate();
        let here = here.filter(|(_, jack)| network::elsewhere(symbol, &jack.input).is_none());
        let mut plugs: Vec<_> = here.map(|(number, jack)| (label(jack), Some((index, number)))).collect();
        let is_joined = self.links[index].iter().any(|[_, to]| *to == Spot::Junction);
        plugs.extend(is_joined.then(|| (JUNCTION.to_owned(), None)));
        plugs
    }

    /// The module of a part that an element takes.
    fn module(&self, place: Place, jacks: &[String]) -> Wanted {
        let (index, part, number) = place;
        let symbol = &self.symbols[index];
        let names = self.circuit.part_names(&symbol.name, part);
        let name = names.get(number).cloned().unwrap_or_default();
        let mut module = if number == 0 && self.is_main(index, part) {
            let module = self.main_module(index, jacks);
            Wanted { name: format!("{} {name}", symbol.name).trim_end().to_owned(), ..module }
        } else {
            helper(symbol, place, name, jacks)
        };
        if part == Part::DiodePair {
            let ways = network::diodes(symbol);
            module.inputs.iter_mut().zip(ways).for_each(|((label, _), way)| way.clone_into(label));
        }
        Wanted { part: Some(place), ..module }
    }

    /// The module that the cords of an element leave from.
    fn main_module(&self, index: usize, jacks: &[String]) -> Wanted {
        let symbol = &self.symbols[index];
        let mut inputs = idle(jacks);
        for (label, plug) in self.plugs(index) {
            match inputs.iter_mut().find(|(other, taken)| *other == label && taken.is_none()) {
                Some((_, free)) => *free = plug,
                None => inputs.push((label, plug)),
            }
        }
        Wanted {
            name: symbol.name.clone(),
            kind: symbol.kind.replace('-', " "),
            note: main_note(symbol),
            inputs,
            outputs: self.readers(index).max(1),
            symbol: Some(index),
            ..Wanted::default()
        }
    }
}

/// A part that helps an element, with the jacks of the element that lie on it.
fn helper(symbol: &Symbol, (index, part, number): Place, name: String, jacks: &[String]) -> Wanted {
    let mut inputs = idle(jacks);
    for (plug, jack) in symbol.jacks.iter().enumerate() {
        match network::elsewhere(symbol, &jack.input) {
            Some(Spot::Input(other, place, slot)) if (other, place) == (part, number) => {
                inputs[slot] = (jack_label(jack), Some((index, plug)));
            }
            _ => (),
        }
    }
    let set = noted(symbol).filter(|_| network::is_set(symbol, part));
    let note = set.map(|setting| format!("{} ", setting.shown)).unwrap_or_default();
    let note = format!("{note}of {}", symbol.name);
    let outputs = usize::from(!jacks.is_empty());
    Wanted { name, note, inputs, outputs, ..Wanted::default() }
}

/// Jacks that nothing is plugged into.
fn idle(jacks: &[String]) -> Vec<Slot> {
    jacks.iter().map(|label| (label.clone(), None)).collect()
}

/// The input jacks of a part without gains.
fn named_jacks(part: Part) -> &'static [&'static str] {
    match part {
        Part::FreePot => &["in", "end"],
        Part::DiodePair => &["in", "in"],
        Part::Multiplier => &["a", "b"],
        Part::Relay => &["in", "on", "off", "against"],
        Part::TrackHold => &["in", "track"],
        // These are jacks of the integrator.
        Part::Rebound | Part::Brake => &[],
        _ => &["in"],
    }
}

/// What stands beside a jack.
fn jack_label(jack: &Jack) -> String {
    match jack.gain {
        Some(gain) if jack.input == "x" => format!("{gain}"),
        Some(gain) => format!("{} {gain}", jack.input.trim_end_matches("_x")),
        None => jack.input.replace("bias_plus", "+VB").replace("bias_minus", "−VB"),
    }
}

/// The setting that is written on the module of an element.
fn noted(symbol: &Symbol) -> Option<&Setting> {
    ["setting", "initial", "limit.upper"].iter().find_map(|name| symbol.setting(name))
}

/// Whether a module tells a setting, or may leave it out: a number that the patch does not give.
pub(super) fn tells(symbol: &Symbol, setting: &Setting) -> bool {
    let is_number = matches!(setting.value, Value::Number(_));
    noted(symbol).is_some_and(|noted| noted.name == setting.name) || is_number && !setting.is_given
}

/// The setting on the module that an element's cords leave from.
fn main_note(symbol: &Symbol) -> String {
    let here = noted(symbol).filter(|_| !network::is_set(symbol, Part::FreePot));
    let told = here.map(|setting| match setting.name.as_str() {
        "initial" => format!("IC {}", setting.shown),
        "limit.upper" => format!("≤ {}", setting.shown),
        _ => setting.shown.clone(),
    });
    told.unwrap_or_default()
}

impl Laid {
    /// Sets a shelf under what stands there already.
    fn put(&mut self, shelf: Shelf, left: f64) {
        self.rows.push((shelf.heading, (left, self.bottom + ROW_HEAD - 5.0)));
        self.bottom += ROW_HEAD;
        let width = (WIDTH + GAP) / shelf.across as f64 - GAP;
        let mut modules = shelf.modules.into_iter().peekable();
        while modules.peek().is_some() {
            let line: Vec<Wanted> = modules.by_ref().take(shelf.across).collect();
            let jacks = line.iter().map(|module| module.inputs.len().max(module.outputs)).max().unwrap_or(0);
            let height = HEAD + PITCH * jacks as f64;
            for (place, wanted) in line.into_iter().enumerate() {
                let corner = (left + place as f64 * (width + GAP), self.bottom);
                self.set(wanted, corner, (width, height));
            }
            self.bottom += height + GAP;
        }
        self.bottom += GAP;
    }

    fn set(&mut self, wanted: Wanted, (left, top): Point, (width, height): (f64, f64)) {
        if let Some(symbol) = wanted.symbol {
            self.module_of[symbol] = self.modules.len();
        }
        self.references.extend(wanted.reference.map(|name| (name, self.modules.len())));
        self.parts.extend(wanted.part.map(|place| (place, self.modules.len())));
        let jack = |x: f64, number: usize| (x, top + HEAD + 5.0 + PITCH * number as f64);
        let plugs = wanted.inputs.iter().enumerate();
        let plugs = plugs.filter_map(|(number, (_, plug))| Some(((*plug)?, jack(left + INSET, number))));
        self.plugs.extend(plugs);
        let inputs = wanted.inputs.into_iter().enumerate();
        self.taken.push(0);
        self.modules.push(Module {
            name: wanted.name,
            kind: wanted.kind,
            note: wanted.note,
            corners: [(left, top), (left + width, top + height)],
            inputs: inputs.map(|(number, (name, _))| (name, jack(left + INSET, number))).collect(),
            outputs: (0..wanted.outputs).map(|number| jack(left + width - INSET, number)).collect(),
        });
    }
}
