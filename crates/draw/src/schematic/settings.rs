//! The settings of a symbol: values, units and the text that the drawing shows.
//!
//! A setting of an element has the value of its formula, converted into the unit of the setting. If the
//! patch omits the setting, the default of the kind is shown. A setting of a macro instance has the unit
//! that the macro declares.

use super::number_text::{format_four_digits, format_fraction, format_volts, format_with_unit};
use super::symbol::{SettingValue, SymbolSetting};
use patchcord_core::circuit::{Circuit, Element, Quantities};
use patchcord_core::elements::{Setting as SettingRow, SettingDefault, SettingQuantity};
use patchcord_core::patch::{Amount, Instance, InstanceSetting};
use patchcord_expr::{Formula, Unit};

/// Returns the settings of an instance in the units of its macro.
pub(super) fn of_instance(circuit: &Circuit, name: &str, instance: &Instance) -> Vec<SymbolSetting> {
    let setting = |(key, made): (&String, &InstanceSetting)| {
        let value = circuit.per_volt(circuit.derived_index(&format!("{name}.{key}"))?)?;
        let text = made.value.value.text();
        Some(SymbolSetting {
            name: key.clone(),
            formula: formula_text(text),
            value: SettingValue::Number(value),
            shown: format_with_unit(value, made.unit.text()),
            // The box shows all settings of its instance, so only formulas are listed.
            is_given: false,
        })
    };
    instance.settings.iter().filter_map(setting).collect()
}

/// Returns the settings of an element with their defaults. A setting without a value is omitted.
pub fn of_element(circuit: &Circuit, element: &Element) -> Vec<SymbolSetting> {
    let rows = element.kind.settings.iter().zip(&element.settings);
    rows.filter_map(|(row, given)| match given {
        Some(placed) => given_setting(circuit, element, row, &placed.value),
        None => default_setting(circuit, element, row),
    })
    .collect()
}

/// Returns the text of a formula; `None` if it is a plain number, which the drawing shows already.
fn formula_text(text: &str) -> Option<String> {
    text.trim().parse::<f64>().is_err().then(|| text.to_owned())
}

/// Returns a setting that the patch specifies; `None` if its formula has no value.
fn given_setting(
    circuit: &Circuit,
    element: &Element,
    row: &SettingRow,
    amount: &Amount,
) -> Option<SymbolSetting> {
    let (value, formula, shown) = match (amount, row.quantity) {
        (Amount::Formula(formula), _) => {
            let unit = unit(circuit, element, row);
            let value = number(circuit.quantities(), row, formula, &unit)?;
            (SettingValue::Number(value), formula_text(formula.text()), shown(row, value, &unit))
        }
        (Amount::Flag(flag), _) => (SettingValue::Flag(*flag), None, format_flag(*flag)),
        (Amount::Choice(index), SettingQuantity::Choice(words)) => {
            let word = words.get(*index)?;
            (SettingValue::Word(word), None, (*word).to_owned())
        }
        (Amount::Points(points), _) => (SettingValue::Points(points.clone()), None, format_points(points)),
        _ => return None,
    };
    Some(SymbolSetting { name: row.name.to_owned(), formula, value, shown, is_given: true })
}

/// Formats a flag. Every flag of an element is the state of a contact.
fn format_flag(closed: bool) -> String {
    if closed { "closed" } else { "open" }.to_owned()
}

/// Returns the default of a setting that the patch does not specify; `None` if there is no default number.
fn default_setting(circuit: &Circuit, element: &Element, row: &SettingRow) -> Option<SymbolSetting> {
    let SettingDefault::Number(number) = row.default else { return None };
    let value = match row.quantity {
        SettingQuantity::Flag => SettingValue::Flag(number != 0.0),
        SettingQuantity::Choice(words) => SettingValue::Word(words.get(number as usize)?),
        _ => SettingValue::Number(number),
    };
    let shown = match &value {
        SettingValue::Flag(flag) => format_flag(*flag),
        SettingValue::Word(word) => (*word).to_owned(),
        _ => shown(row, number, &unit(circuit, element, row)),
    };
    Some(SymbolSetting { name: row.name.to_owned(), formula: None, value, shown, is_given: false })
}

/// Returns the unit of the numbers of a setting.
///
/// Settings of a drive that are values of its signal have the unit of its scale, or that unit per second.
fn unit(circuit: &Circuit, element: &Element, row: &SettingRow) -> String {
    let scale = element.scale.map(|scale| circuit.derived_unit(scale));
    match (row.quantity, scale) {
        (SettingQuantity::Signal, Some(scale)) => scale.text().to_owned(),
        (SettingQuantity::SignalRate, Some(scale)) => scale.per_second().text().to_owned(),
        _ => row.unit().to_owned(),
    }
}

/// Returns the value of a formula for a setting, in the unit of the setting; `None` if the formula has no value.
///
/// A formula for a setting of a drive has a value in SI units, unless it is a plain number. An angular
/// frequency is converted to Hz.
pub fn number(quantities: &Quantities, row: &SettingRow, formula: &Formula, unit: &str) -> Option<f64> {
    let value = formula.evaluate(quantities).ok()?;
    if row.quantity == SettingQuantity::Hertz {
        return Some(quantities.in_hertz(formula, value));
    }
    let is_of_signal = matches!(row.quantity, SettingQuantity::Signal | SettingQuantity::SignalRate);
    match Unit::parse(unit) {
        Ok(unit) if is_of_signal && !quantities.is_literal(formula) => Some(unit.out_of_si(value)),
        _ => Some(value),
    }
}

/// Formats a value with its unit for the drawing.
fn shown(row: &SettingRow, value: f64, unit: &str) -> String {
    match row.quantity {
        SettingQuantity::Fraction => format_fraction(value),
        SettingQuantity::Ratio => format_four_digits(value),
        SettingQuantity::Whole => value.to_string(),
        SettingQuantity::Volts => format_volts(value),
        SettingQuantity::MachineSeconds => format_with_unit(value, "s"),
        _ => format_with_unit(value, unit),
    }
}

/// The maximum number of points that are listed individually.
const MAX_LISTED_POINTS: usize = 8;

/// Formats points; only the first ones if there are many.
fn format_points(points: &[[f64; 2]]) -> String {
    let texts = points
        .iter()
        .take(MAX_LISTED_POINTS)
        .map(|[x, y]| format!("({}, {})", format_four_digits(*x), format_four_digits(*y)));
    let texts = texts.collect::<Vec<_>>().join(" ");
    if points.len() > MAX_LISTED_POINTS { format!("{texts} … {} points", points.len()) } else { texts }
}
