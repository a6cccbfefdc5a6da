//! The settings of elements, drives and instances, with their values and the parameters behind them.

use std::collections::HashSet;

use patchcord_core::circuit::Quantities;
use patchcord_core::document::{Code, Placed, Report, Span};
use patchcord_core::elements::{Family, Setting, SettingDefault, SettingQuantity};
use patchcord_core::patch::{Amount, ElementEntry, Instance, InstanceSetting, Patch};
use patchcord_draw::schematic::setting_number;
use patchcord_expr::{Formula, Scope as _};
use serde_json::Value;

use crate::event::SettingView;

/// Shows the settings of a patch, which may have faults.
pub(super) struct SettingViewer<'p> {
    /// The patch.
    pub patch: &'p Patch,
    /// Its parameters and scales with their values.
    quantities: &'p Quantities,
    /// Where the text has formulas in a wrong unit. The number of such a formula has no meaning.
    mismatches: Vec<Span>,
}

impl<'p> SettingViewer<'p> {
    /// A viewer of a patch with its quantities and the report about it.
    pub(super) fn new(patch: &'p Patch, quantities: &'p Quantities, report: &Report) -> Self {
        let mismatches = report.findings.iter().filter(|finding| finding.code == Code::UNIT_MISMATCH);
        SettingViewer {
            patch,
            quantities,
            mismatches: mismatches.filter_map(|finding| finding.span).collect(),
        }
    }

    /// The settings of an element or a drive.
    pub(super) fn of_element(&self, name: &str, entry: &ElementEntry) -> Vec<SettingView> {
        let section = if entry.kind.family == Family::Drive { "drives" } else { "elements" };
        let view = |(row, given): (&Setting, &Option<Placed<Amount>>)| {
            let unit = self.unit(entry, row);
            let formula = given.as_ref().and_then(|placed| formula_of(&placed.value));
            SettingView {
                name: row.name.to_owned(),
                description: row.description.to_owned(),
                form: form(row.quantity),
                value: self.value(row, given.as_ref(), &unit),
                unit,
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
        let definition = self.patch.macros.get(&instance.macro_name);
        let description = |key: &str| Some(definition?.settings.get(key)?.description.clone());
        let value = |key: &str| self.quantities.value(&format!("{name}.{key}"));
        let view = |(key, setting): (&String, &InstanceSetting)| SettingView {
            name: key.clone(),
            description: description(key).unwrap_or_default(),
            unit: setting.unit.text().to_owned(),
            form: "number",
            value: value(key).map(|value| setting.unit.out_of_si(value)),
            text: self.text("elements", name, key),
            range: None,
            words: Vec::new(),
            parameters: self.parameters(&setting.value.value),
        };
        instance.settings.iter().map(view).collect()
    }

    /// The value of a setting as a number in its unit. `None` if it has none.
    fn value(&self, row: &Setting, given: Option<&Placed<Amount>>, unit: &str) -> Option<f64> {
        match given.map(|placed| (&placed.value, placed.span)) {
            Some((Amount::Formula(formula), span)) => {
                let is_mismatch = self
                    .mismatches
                    .iter()
                    .any(|mismatch| span.start <= mismatch.start && mismatch.end <= span.end);
                if is_mismatch { None } else { setting_number(self.quantities, row, formula, unit) }
            }
            Some((Amount::Flag(flag), _)) => Some(f64::from(u8::from(*flag))),
            Some((Amount::Choice(index), _)) => Some(*index as f64),
            Some((Amount::Points(_), _)) => None,
            None => match row.default {
                SettingDefault::Number(number) => Some(number),
                SettingDefault::Required | SettingDefault::Absent => None,
            },
        }
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
