//! Elements made of several parts: which part their jacks are on, and how the parts are joined.

use crate::schematic::lists::Row;
use crate::schematic::symbol::{Setting, Symbol};
use patchcord_core::circuit::Circuit;
use patchcord_core::machines::Part;

/// A jack that a link goes to, on the parts of an element; parts of a sort have numbers, and so have their inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spot {
    /// An input of a part.
    Input(Part, usize, usize),
    /// An output of a part.
    Output(Part, usize),
    /// The output of the element.
    Own,
    /// The summing junction of the element's amplifier.
    Junction,
    /// An output of a reference.
    Reference(&'static str),
}

/// The diode dead zone of Fig 8.5 (c) of the thesis: a track from the signal to each bias, from each wiper a diode to the
/// output.
const DEAD_ZONE: [[Spot; 2]; 3] = [
    [Spot::Input(Part::FreePot, 0, 0), Spot::Input(Part::FreePot, 1, 0)],
    [Spot::Output(Part::FreePot, 0), Spot::Input(Part::DiodePair, 0, 0)],
    [Spot::Output(Part::FreePot, 1), Spot::Input(Part::DiodePair, 0, 1)],
];

fn is_dead_zone(symbol: &Symbol) -> bool {
    symbol.shape == "diode-dead-zone"
}

/// The part that the cords of an element leave from, and so the row that it stands in.
pub(super) fn main_part(symbol: &Symbol, first: Part) -> Part {
    if is_dead_zone(symbol) { Part::DiodePair } else { first }
}

/// The input of a helping part that a jack of the element is.
pub(super) fn elsewhere(symbol: &Symbol, input: &str) -> Option<Spot> {
    let place = match input {
        "in" => Spot::Input(Part::FreePot, 0, 0),
        "bias_plus" => Spot::Input(Part::FreePot, 0, 1),
        "bias_minus" => Spot::Input(Part::FreePot, 1, 1),
        _ => return None,
    };
    is_dead_zone(symbol).then_some(place)
}

/// Whether parts of a sort are set as the element says.
pub(super) fn is_set(symbol: &Symbol, part: Part) -> bool {
    is_dead_zone(symbol) && part == Part::FreePot
}

/// The links between an element's parts, from output to input.
pub(super) fn links(symbol: &Symbol) -> Vec<[Spot; 2]> {
    if is_dead_zone(symbol) {
        return DEAD_ZONE.to_vec();
    }
    let limits: Vec<_> = limits(symbol).collect();
    let mut links: Vec<_> =
        limits.iter().flat_map(|(number, reference, _)| limit(*number, reference)).collect();
    if !limits.is_empty() {
        links.push([Spot::Output(Part::DiodePair, 0), Spot::Junction]);
    }
    links
}

/// Which ends of its diodes an element's diode pair has as inputs.
pub(super) fn diodes(symbol: &Symbol) -> Vec<&'static str> {
    match symbol.shape {
        "diode-dead-zone" => vec!["cathode", "anode"],
        "diode-lower-of" => vec!["cathode"; 2],
        "diode-upper-of" => vec!["anode"; 2],
        _ => limits(symbol)
            .map(|(_, reference, _)| if reference == "-100" { "anode" } else { "cathode" })
            .collect(),
    }
}

/// The soft limits of an amplifier: number of the potentiometer, reference at its other end, output where it conducts.
fn limits(symbol: &Symbol) -> impl Iterator<Item = (usize, &'static str, &Setting)> {
    let limits = [("limit.upper", "-100"), ("limit.lower", "+100")].into_iter();
    let set = limits.filter_map(|(name, reference)| Some((reference, symbol.setting(name)?)));
    set.enumerate().map(|(number, (reference, setting))| (number, reference, setting))
}

/// A soft limiter as handbooks have it: a track from the output to a reference, from its wiper a diode to the junction.
fn limit(number: usize, reference: &'static str) -> [[Spot; 2]; 3] {
    [
        [Spot::Own, Spot::Input(Part::FreePot, number, 0)],
        [Spot::Reference(reference), Spot::Input(Part::FreePot, number, 1)],
        [Spot::Output(Part::FreePot, number), Spot::Input(Part::DiodePair, 0, number)],
    ]
}

/// How potentiometers without a setting of their own are set.
pub(super) fn turned(circuit: &Circuit, symbols: &[Symbol]) -> Vec<Row> {
    let row = |symbol: &Symbol, number: usize, level: &Setting| {
        let names = circuit.part_names(&symbol.name, Part::FreePot);
        let name = names.get(number).cloned().unwrap_or_else(|| format!("free pot of {}", symbol.name));
        Row::new(&name, "", &format!("turn until {} stops at {}", symbol.name, level.shown))
    };
    symbols
        .iter()
        .flat_map(|symbol| limits(symbol).map(move |(number, _, level)| row(symbol, number, level)))
        .collect()
}
