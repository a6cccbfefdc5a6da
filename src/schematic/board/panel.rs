//! The panel: rows of modules with their jacks.

use std::collections::BTreeMap;

use super::Module;
use crate::circuit::Circuit;
use crate::machines::Part;
use crate::plot::{Align, Area, Ink, Label, Stroke, text_within};
use crate::schematic::layout::Point;
use crate::schematic::shapes::{NAME, PRINT, SMALL};
use crate::schematic::symbol::{Jack, Setting, Source, Symbol, Value};

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
    /// Where the cord into a jack of a symbol is plugged in.
    pub plugs: BTreeMap<Plug, Point>,
    pub rows: Vec<(String, Point)>,
    pub bottom: f64,
    references: Vec<(&'static str, usize)>,
}

impl Laid {
    /// The module of a reference.
    pub fn reference(&self, name: &str) -> usize {
        self.references.iter().find(|(other, _)| *other == name).map_or(0, |(_, module)| *module)
    }
}

/// A jack, by the indices of the symbol and of the jack in it.
type Plug = (usize, usize);

/// A module before it has a place.
#[derive(Default)]
struct Wanted {
    name: String,
    note: String,
    /// What stands beside its input jacks, and which jack each is, where a cord can go into it.
    inputs: Vec<(String, Option<Plug>)>,
    outputs: usize,
    symbol: Option<usize>,
    reference: Option<&'static str>,
}

/// A row of modules of one sort.
struct Shelf {
    heading: String,
    across: usize,
    modules: Vec<Wanted>,
}

/// Lays the panel out from a corner on: sources above, then the parts of the machine, then switches.
pub(super) fn lay(circuit: &Circuit, symbols: &[Symbol], corner: Point) -> Laid {
    let readers = readers(symbols);
    let mut shelves = vec![sources(circuit, symbols, &readers)];
    for part in Part::ALL {
        shelves.push(shelf(circuit, symbols, &readers, *part));
    }
    let without = symbols.iter().enumerate().filter(|(_, symbol)| {
        circuit.patch().elements.contains_key(&symbol.name) && circuit.parts_of(&symbol.name).is_empty()
    });
    let modules = without.map(|(index, symbol)| main_module(symbol, index, readers[index])).collect();
    shelves.push(Shelf { heading: "switches".to_owned(), across: 12, modules });
    let mut laid = Laid {
        modules: vec![],
        module_of: vec![0; symbols.len()],
        plugs: BTreeMap::new(),
        rows: vec![],
        bottom: corner.1,
        references: vec![],
    };
    shelves.into_iter().filter(|shelf| !shelf.modules.is_empty()).for_each(|shelf| laid.put(shelf, corner.0));
    laid
}

/// For every symbol, the number of cords that leave it.
fn readers(symbols: &[Symbol]) -> Vec<usize> {
    let mut readers = vec![0; symbols.len()];
    for jack in symbols.iter().flat_map(|symbol| &symbol.jacks) {
        if let Source::Output(index, _) = jack.from {
            readers[index] += 1;
        }
    }
    readers
}

/// References with a jack for every cord, and drives.
fn sources(circuit: &Circuit, symbols: &[Symbol], readers: &[usize]) -> Shelf {
    let plugged = |name: &str| {
        let jacks = symbols.iter().flat_map(|symbol| &symbol.jacks);
        jacks.filter(|jack| matches!(jack.from, Source::Reference(other) if other == name)).count()
    };
    let references = crate::elements::REFERENCES.iter().map(|(name, _)| Wanted {
        name: name.replace('-', "−"),
        outputs: plugged(name).max(1),
        reference: Some(name),
        ..Wanted::default()
    });
    let drives = symbols.iter().enumerate();
    let drives = drives.filter(|(_, symbol)| circuit.patch().drives.contains_key(&symbol.name));
    let drives = drives.map(|(index, symbol)| main_module(symbol, index, readers[index]));
    Shelf {
        heading: "references and drives".to_owned(),
        across: 12,
        modules: references.chain(drives).collect(),
    }
}

/// All parts of one sort that the machine has, or that the patch uses.
fn shelf(circuit: &Circuit, symbols: &[Symbol], readers: &[usize], part: Part) -> Shelf {
    let mut modules: Vec<Wanted> = Vec::new();
    for (index, symbol) in symbols.iter().enumerate() {
        let parts = circuit.parts_of(&symbol.name);
        let Some((place, (_, count))) = parts.iter().enumerate().find(|(_, (other, _))| *other == part)
        else {
            continue;
        };
        let names = circuit.part_names(&symbol.name, part);
        let helpers = if place == 0 { 1..*count } else { 0..*count };
        if place == 0 {
            let mut module = main_module(symbol, index, readers[index]);
            module.name = [Some(&symbol.name), names.first()]
                .into_iter()
                .flatten()
                .cloned()
                .collect::<Vec<_>>()
                .join(" ");
            modules.push(module);
        }
        modules.extend(helpers.map(|number| {
            let name = names.get(number).cloned().unwrap_or_default();
            helper(symbol, index, (part, number), name)
        }));
    }
    let owned = circuit.machine().count(part).unwrap_or(modules.len());
    while modules.len() < owned {
        modules.push(Wanted { inputs: spare_jacks(circuit, part), outputs: 1, ..Wanted::default() });
    }
    let across = if matches!(part, Part::FixedPot | Part::FreePot) { 12 } else { 8 };
    Shelf { heading: part.noun(), across, modules }
}

/// A part that helps an element: it has the jack that is its own, and is set like the element where it is one of its sort.
fn helper(symbol: &Symbol, index: usize, place: (Part, usize), name: String) -> Wanted {
    let mut module = Wanted { name, note: format!("of {}", symbol.name), ..Wanted::default() };
    let jack =
        own_jack(symbol, place).and_then(|input| symbol.jacks.iter().position(|jack| jack.input == input));
    if let Some(jack) = jack {
        module.inputs = vec![("in".to_owned(), None), (jack_label(&symbol.jacks[jack]), Some((index, jack)))];
        module.note = format!("{} {}", noted(symbol).map_or("", |setting| &setting.shown), module.note);
    }
    module
}

/// Jacks that lie on a part that helps: shape of the element, sort of the part and its number, input.
const OWN_JACKS: &[(&str, (Part, usize), &str)] = &[
    // The second track of the dead zone has a bias of its own (Fig 8.5 (c) of the thesis).
    ("diode-dead-zone", (Part::FreePot, 1), "bias_minus"),
];

fn own_jack(symbol: &Symbol, place: (Part, usize)) -> Option<&'static str> {
    let own = OWN_JACKS.iter().find(|(shape, at, _)| *shape == symbol.shape && *at == place);
    own.map(|(.., input)| *input)
}

/// The jacks of a part that nothing is plugged into.
fn spare_jacks(circuit: &Circuit, part: Part) -> Vec<(String, Option<Plug>)> {
    let gains = match part {
        Part::Summer => circuit.machine().summer_gains,
        Part::Integrator => circuit.machine().integrator_gains,
        Part::FreePot => return vec![(String::new(), None); 2],
        _ => return vec![(String::new(), None)],
    };
    gains.iter().map(|gain| (format!("{gain}"), None)).collect()
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

/// The module that the cords of an element leave from.
fn main_module(symbol: &Symbol, index: usize, readers: usize) -> Wanted {
    let note = noted(symbol).map(|setting| match setting.name.as_str() {
        "initial" => format!("IC {}", setting.shown),
        "limit.upper" => format!("≤ {}", setting.shown),
        _ => setting.shown.clone(),
    });
    let is_elsewhere = |jack: &Jack| {
        OWN_JACKS.iter().any(|(shape, _, input)| *shape == symbol.shape && *input == jack.input)
    };
    let jacks = symbol.jacks.iter().enumerate().filter(|(_, jack)| !is_elsewhere(jack));
    Wanted {
        name: symbol.name.clone(),
        note: note.unwrap_or_default(),
        inputs: jacks.map(|(number, jack)| (jack_label(jack), Some((index, number)))).collect(),
        outputs: readers.max(1),
        symbol: Some(index),
        reference: None,
    }
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
        let jack = |x: f64, number: usize| (x, top + HEAD + 5.0 + PITCH * number as f64);
        let plugs = wanted.inputs.iter().enumerate();
        let plugs = plugs.filter_map(|(number, (_, plug))| Some(((*plug)?, jack(left + INSET, number))));
        self.plugs.extend(plugs);
        let inputs = wanted.inputs.into_iter().enumerate();
        self.modules.push(Module {
            name: wanted.name,
            note: wanted.note,
            corners: [(left, top), (left + width, top + height)],
            inputs: inputs.map(|(number, (name, _))| (name, jack(left + INSET, number))).collect(),
            outputs: (0..wanted.outputs).map(|number| jack(left + width - INSET, number)).collect(),
        });
    }
}

/// Draws modules and jacks without their texts.
pub(super) fn draw(modules: &[Module], marks: &mut Vec<Stroke>) {
    for module in modules {
        let [(left, top), (right, bottom)] = module.corners;
        let corners = vec![(left, top), (right, top), (right, bottom), (left, bottom)];
        let edge = corners.iter().chain(corners.first()).copied().collect();
        marks.push(Stroke::Area { corners: corners.clone(), ink: Ink::Body });
        marks.push(Stroke::Line { points: edge, width: 1.0, ink: Ink::Faint });
        for centre in module.inputs.iter().map(|(_, at)| at).chain(&module.outputs) {
            marks.push(Stroke::Disc { centre: *centre, radius: 4.4, ink: Ink::Page });
            marks.push(Stroke::Ring { centre: *centre, radius: 4.4, width: 1.2, ink: Ink::Soft });
        }
    }
}

/// Writes headings, names, settings and gains on plates in front of the cords.
pub(super) fn draw_texts(modules: &[Module], rows: &[(String, Point)], marks: &mut Vec<Stroke>) {
    for (heading, at) in rows {
        plate(text(heading, *at, PRINT, Align::Start, Ink::Signal), Ink::Page, marks);
    }
    for module in modules {
        let [(left, top), (right, _)] = module.corners;
        let (middle, room) = ((left + right) / 2.0, right - left - 8.0);
        let name = text_within(&module.name, NAME, room);
        plate(text(&name, (middle, top + 14.0), NAME, Align::Middle, Ink::Line), Ink::Body, marks);
        let note = text_within(&module.note, SMALL, room);
        plate(text(&note, (middle, top + 26.0), SMALL, Align::Middle, Ink::Soft), Ink::Body, marks);
        for (name, at) in &module.inputs {
            let label = text_within(name, SMALL, room * 0.6);
            plate(text(&label, (at.0 - 5.0, at.1 - 7.5), SMALL, Align::Start, Ink::Line), Ink::Body, marks);
        }
    }
}

/// A text on a small plate.
fn plate(label: Label, ink: Ink, marks: &mut Vec<Stroke>) {
    if label.text.is_empty() {
        return;
    }
    let Area { left, top, right, bottom } = label.area();
    let (left, right) = (left - 1.0, right + 2.0);
    let corners = vec![(left, top), (right, top), (right, bottom), (left, bottom)];
    marks.push(Stroke::Area { corners, ink });
    marks.push(Stroke::Text(label));
}

fn text(text: &str, at: Point, size: f64, align: Align, ink: Ink) -> Label {
    Label { text: text.to_owned(), at, size, align, ink }
}
