//! Elements that consist of several machine parts.
//!
//! A soft limiter and a diode dead zone are wired from free potentiometers and diode pairs. This module
//! defines the part that has each jack of such an element, and the links between its parts.

use crate::schematic::lists::ListRow;
use crate::schematic::symbol::{Symbol, SymbolSetting};
use patchcord_core::circuit::Circuit;
use patchcord_core::machines::Part;

/// An end of a link, on one of the parts of an element.
///
/// Parts of the same kind are numbered from 0, and so are the inputs of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LinkEnd {
    /// An input of a part: kind, number of the part, number of the input.
    Input(Part, usize, usize),
    /// The output of a part: kind and number of the part.
    Output(Part, usize),
    /// The output of the element.
    ElementOutput,
    /// The summing junction of the element's amplifier.
    Junction,
    /// The output of a reference.
    Reference(&'static str),
}

/// The links of the diode dead zone, Fig 8.5 (c) of the thesis.
///
/// A potentiometer track runs from the signal to each bias, and a diode from each wiper to the output.
const DEAD_ZONE: [[LinkEnd; 2]; 3] = [
    [LinkEnd::Input(Part::FreePot, 0, 0), LinkEnd::Input(Part::FreePot, 1, 0)],
    [LinkEnd::Output(Part::FreePot, 0), LinkEnd::Input(Part::DiodePair, 0, 0)],
    [LinkEnd::Output(Part::FreePot, 1), LinkEnd::Input(Part::DiodePair, 0, 1)],
];

/// Whether an element is a diode dead zone, which consists of two potentiometers and a diode pair.
fn is_dead_zone(symbol: &Symbol) -> bool {
    symbol.shape == "diode-dead-zone"
}

/// Returns the part that has the output of an element. The element is shown in the row of this part.
pub(super) fn main_part(symbol: &Symbol, first: Part) -> Part {
    if is_dead_zone(symbol) { Part::DiodePair } else { first }
}

/// Returns the input of another part on which a jack of the element is; `None` if the jack is on the
/// main part.
pub(super) fn auxiliary_input(symbol: &Symbol, input: &str) -> Option<LinkEnd> {
    let end = match input {
        "in" => LinkEnd::Input(Part::FreePot, 0, 0),
        "bias_plus" => LinkEnd::Input(Part::FreePot, 0, 1),
        "bias_minus" => LinkEnd::Input(Part::FreePot, 1, 1),
        _ => return None,
    };
    is_dead_zone(symbol).then_some(end)
}

/// Whether the setting of the element applies to its parts of this kind.
pub(super) fn is_set_part(symbol: &Symbol, part: Part) -> bool {
    is_dead_zone(symbol) && part == Part::FreePot
}

/// Returns the links between the parts of an element, output first.
pub(super) fn links(symbol: &Symbol) -> Vec<[LinkEnd; 2]> {
    if is_dead_zone(symbol) {
        return DEAD_ZONE.to_vec();
    }
    let limits: Vec<_> = limits(symbol).collect();
    let mut links: Vec<_> =
        limits.iter().flat_map(|(number, reference, _)| limit(*number, reference)).collect();
    if !limits.is_empty() {
        links.push([LinkEnd::Output(Part::DiodePair, 0), LinkEnd::Junction]);
    }
    links
}

/// Returns the diode ends that are the inputs of the diode pair of an element.
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

/// Returns the soft limits of an amplifier.
///
/// Each has the number of its potentiometer, the reference at the far end, and the output voltage at
/// which its diode starts to conduct.
fn limits(symbol: &Symbol) -> impl Iterator<Item = (usize, &'static str, &SymbolSetting)> {
    let limits = [("limit.upper", "-100"), ("limit.lower", "+100")].into_iter();
    let set = limits.filter_map(|(name, reference)| Some((reference, symbol.setting(name)?)));
    set.enumerate().map(|(number, (reference, setting))| (number, reference, setting))
}

/// Returns the links of a soft limiter in the usual circuit.
///
/// The track runs from the output to a reference, and a diode from the wiper to the summing junction.
fn limit(number: usize, reference: &'static str) -> [[LinkEnd; 2]; 3] {
    [
        [LinkEnd::ElementOutput, LinkEnd::Input(Part::FreePot, number, 0)],
        [LinkEnd::Reference(reference), LinkEnd::Input(Part::FreePot, number, 1)],
        [LinkEnd::Output(Part::FreePot, number), LinkEnd::Input(Part::DiodePair, 0, number)],
    ]
}

/// Returns a row for each potentiometer that is adjusted by observation instead of by a setting.
pub(super) fn adjustments(circuit: &Circuit, symbols: &[Symbol]) -> Vec<ListRow> {
    let row = |symbol: &Symbol, number: usize, level: &SymbolSetting| {
        let names = circuit.part_names(&symbol.name, Part::FreePot);
        let name = names.get(number).cloned().unwrap_or_else(|| format!("free pot of {}", symbol.name));
        ListRow::new(&name, "", &format!("turn until {} stops at {}", symbol.name, level.shown))
    };
    symbols
        .iter()
        .flat_map(|symbol| limits(symbol).map(move |(number, _, level)| row(symbol, number, level)))
        .collect()
}
