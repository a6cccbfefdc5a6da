//! Initial values as the equations state them, for integrators and lags that begin at 0 V: an initial condition was
//! forgotten.

use patchcord_core::patch::Signal;
use patchcord_expr::{Equation, Expression, Formula, split_primes};
use serde_json::{Value, json};

use super::super::influence::Part;
use super::super::panel::Panel;
use super::settings::present_value;
use super::{Candidates, cost};

/// The setting.
const INITIAL: &str = "initial";

impl Candidates<'_, '_> {
    /// The stated initial values, each with both signs.
    pub(super) fn starts(&mut self) {
        let panel = self.panel;
        for placed in panel.circuit.equations() {
            let equation = &placed.value;
            let signal = equation.initial_quantity().and_then(|quantity| signal_of(panel, quantity));
            let Some(signal) = signal else { continue };
            for (name, index) in beginning_at_zero(panel, &signal.element.value) {
                for value in stated_volts(equation, signal) {
                    self.set(cost::INITIAL, (name, Part::Start(index)), INITIAL, [&Value::Null, &value]);
                }
            }
        }
    }
}

/// The signal of a quantity. That of a derivative is stated by an equation such as `v = x'`.
fn signal_of<'p>(panel: &Panel<'p>, quantity: &str) -> Option<&'p Signal> {
    let patch = panel.circuit.patch();
    if split_primes(quantity).1 == 0 {
        return patch.signals.get(quantity);
    }
    let is_quantity =
        |expression: &Expression| matches!(expression, Expression::Name(name) if name == quantity);
    panel.circuit.equations().iter().find_map(|placed| {
        let sides = [placed.value.left(), placed.value.right()].map(|side| &side.expression);
        match sides {
            [Expression::Name(name), other] | [other, Expression::Name(name)] if is_quantity(other) => {
                patch.signals.get(name)
            }
            _ => None,
        }
    })
}

/// The elements of the document that begin at 0 V and give the output of an element its initial value: the element itself,
/// or those that drive it.
fn beginning_at_zero<'p>(panel: &Panel<'p>, element: &str) -> Vec<(&'p str, usize)> {
    let written = &panel.circuit.patch().value()["elements"];
    let has_start = |index: usize| panel.kind(index).setting(INITIAL).is_some();
    let is_at_zero = |name: &str| {
        let value = &written[name][INITIAL];
        value.is_null() || present_value(panel, value) == Some(0.0)
    };
    let Some((_, read)) = panel.elements().find(|(name, _)| *name == element) else { return Vec::new() };
    let drivers = panel.circuit.cords(read).into_iter().map(|(from, _)| from);
    let starts: Vec<usize> = if has_start(read) { vec![read] } else { drivers.collect() };
    let is_wanted =
        |(name, index): &(&str, usize)| starts.contains(index) && has_start(*index) && is_at_zero(name);
    panel.elements().filter(is_wanted).collect()
}

/// The initial voltage that an equation states for a signal, as formulas with both signs. Empty if the right side is no
/// formula of a setting.
fn stated_volts(equation: &Equation, signal: &Signal) -> Vec<Value> {
    let Some((_, stated)) = equation.text().split_once('=') else { return Vec::new() };
    let stated = stated.trim();
    if Formula::parse(stated).is_err() {
        return Vec::new();
    }
    let is_single = stated.chars().all(|letter| letter.is_ascii_alphanumeric() || "_.".contains(letter));
    let stated = if is_single { stated.to_owned() } else { format!("({stated})") };
    let volts = match &signal.scale {
        Some(scale) => format!("{stated} / {}", scale.value),
        None => stated,
    };
    vec![json!(volts), json!(format!("-{volts}"))]
}
