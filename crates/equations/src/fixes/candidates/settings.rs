//! Other settings of pots, other initial values, and the opposite signs of signals.

use patchcord_core::elements::SettingQuantity;
use patchcord_core::patch::Amount;
use patchcord_expr::{Dimension, Formula, Scope as _, format_significant};
use serde_json::{Value, json};

use super::super::change::{Change, Setting};
use super::super::formula::{Product, renamed};
use super::super::influence::Part;
use super::super::panel::Panel;
use super::{Candidates, POWERS, cost, decades};

/// Significant digits of a factor in a description.
const DIGITS: usize = 6;
/// Least setting of a pot that is precise.
const LEAST_SETTING: f64 = 0.1;

impl Candidates<'_, '_> {
    /// The changes of settings.
    pub(super) fn settings(&mut self, factors: &[f64]) {
        let panel = self.panel;
        let written = &panel.circuit.patch().value()["elements"];
        for (name, index) in panel.elements() {
            let element = panel.circuit.element(index);
            for (setting, amount) in element.kind.settings.iter().zip(&element.settings) {
                let is_formula =
                    amount.as_ref().is_some_and(|amount| matches!(amount.value, Amount::Formula(_)));
                let value = &written[name][setting.name];
                if !is_formula || value.is_null() {
                    continue;
                }
                if setting.quantity == SettingQuantity::Fraction {
                    self.pot((name, index), setting.name, value, factors);
                } else if setting.name == "initial" {
                    self.initial((name, index), value, factors);
                }
            }
        }
        self.signals();
    }

    /// Adds a value of an element, unless it is the present one.
    pub(super) fn set(
        &mut self,
        cost: u32,
        (name, part): (&str, Part),
        key: &str,
        [present, value]: [&Value; 2],
    ) {
        if present == value {
            return;
        }
        let path = ["elements", name, key].map(str::to_owned).to_vec();
        let description = match part {
            Part::Start(_) => format!("give {name} the initial value {value}"),
            _ => format!("set {name} to {value}"),
        };
        self.push(cost, Change::Set(Setting { path, value: value.clone(), description, part }));
    }

    /// Other settings of a pot: times powers of ten, times or over a name, with two names exchanged or one name in place
    /// of another, and times the factors by which terms are wrong.
    fn pot(&mut self, (name, index): (&str, usize), key: &str, value: &Value, factors: &[f64]) {
        let Some(product) = Product::new(value) else { return };
        let panel = self.panel;
        let mut add = |cost: u32, other: Value| {
            self.set(cost, (name, Part::Elements(vec![index])), key, [value, &other]);
        };
        let present = present_value(panel, value);
        for factor in POWERS {
            let is_precise = |setting: f64| setting >= LEAST_SETTING;
            let is_small =
                present.is_some_and(|present| !is_precise(present) && is_precise(present * factor));
            let cost = if is_small { cost::SMALL_POT } else { cost::POT };
            add(cost + decades(factor), product.times(factor).value());
        }
        for other in missing_names(panel) {
            add(cost::FACTOR, product.times_name(other, false).value());
            add(cost::FACTOR, product.times_name(other, true).value());
        }
        let dimension = |name: &str| panel.circuit.quantities().dimension(name);
        for ([above, below], exchanged) in product.exchanges() {
            if dimension(above) == dimension(below) {
                add(cost::FACTOR, exchanged.value());
            }
        }
        for other in renamed(value, |name| similar_names(panel, name)) {
            add(cost::OTHER_NAME, other);
        }
        for factor in factors.iter().filter(|_| product.is_literal()) {
            add(cost::FOUND_FACTOR, product.times(*factor).value());
            add(cost::FOUND_FACTOR, product.times(factor.recip()).value());
        }
    }

    /// Other initial values: with the opposite sign, times powers of ten, with a name in place of another, and times the
    /// factors by which initial values are wrong.
    fn initial(&mut self, (name, index): (&str, usize), value: &Value, factors: &[f64]) {
        let Some(product) = Product::new(value) else { return };
        let panel = self.panel;
        let mut add = |cost: u32, other: Value| {
            self.set(cost, (name, Part::Start(index)), "initial", [value, &other]);
        };
        add(cost::INITIAL, product.negated().value());
        for factor in POWERS {
            add(cost::INITIAL + cost::FITTING + decades(factor), product.times(factor).value());
        }
        for other in renamed(value, |name| similar_names(panel, name)) {
            add(cost::OTHER_NAME, other);
        }
        for factor in factors.iter().filter(|_| product.is_literal()) {
            add(cost::FOUND_FACTOR, product.times(*factor).value());
            add(cost::FOUND_FACTOR, product.times(factor.recip()).value());
        }
    }

    /// Signals with the opposite sign.
    fn signals(&mut self) {
        let panel = self.panel;
        for (name, signal) in &panel.circuit.patch().signals {
            let factor = -signal.factor;
            let digits = format_significant(factor, DIGITS);
            let setting = Setting {
                path: ["signals", name.as_str(), "factor"].map(str::to_owned).to_vec(),
                value: json!(factor),
                description: format!("give the signal {name} the factor {digits}"),
                part: Part::All,
            };
            self.push(cost::SIGNAL_SIGN, Change::Set(setting));
        }
    }
}

/// The names that can be missing in the setting of a pot: it is a pure number or a rate. Scales and a time scale of 1
/// have no effect.
fn missing_names<'p>(panel: &'p Panel<'_>) -> Vec<&'p str> {
    let (patch, scope) = (panel.circuit.patch(), panel.circuit.quantities());
    let mut names = scope.names();
    names.retain(|name| {
        let dimension = scope.dimension(name).map(Dimension::without_time);
        let has_effect = patch.parameters.contains_key(*name) || scope.value(name) != Some(1.0);
        dimension == Some(Dimension::NONE) && has_effect
    });
    names
}

/// The names that a name of a formula can be mistaken for: parameters in place of a parameter, scales in place of a
/// scale, of the same dimension.
fn similar_names<'p>(panel: &'p Panel<'_>, name: &str) -> Vec<&'p str> {
    let (patch, scope) = (panel.circuit.patch(), panel.circuit.quantities());
    let is_parameter = patch.parameters.contains_key(name);
    let is_similar = |other: &&str| {
        *other != name
            && scope.dimension(other) == scope.dimension(name)
            && patch.parameters.contains_key(*other) == is_parameter
    };
    let is_known = is_parameter || patch.scales.contains_key(name);
    if is_known { scope.names().into_iter().filter(is_similar).collect() } else { Vec::new() }
}

/// The value of a number or formula of the document in SI. `None` if it has none.
pub(super) fn present_value(panel: &Panel<'_>, value: &Value) -> Option<f64> {
    match value.as_str() {
        Some(text) => Formula::parse(text).ok()?.evaluate(panel.circuit.quantities()).ok(),
        None => value.as_f64(),
    }
}
