//! From the circuit to symbols and lists.

use super::lists::{List, Row};
use super::symbol::{Jack, Setting, Source, Symbol, Value, digits, share};
use crate::circuit::{Circuit, Element};
use crate::elements::{Default, Family, Jacks, Measure, Setting as SettingRow};
use crate::instruments::Display;
use crate::patch::{Amount, Entry, Formula, Unit};

/// The symbols of a circuit, drives first, in the order of the document.
pub(super) fn symbols(circuit: &Circuit, volts: &dyn Fn(&str) -> Option<f64>) -> Vec<Symbol> {
    let elements = circuit.elements();
    let mut numbers = vec![None; elements.len()];
    let drawn = (0..elements.len()).filter(|index| elements[*index].kind.family != Family::Reference);
    drawn.clone().enumerate().for_each(|(number, index)| numbers[index] = Some(number));
    let describer = Describer { circuit, numbers, volts };
    drawn.map(|index| describer.symbol(index, elements[index])).collect()
}

struct Describer<'a> {
    circuit: &'a Circuit,
    /// For every element the number of its symbol.
    numbers: Vec<Option<usize>>,
    volts: &'a dyn Fn(&str) -> Option<f64>,
}

impl Describer<'_> {
    fn symbol(&self, index: usize, element: &Element) -> Symbol {
        let patch = self.circuit.patch();
        let entry = patch.elements.get(&element.name).or_else(|| patch.drives.get(&element.name));
        let signals = patch.signals.iter().filter(|(_, signal)| signal.at.value == element.name);
        Symbol {
            name: element.name.clone(),
            kind: element.kind.name,
            shape: element.kind.symbol,
            jacks: self.jacks(index, element),
            settings: settings(self.circuit, element),
            parts: entry.map(parts).unwrap_or_default(),
            signals: signals.map(|(name, _)| name.clone()).collect(),
            volts: (self.volts)(&element.name),
            note: entry.map(|entry| entry.note.clone()).unwrap_or_default(),
        }
    }

    fn jacks(&self, index: usize, element: &Element) -> Vec<Jack> {
        let mut cords = self.circuit.cords(index);
        cords.sort_by_key(|(_, cord)| cord.input);
        let jack = |(from, cord): (usize, crate::circuit::Cord)| {
            let input = &element.kind.inputs[cord.input];
            Jack {
                input: input.name,
                gain: (input.jacks == Jacks::Gains).then_some(cord.gain),
                from: self.source(from),
            }
        };
        cords.into_iter().map(jack).collect()
    }

    fn source(&self, element: usize) -> Source {
        match self.numbers[element] {
            Some(number) => Source::Output(number),
            None => Source::Reference(reference(&self.circuit.element(element).name)),
        }
    }
}

/// The name of a reference as the machine has it.
fn reference(name: &str) -> &'static str {
    let known = crate::elements::REFERENCES.iter().find(|(known, _)| *known == name);
    known.map_or("ground", |(known, _)| known)
}

fn parts(entry: &Entry) -> Vec<String> {
    entry.uses.iter().flat_map(|(_, names)| names.iter().map(|name| name.value.clone())).collect()
}

fn settings(circuit: &Circuit, element: &Element) -> Vec<Setting> {
    let rows = element.kind.settings.iter().zip(&element.settings);
    rows.filter_map(|(row, given)| match given {
        Some(placed) => given_setting(circuit, element, row, &placed.value),
        None => preset(circuit, element, row),
    })
    .collect()
}

fn given_setting(circuit: &Circuit, element: &Element, row: &SettingRow, amount: &Amount) -> Option<Setting> {
    let (value, formula, shown) = match (amount, row.measure) {
        (Amount::Formula(formula), _) => {
            let value = formula.evaluate(circuit.quantities()).ok()?;
            let unit = unit(circuit, element, row);
            let value = in_unit(circuit, row, formula, value, &unit);
            let is_number = formula.text().trim().parse::<f64>().is_ok();
            let formula = (!is_number).then(|| formula.text().to_owned());
            (Value::Number(value), formula, shown(row, value, &unit))
        }
        (Amount::Flag(flag), _) => (Value::Flag(*flag), None, flag.to_string()),
        (Amount::Choice(index), Measure::Choice(words)) => {
            let word = words.get(*index)?;
            (Value::Word(word), None, (*word).to_owned())
        }
        (Amount::Points(points), _) => {
            (Value::Points(points.clone()), None, format!("{} points", points.len()))
        }
        (Amount::Choice(_), _) => return None,
    };
    Some(Setting { name: row.name, formula, value, shown })
}

fn preset(circuit: &Circuit, element: &Element, row: &SettingRow) -> Option<Setting> {
    let Default::Number(number) = row.default else { return None };
    let value = match row.measure {
        Measure::Flag => Value::Flag(number != 0.0),
        Measure::Choice(words) => Value::Word(words.get(number as usize)?),
        _ => Value::Number(number),
    };
    let shown = match &value {
        Value::Flag(flag) => flag.to_string(),
        Value::Word(word) => (*word).to_owned(),
        _ => shown(row, number, &unit(circuit, element, row)),
    };
    Some(Setting { name: row.name, formula: None, value, shown })
}

/// The unit of a setting's numbers.
fn unit(circuit: &Circuit, element: &Element, row: &SettingRow) -> String {
    let scale = element.scale.map(|scale| circuit.derived_unit(scale).text());
    match (row.measure, scale) {
        (Measure::Signal, Some(scale)) => scale.to_owned(),
        (Measure::SignalRate, Some(scale)) => format!("{scale}/s"),
        _ => row.unit().to_owned(),
    }
}

/// A formula's value in the unit of its place: of a drive's settings it comes in SI.
fn in_unit(circuit: &Circuit, row: &SettingRow, formula: &Formula, value: f64, unit: &str) -> f64 {
    let is_of_signal = matches!(row.measure, Measure::Signal | Measure::SignalRate);
    match Unit::parse(unit) {
        Ok(unit) if is_of_signal && !circuit.is_plain(formula) => unit.out_of_si(value),
        _ => value,
    }
}

/// A value as the drawing shows it.
fn shown(row: &SettingRow, value: f64, unit: &str) -> String {
    match row.measure {
        Measure::Fraction => share(value),
        Measure::Ratio => digits(value),
        Measure::Whole => value.to_string(),
        Measure::Volts => format!("{} V", digits(value)),
        Measure::MachineSeconds => Display::new("s", value).text(value),
        _ => Display::new(unit, value).text(value),
    }
}

/// The lists below a drawing: settings with their formulas, drives, signals, notes.
pub(super) fn lists(circuit: &Circuit, symbols: &[Symbol]) -> Vec<List> {
    let elements = || symbols.iter().filter(|symbol| circuit.patch().elements.contains_key(&symbol.name));
    let drives = || symbols.iter().filter(|symbol| circuit.patch().drives.contains_key(&symbol.name));
    let notes = symbols.iter().filter(|symbol| !symbol.note.is_empty());
    let lists = [
        ("Settings", elements().flat_map(formula_rows).collect()),
        ("Drives", drives().map(|drive| drive_row(circuit, drive)).collect()),
        ("Signals", signal_rows(circuit)),
        ("Notes", notes.map(|symbol| Row::new(&symbol.name, "", &symbol.note)).collect::<Vec<_>>()),
    ];
    let lists = lists.into_iter().map(|(heading, rows)| List { heading, rows });
    lists.filter(|list| !list.rows.is_empty()).collect()
}

fn formula_rows(symbol: &Symbol) -> impl Iterator<Item = Row> + '_ {
    symbol.settings.iter().filter_map(|setting| {
        let formula = setting.formula.as_ref()?;
        let name = match setting.name {
            "setting" => symbol.name.clone(),
            other => format!("{} {other}", symbol.name),
        };
        Some(Row::new(&name, &setting.shown, formula))
    })
}

fn drive_row(circuit: &Circuit, drive: &Symbol) -> Row {
    let told = drive.settings.iter().map(|setting| format!("{} {}", setting.name, setting.shown));
    let scale = circuit.elements().into_iter().find(|element| element.name == drive.name);
    let volt = scale.and_then(|element| volt(circuit, element.scale?, 1.0)).unwrap_or_default();
    Row::new(&drive.name, &volt, &format!("{}: {}", drive.kind, told.collect::<Vec<_>>().join(", ")))
}

fn signal_rows(circuit: &Circuit) -> Vec<Row> {
    let signals = circuit.patch().signals.iter();
    let row = |(name, signal): (&String, &crate::patch::Signal)| {
        let scale = signal.scale.as_ref().and_then(|scale| circuit.derived_index(&scale.value));
        let volt = match scale {
            Some(scale) => volt(circuit, scale, signal.factor),
            None => (signal.factor != 1.0).then(|| stands_for("V", signal.factor)),
        };
        Row::new(name, &volt.unwrap_or_default(), &format!("at {}", signal.at.value))
    };
    signals.map(row).collect()
}

/// What one volt stands for: "1 V = 0.254 mm/s".
fn volt(circuit: &Circuit, scale: usize, factor: f64) -> Option<String> {
    Some(stands_for(circuit.derived_unit(scale).text(), factor * circuit.per_volt(scale)?))
}

fn stands_for(unit: &str, value: f64) -> String {
    format!("1 V = {}", Display::new(unit, value).text(value).replace('-', "−"))
}
