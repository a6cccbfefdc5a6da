//! All symbols on one sheet.

use super::shapes::{self, PRINT};
use super::symbol::{Jack, Outlet, Setting, Source, Symbol, Value, digits, share, volts};
use crate::plot::{Align, Drawing, Ink, Label, Stroke};
use patchcord_core::elements::{Default, Family, Jacks, Kind, Measure, REGISTRY, Setting as SettingRow};

/// Symbols side by side, and the room of each.
const ACROSS: usize = 6;
const ROOM: (f64, f64) = (172.0, 150.0);
const MARGIN: f64 = 10.0;

/// The symbol of every kind of element and drive, with the name of the kind below it.
pub fn legend() -> Drawing {
    let rows = REGISTRY.len().div_ceil(ACROSS);
    let mut drawing = Drawing {
        width: 2.0 * MARGIN + ACROSS as f64 * ROOM.0,
        height: 2.0 * MARGIN + rows as f64 * ROOM.1,
        marks: Vec::new(),
    };
    for (index, kind) in REGISTRY.iter().enumerate() {
        let left = MARGIN + (index % ACROSS) as f64 * ROOM.0;
        let top = MARGIN + (index / ACROSS) as f64 * ROOM.1;
        let art = shapes::draw(&example(kind));
        let area = art.area();
        let by = (
            (left + ROOM.0 / 2.0 - (area.left + area.right) / 2.0).round(),
            (top + (ROOM.1 - 24.0) / 2.0 - (area.top + area.bottom) / 2.0).round(),
        );
        drawing.marks.extend(art.marks.into_iter().map(|mark| mark.moved(by)));
        drawing.marks.push(Stroke::Text(Label {
            text: kind.name.to_owned(),
            at: (left + ROOM.0 / 2.0, top + ROOM.1 - 8.0),
            size: PRINT,
            align: Align::Middle,
            ink: Ink::Signal,
        }));
    }
    drawing
}

/// A symbol of the kind, set in some way.
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
            from: Source::Output(0, 0),
        })
    });
    Symbol {
        name: if kind.family == Family::Drive { "v_i" } else { "A1" }.to_owned(),
        kind: kind.name.to_owned(),
        shape: kind.symbol,
        jacks: jacks.collect(),
        settings: kind.settings.iter().filter_map(setting).collect(),
        parts: Vec::new(),
        outlets: vec![Outlet::default()],
        position: None,
        inside: Vec::new(),
        note: String::new(),
    }
}

fn setting(row: &SettingRow) -> Option<Setting> {
    let number = match (row.default, row.name.contains("lower") || row.name == "drop_out") {
        (Default::Absent, _) => return None,
        (Default::Number(number), _) => number,
        (Default::Required, true) => -10.0,
        (Default::Required, false) if row.measure == Measure::Volts => 10.0,
        (Default::Required, false) => 0.25,
    };
    let (value, shown) = match row.measure {
        Measure::Flag => (Value::Flag(number != 0.0), String::new()),
        Measure::Choice(words) => (Value::Word(words.get(number as usize)?), String::new()),
        Measure::Fraction => (Value::Number(number), share(number)),
        Measure::Volts => (Value::Number(number), volts(number)),
        Measure::MachineSeconds => (Value::Number(number), format!("{} s", digits(number))),
        Measure::Points | Measure::Curve(_) => (Value::Points(CURVE.to_vec()), String::new()),
        _ => (Value::Number(number), digits(number)),
    };
    Some(Setting { name: row.name.to_owned(), formula: None, value, shown, is_given: true })
}

const CURVE: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 3.0], [2.0, 4.0], [3.0, 1.5], [4.0, 2.0]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_its_symbol() {
        for kind in REGISTRY {
            let known = shapes::SHAPES.iter().any(|(name, ..)| *name == kind.symbol);
            assert!(known, "{}: src/schematic/shapes has no symbol {}", kind.name, kind.symbol);
            let symbol = example(kind);
            assert!(shapes::draw(&symbol).inputs.len() >= symbol.jacks.len(), "{}", kind.name);
        }
    }
}
