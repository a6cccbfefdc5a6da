//! The settings of elements, drives and instances, with their values and the parameters behind them.

use std::collections::{HashMap, HashSet};

use patchcord_core::circuit::{Circuit, Element};
use patchcord_core::document::Placed;
use patchcord_core::elements::{Family, Setting, SettingDefault, SettingQuantity};
use patchcord_core::patch::{Amount, ElementEntry, Instance, InstanceSetting, Patch};
use patchcord_draw::schematic::{SettingValue, SymbolSetting, settings_of_element, settings_of_instance};
use patchcord_expr::Formula;
use serde_json::Value;

use crate::event::SettingView;

/// Shows the settings of a patch.
pub(super) struct SettingViewer<'p> {
    /// The patch.
    pub patch: &'p Patch,
    /// The circuit with its elements by name; `None` if the patch does not compile.
    circuit: Option<(&'p Circuit, HashMap<&'p str, &'p Element>)>,
}

impl<'p> SettingViewer<'p> {
    /// A viewer of a patch. The circuit gives the values of formulas.
    pub(super) fn new(patch: &'p Patch, circuit: Option<&'p Circuit>) -> Self {
        let elements = |circuit: &'p Circuit| {
            circuit.elements().into_iter().map(|element| (element.name.as_str(), element)).collect()
        };
        SettingViewer { patch, circuit: circuit.map(|circuit| (circuit, elements(circuit))) }
    }

    /// The settings of an element or a drive.
    pub(super) fn of_element(&self, name: &str, entry: &ElementEntry) -> Vec<SettingView> {
        let evaluated = self.circuit.as_ref().and_then(|(circuit, elements)| {
            elements.get(name).map(|element| settings_of_element(circuit, element))
        });
        let evaluated = evaluated.unwrap_or_default();
        let section = if entry.kind.family == Family::Drive { "drives" } else { "elements" };
        let view = |(row, given): (&Setting, &Option<Placed<Amount>>)| {
            let amount = given.as_ref().map(|placed| &placed.value);
            let formula = amount.and_then(formula_of);
            SettingView {
                name: row.name.to_owned(),
                description: row.description.to_owned(),
                unit: self.unit(entry, row),
                form: form(row.quantity),
                value: value(row, amount, &evaluated),
                text: self.text(section, name, row.name),
                range: range(row),
                words: words(row.quantity),
                parameters: formula.map(|formula| self.parameters(formula)).unwrap_or_default(),
            }
        };
        entry.kind.settings.iter().zip(&entry.settings).map(view).collect()
    }

    /// The settings of an instance. The macro declares them.
    pub(super) fn of_instance(&self, name: &str, instance: &Instance) -> Vec<SettingView> {
        let evaluated =
            self.circuit.as_ref().map(|(circuit, _)| settings_of_instance(circuit, name, instance));
        let evaluated = evaluated.unwrap_or_default();
        let definition = self.patch.macros.get(&instance.macro_name);
        let description = |key: &str| Some(definition?.settings.get(key)?.description.clone());
        let view = |(key, setting): (&String, &InstanceSetting)| SettingView {
            name: key.clone(),
            description: description(key).unwrap_or_default(),
            unit: setting.unit.text().to_owned(),
            form: "number",
            value: number(&evaluated, key, &setting.value.value),
            text: self.text("elements", name, key),
            range: None,
            words: Vec::new(),
            parameters: self.parameters(&setting.value.value),
        };
        instance.settings.iter().map(view).collect()
    }

    /// The unit of a setting in words. Values of a drive have the unit of its scale.
    fn unit(&self, entry: &ElementEntry, row: &Setting) -> String {
        let scale = entry.scale.as_ref().and_then(|scale| self.patch.scales.get(&scale.value));
        match (row.quantity, scale) {
            (SettingQuantity::Signal, Some(scale)) => scale.unit.text().to_owned(),
            (SettingQuantity::SignalRate, Some(scale)) => scale.unit.per_second().text().to_owned(),
            (SettingQuantity::Points, Some(scale)) => format!("[s, {}]", scale.unit.text()),
            _ => row.unit().to_owned(),
        }
    }

    /// The text of a setting in the document. `None` if the document omits it.
    fn text(&self, section: &str, name: &str, setting: &str) -> Option<String> {
        let entry = self.patch.value().get(section)?.get(name)?;
        match setting.split('.').try_fold(entry, |value, key| value.get(key))? {
            Value::String(text) => Some(text.clone()),
            other => Some(other.to_string()),
        }
    }

    /// The parameters in a formula, directly or through scales, in the order of the patch.
    fn parameters(&self, formula: &Formula) -> Vec<String> {
        let (mut names, mut open) = (HashSet::new(), vec![formula]);
        while let Some(formula) = open.pop() {
            for name in formula.names() {
                let is_new = names.insert(name.to_owned());
                let scale = self.patch.scales.get(name).filter(|_| is_new);
                open.extend(scale.and_then(|scale| scale.per_volt.as_ref()).map(|placed| &placed.value));
            }
        }
        self.patch.parameters.keys().filter(|name| names.contains(*name)).cloned().collect()
    }
}

/// The formula of a setting; `None` for flags, words and points.
fn formula_of(amount: &Amount) -> Option<&Formula> {
    match amount {
        Amount::Formula(formula) => Some(formula),
        Amount::Flag(_) | Amount::Choice(_) | Amount::Points(_) => None,
    }
}

/// The value of a setting as a number. `None` if it has none.
fn value(row: &Setting, amount: Option<&Amount>, evaluated: &[SymbolSetting]) -> Option<f64> {
    match amount {
        Some(Amount::Formula(formula)) => number(evaluated, row.name, formula),
        Some(Amount::Flag(flag)) => Some(f64::from(u8::from(*flag))),
        Some(Amount::Choice(index)) => Some(*index as f64),
        Some(Amount::Points(_)) => None,
        None => match row.default {
            SettingDefault::Number(number) => Some(number),
            SettingDefault::Required | SettingDefault::Absent => None,
        },
    }
}

/// The number of a setting: its evaluated formula, or a formula that is a number itself.
fn number(evaluated: &[SymbolSetting], name: &str, formula: &Formula) -> Option<f64> {
    let setting = evaluated.iter().find(|setting| setting.name == name);
    match setting.map(|setting| &setting.value) {
        Some(SettingValue::Number(number)) => Some(*number),
        _ => formula.text().trim().parse().ok(),
    }
}

/// The form in which a setting is written.
fn form(quantity: SettingQuantity) -> &'static str {
    match quantity {
        SettingQuantity::Flag => "flag",
        SettingQuantity::Choice(_) => "choice",
        SettingQuantity::Points | SettingQuantity::Curve(_) => "points",
        _ => "number",
    }
}

/// The words of a choice.
fn words(quantity: SettingQuantity) -> Vec<String> {
    match quantity {
        SettingQuantity::Choice(words) => words.iter().map(|word| (*word).to_owned()).collect(),
        _ => Vec::new(),
    }
}

/// The least and the largest value of a setting. `None` if one of them is unlimited.
fn range(row: &Setting) -> Option<[f64; 2]> {
    let (low, high) = row.range;
    (low > f64::MIN && high < f64::MAX).then_some([low, high])
}
