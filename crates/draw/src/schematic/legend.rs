//! All symbols on one sheet.

use super::number_text::{format_four_digits, format_fraction, format_volts};
use super::shapes::{self, PRINT};
use super::symbol::{CordSource, Jack, SettingValue, Symbol, SymbolOutput, SymbolSetting};
use crate::plot::{Align, Drawing, Ink, Label, Primitive};
use patchcord_core::elements::{
    Family, Jacks, Kind, REGISTRY, Setting as SettingRow, SettingDefault, SettingQuantity,
};

/// The number of symbols in a row.
const COLUMNS: usize = 6;
/// The width and height of the cell of a symbol.
const CELL: (f64, f64) = (172.0, 150.0);
/// The margin around the sheet.
const MARGIN: f64 = 10.0;

/// Returns a drawing with the symbol of every kind of element and drive and the name of the kind.
///
/// The symbols are in the order of the registry of elements, from left to right and from the top down.
///
/// # Examples
///
/// ```
/// use patchcord_draw::schematic::legend;
///
/// let drawing = legend();
/// let mut labels = drawing.primitives.iter().filter_map(|primitive| primitive.label());
/// assert!(labels.any(|label| label.text == "summer"));
/// ```
pub fn legend() -> Drawing {
    let rows = REGISTRY.len().div_ceil(COLUMNS);
    let mut drawing = Drawing {
        width: 2.0 * MARGIN + COLUMNS as f64 * CELL.0,
        height: 2.0 * MARGIN + rows as f64 * CELL.1,
        primitives: Vec::new(),
    };
    for (index, kind) in REGISTRY.iter().enumerate() {
        let left = MARGIN + (index % COLUMNS) as f64 * CELL.0;
        let top = MARGIN + (index / COLUMNS) as f64 * CELL.1;
        let art = shapes::draw(&example(kind));
        let area = art.area();
        let by = (
            (left + CELL.0 / 2.0 - (area.left + area.right) / 2.0).round(),
            (top + (CELL.1 - 24.0) / 2.0 - (area.top + area.bottom) / 2.0).round(),
        );
        drawing.primitives.extend(art.primitives.into_iter().map(|primitive| primitive.moved(by)));
        let at = (left + CELL.0 / 2.0, top + CELL.1 - 8.0);
        let name = Label::new(kind.name, at, PRINT, Align::Middle, Ink::Signal);
        drawing.primitives.push(Primitive::Text(name));
    }
    drawing
}

/// Returns a symbol of a kind with example settings.
///
/// A required summing input gets a jack with gain 10 and one with gain 1. Optional inputs have no jack.
fn example(kind: &'static Kind) -> Symbol {
    let jacks = kind.inputs.iter().filter(|input| input.required).flat_map(|input| {
        let gains: &[Option<f64>] = match input.jacks {
            Jacks::Gains => &[Some(10.0), Some(1.0)],
            Jacks::Exactly(2) => &[None, None],
            _ => &[None],
        };
        gains.iter().map(|gain| Jack {
            input: input.name.to_owned(),
            gain: *gain,
            from: CordSource::Output(0, 0),
        })
    });
    Symbol {
        name: if kind.family == Family::Drive { "v_i" } else { "A1" }.to_owned(),
        kind: kind.name.to_owned(),
        shape: kind.symbol,
        jacks: jacks.collect(),
        settings: kind.settings.iter().filter_map(setting).collect(),
        parts: Vec::new(),
        outputs: vec![SymbolOutput::default()],
        position: None,
        inside: Vec::new(),
        note: String::new(),
    }
}

/// Returns an example of a setting; `None` if the setting is absent by default.
///
/// A required lower level is -10 V, another required voltage is 10 V, and any other required number is 0.25.
fn setting(row: &SettingRow) -> Option<SymbolSetting> {
    let number = match (row.default, row.name.contains("lower") || row.name == "drop_out") {
        (SettingDefault::Absent, _) => return None,
        (SettingDefault::Number(number), _) => number,
        (SettingDefault::Required, true) => -10.0,
        (SettingDefault::Required, false) if row.quantity == SettingQuantity::Volts => 10.0,
        (SettingDefault::Required, false) => 0.25,
    };
    let (value, shown) = match row.quantity {
        SettingQuantity::Flag => (SettingValue::Flag(number != 0.0), String::new()),
        SettingQuantity::Choice(words) => (SettingValue::Word(words.get(number as usize)?), String::new()),
        SettingQuantity::Fraction => (SettingValue::Number(number), format_fraction(number)),
        SettingQuantity::Volts => (SettingValue::Number(number), format_volts(number)),
        SettingQuantity::MachineSeconds => {
            (SettingValue::Number(number), format!("{} s", format_four_digits(number)))
        }
        SettingQuantity::Points | SettingQuantity::Curve(_) => {
            (SettingValue::Points(CURVE.to_vec()), String::new())
        }
        _ => (SettingValue::Number(number), format_four_digits(number)),
    };
    Some(SymbolSetting { name: row.name.to_owned(), formula: None, value, shown, is_given: true })
}

/// The curve of the function generator in the legend.
const CURVE: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 3.0], [2.0, 4.0], [3.0, 1.5], [4.0, 2.0]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_its_symbol() {
        for kind in REGISTRY {
            let has_shape = shapes::SHAPES.iter().any(|(name, ..)| *name == kind.symbol);
            assert!(has_shape, "{}: src/schematic/shapes has no symbol {}", kind.name, kind.symbol);
            let symbol = example(kind);
            assert!(shapes::draw(&symbol).inputs.len() >= symbol.jacks.len(), "{}", kind.name);
        }
    }
}
