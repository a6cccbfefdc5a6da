//! The edits of a patch for a decision: scales, signals, settings, cords and the time scale.
//!
//! Only the values that change are edited, so names, order, notes and layout of the document stay.

use std::collections::BTreeMap;

use patchcord_core::circuit::Cord;
use patchcord_core::document::TIME_SCALE;
use patchcord_core::elements::SettingDefault;
use patchcord_core::patch::{Edit, Patch};
use patchcord_expr::round_significant;
use serde::Serialize;
use serde_json::{Value, json};

use super::cords::{changed_jacks, jack_name, new_pot_name, written_source};
use super::decision::{Decided, Decision};
use super::exact::{ExactAmplifications, exact_amplifications};
use super::formulas::{Retuned, Retuning};
use super::laws::{Size, necessary_input, size};
use super::rules::{cord_rule, pot_rule};
use super::scales::new_scales;
use super::time::is_before_integrators;
use super::values::{PointValues, Values};
use super::wiring::Wiring;
use crate::fixes::Product;

/// Significant digits of a number in the document.
const DIGITS: usize = 14;
/// A factor that differs from 1 by at most this is 1.
const ROUNDING: f64 = 1e-13;

/// A value of the document that the rescaling changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ChangedSetting {
    /// The element, the drive, the scale or the signal; "time_scale" for the time scale.
    pub name: String,
    /// The key of the document, "gain of P1" for the cord from P1, or "new pot".
    pub setting: String,
    /// The text before; empty if the value is new.
    pub before: String,
    /// The text after.
    pub after: String,
    /// The gain rule (eq. 4-8) in numbers, for cords with gains and for pots in front of them; empty for others.
    pub rule: String,
}

/// A rescaled patch.
pub(super) struct Edited {
    pub patch: Patch,
    /// The old patch and the new one with other open amplifiers, so that all voltages of the new one are exact multiples
    /// of the old ones. The amplifiers of the machine keep their amplification, so their small errors change. `None` if
    /// the patch is the same.
    pub exact: [Option<Patch>; 2],
    pub changes: Vec<ChangedSetting>,
}

/// Makes the edits of a decision.
///
/// # Errors
/// The message if a value of the document cannot have the value that it needs.
pub(super) fn edited(wiring: &Wiring<'_>, old: &Values<'_>, decision: &Decision) -> Result<Edited, String> {
    let scales = new_scales(wiring, old, decision)?;
    let factors = wiring.circuit.patch().scales.keys().enumerate().map(|(index, name)| {
        let factor = decision.scale_factors.get(&index).copied().unwrap_or(1.0);
        (name.clone(), factor)
    });
    let mut editing = Editing {
        decided: Decided { wiring, old, decision },
        new: &scales.values,
        scale_factors: factors.collect(),
        edits: BTreeMap::new(),
        changes: Vec::new(),
    };
    for (name, [before, after]) in &scales.changed {
        let path = ["scales", *name, "per_volt"].map(str::to_owned);
        editing.put(path.to_vec(), [*name, "per_volt"], Some(change(before, after)))?;
    }
    editing.time_scale()?;
    editing.signals()?;
    for element in 0..wiring.len() {
        editing.settings(element)?;
        editing.points(element)?;
        editing.cords(element)?;
    }
    editing.finish()
}

/// A change of a value, with the texts for the reader.
struct Change {
    after: Value,
    texts: [String; 2],
    rule: String,
}

/// The change of a value of the document into another one.
fn change(before: &Value, after: &Value) -> Change {
    Change { after: after.clone(), texts: [text(before), text(after)], rule: String::new() }
}

/// A value of the document as text, without quotes. Empty for no value.
fn text(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// A number of the document.
fn number(value: f64) -> Value {
    Product::new(&json!(round_significant(value, DIGITS))).map_or(Value::Null, |product| product.value())
}

/// The product of a number of the document and a factor: a number, or a short quotient.
fn product(value: f64, factor: f64) -> Value {
    Product::new(&number(value)).map_or(Value::Null, |product| product.times_precisely(factor).value())
}

/// The edits of a decision while they are made.
struct Editing<'e> {
    decided: Decided<'e>,
    /// The values under the new scales.
    new: &'e Values<'e>,
    /// The value of one volt of each scale before, as a multiple of the new one.
    scale_factors: BTreeMap<String, f64>,
    /// The new value at each path that was considered. `None` if it stays. The instances of a macro share their paths.
    edits: BTreeMap<Vec<String>, Option<Value>>,
    changes: Vec<ChangedSetting>,
}

impl Editing<'_> {
    /// Puts a new value at a path. `None` keeps the value that is there. `label` has the name and the key for the reader.
    ///
    /// # Errors
    /// Those of [`Editing::insert`].
    fn put(&mut self, path: Vec<String>, label: [&str; 2], change: Option<Change>) -> Result<(), String> {
        let is_new = self.insert(path, change.as_ref().map(|change| change.after.clone()))?;
        if let Some(Change { texts: [before, after], rule, .. }) = change.filter(|_| is_new) {
            let [name, setting] = label.map(str::to_owned);
            self.changes.push(ChangedSetting { name, setting, before, after, rule });
        }
        Ok(())
    }

    /// Adds the new value at a path, or `None` if the value stays. Returns whether the path was not considered before.
    ///
    /// # Errors
    /// The message if an equal element of another instance needs another value.
    fn insert(&mut self, path: Vec<String>, after: Option<Value>) -> Result<bool, String> {
        match self.edits.get(&path) {
            Some(known) if *known == after => Ok(false),
            Some(_) => {
                let path = path.join("/");
                Err(format!(
                    "the instances of a macro would need different values of {path}: move this element out of the macro"
                ))
            }
            None => {
                self.edits.insert(path, after);
                Ok(true)
            }
        }
    }

    /// The time scale.
    ///
    /// # Errors
    /// Those of [`Editing::put`].
    fn time_scale(&mut self) -> Result<(), String> {
        if self.decided.decision.time == 1.0 {
            return Ok(());
        }
        let before = number(self.decided.wiring.circuit.time_scale());
        let change = change(&before, &number(self.new.time_scale));
        self.put(vec![TIME_SCALE.to_owned()], [TIME_SCALE, ""], Some(change))
    }

    /// The factors of signals without a scale: their values stay.
    ///
    /// # Errors
    /// Those of [`Editing::put`].
    fn signals(&mut self) -> Result<(), String> {
        let circuit = self.decided.wiring.circuit;
        for signal in &circuit.signals()[..circuit.patch().signals.len()] {
            let factor = self.decided.factor(signal.element, 0).unwrap_or(1.0);
            if signal.scale.is_some() || (factor - 1.0).abs() <= ROUNDING {
                continue;
            }
            let path = ["signals", signal.name.as_str(), "factor"].map(str::to_owned).to_vec();
            let change = change(&number(signal.factor), &number(signal.factor / factor));
            self.put(path, [signal.name.as_str(), "factor"], Some(change))?;
        }
        Ok(())
    }

    /// The settings of an element.
    ///
    /// # Errors
    /// The message if a setting cannot have the value that it needs.
    fn settings(&mut self, element: usize) -> Result<(), String> {
        let wiring = self.decided.wiring;
        let name = wiring.name(element);
        for setting in wiring.kind(element).settings {
            let Some(path) = wiring.path(element, setting.name) else { continue };
            // Another instance of the macro can need a change of the formula, with which this one stays 0.
            if self.decided.is_always_zero(element, setting.name) {
                continue;
            }
            let change = match wiring.formula(element, setting.name) {
                Some(_) => self.changed_setting(element, setting.name)?,
                None => match setting.default {
                    SettingDefault::Number(number) => self.changed_default(element, setting.name, number),
                    _ => continue,
                },
            };
            self.put(path, [name, setting.name], change)?;
        }
        Ok(())
    }

    /// The change of a setting that the document gives. `None` if it stays.
    ///
    /// # Errors
    /// The message if it cannot have the value that it needs.
    fn changed_setting(&self, element: usize, setting: &str) -> Result<Option<Change>, String> {
        let wiring = self.decided.wiring;
        let name = wiring.located(element);
        let wanted: PointValues = std::array::from_fn(|point| self.decided.wanted(element, setting, point));
        let written = wiring.written(element, setting);
        let written =
            written.ok_or_else(|| format!("{setting} of {name} is not in the document under this key"))?;
        let retuning = Retuning {
            circuit: wiring.circuit,
            new: self.new,
            scale_factors: &self.scale_factors,
            time_divides: self.time_divides(element, setting),
            instance: wiring.places[element].as_ref().and_then(|place| place.instance.as_deref()),
        };
        let retuned = match (retuning.retuned(written, &wanted), self.decided.bias_factor(element)) {
            (Retuned::Impossible, Some(factor)) => {
                // The breakpoints follow the biases, as if all scales were multiplied by their factor.
                let scale_factors = self.scale_factors.keys().map(|name| (name.clone(), factor)).collect();
                Retuning { scale_factors: &scale_factors, ..retuning }.retuned(written, &wanted)
            }
            (retuned, _) => retuned,
        };
        match retuned {
            Retuned::Same => Ok(None),
            Retuned::Changed(after) => {
                let rule = pot_rule(&self.decided, element).unwrap_or_default();
                Ok(Some(Change { rule, ..change(written, &after) }))
            }
            Retuned::Impossible => Err(format!(
                "{setting} of {name} is {}, which cannot be changed so that it is right for all values of the parameters: \
                 write it as a product of scales and parameters",
                text(written)
            )),
        }
    }

    /// Whether a setting contains the time scale as a divisor or as a factor, if it changes: that of a pot in front of
    /// integrators, and a time. `None` for others.
    fn time_divides(&self, element: usize, setting: &str) -> Option<bool> {
        let Decided { wiring, decision, .. } = self.decided;
        if decision.time == 1.0 {
            return None;
        }
        if size(wiring.kind(element).name, setting) == Size::Time {
            return Some(false);
        }
        let has_added_pot = wiring.readers[element].iter().any(|cord| decision.added.contains_key(cord));
        let is_turned = setting == "setting" && is_before_integrators(wiring, element) && !has_added_pot;
        is_turned.then_some(true)
    }

    /// The change of a setting that the document does not give. `None` if its default stays.
    fn changed_default(&self, element: usize, setting: &str, default: f64) -> Option<Change> {
        let wiring = self.decided.wiring;
        let kind = wiring.kind(element).name;
        let input = necessary_input(kind, setting);
        let is_used = input.is_none_or(|input| wiring.source(element, input).is_some());
        if size(kind, setting) == Size::Fixed || default == 0.0 || !is_used {
            return None;
        }
        let factor = self.decided.setting_factor(element, kind, setting, 0).unwrap_or(1.0);
        ((factor - 1.0).abs() > ROUNDING).then(|| change(&Value::Null, &product(default, factor)))
    }

    /// The points of a function generator.
    ///
    /// # Errors
    /// Those of [`Editing::put`].
    fn points(&mut self, element: usize) -> Result<(), String> {
        let wiring = self.decided.wiring;
        let Some(written) = wiring.written(element, "points").filter(|written| written.is_array()) else {
            return Ok(());
        };
        let input = wiring.source(element, "in").and_then(|from| self.decided.factor(from, 0));
        let factors = [input, self.decided.factor(element, 0)].map(|factor| factor.unwrap_or(1.0));
        let is_fixed = factors.iter().all(|factor| (factor - 1.0).abs() <= ROUNDING);
        if wiring.kind(element).name != "function-generator" || is_fixed {
            return Ok(());
        }
        let point = |point: &Value| -> Value {
            let numbers = factors.iter().enumerate();
            let numbers =
                numbers.filter_map(|(index, factor)| Some(number(point.get(index)?.as_f64()? * factor)));
            Value::Array(numbers.collect())
        };
        let after = Value::Array(written.as_array().into_iter().flatten().map(point).collect());
        match wiring.path(element, "points") {
            Some(path) => self.put(path, [wiring.name(element), "points"], Some(change(written, &after))),
            None => Ok(()),
        }
    }

    /// The cords of an element, with new pots.
    ///
    /// # Errors
    /// The message if the document does not have the cords as the circuit has them.
    fn cords(&mut self, element: usize) -> Result<(), String> {
        let Decided { wiring, decision, .. } = self.decided;
        if !wiring.kind(element).has_gains() {
            return Ok(());
        }
        let Some(path) = wiring.path(element, "in") else { return Ok(()) };
        let added = self.added_pots(element)?;
        let after = changed_jacks(wiring, element, decision, &added)?;
        let is_changed = after.is_some();
        if self.insert(path, after)? && is_changed {
            self.changes.extend(changed_gains(&self.decided, element));
        }
        Ok(())
    }

    /// Adds the new pots in the cords of an element. Returns their names by the index of the cord.
    ///
    /// # Errors
    /// Those of [`Editing::put`].
    fn added_pots(&mut self, element: usize) -> Result<BTreeMap<usize, String>, String> {
        let Decided { wiring, decision, .. } = self.decided;
        let mut names = BTreeMap::new();
        let own = decision.added.range((element, 0)..=(element, usize::MAX));
        for ((_, cord), setting) in own {
            let Some(place) = &wiring.places[element] else { continue };
            let (name, mut path) = (new_pot_name(wiring, element, *cord), place.path.clone());
            path.pop();
            path.push(name.clone());
            let source = written_source(wiring, element, *cord).cloned().unwrap_or_default();
            let is_named = wiring.circuit.time_scale() == 1.0;
            let whole = Product::new(&number(setting * decision.time));
            let named =
                whole.filter(|_| is_named).map(|product| product.times_name(TIME_SCALE, true).value());
            let setting = named.unwrap_or_else(|| product(1.0, *setting));
            let pot = json!({"kind": "pot", "in": source, "setting": setting, "note": "for the time scale"});
            let texts = [String::new(), text(&setting)];
            let change = Change { after: pot, texts, rule: cord_rule(&self.decided, element, *cord) };
            self.put(path, [name.as_str(), "new pot"], Some(change))?;
            names.insert(*cord, name);
        }
        Ok(names)
    }

    /// The patch with all edits.
    ///
    /// # Errors
    /// The message if the text cannot be edited.
    fn finish(self) -> Result<Edited, String> {
        let patch = self.decided.wiring.circuit.patch();
        let edit =
            |(path, value): (&Vec<String>, &Option<Value>)| Some(Edit::at(path.clone(), value.clone()?));
        let mut edits: Vec<Edit> = self.edits.iter().filter_map(edit).collect();
        let with = |edits: &[Edit]| patch.with_edits(patch.file(), edits).map_err(|error| error.to_string());
        let rescaled = with(&edits)?;
        let ExactAmplifications { old, new } = exact_amplifications(&self.decided);
        let old = if old.is_empty() { None } else { Some(with(&old)?) };
        let exact = if new.is_empty() {
            None
        } else {
            edits.extend(new);
            Some(with(&edits)?)
        };
        Ok(Edited { patch: rescaled, exact: [old, exact], changes: self.changes })
    }
}

/// The changed gains of an element, for the reader.
fn changed_gains(decided: &Decided<'_>, element: usize) -> Vec<ChangedSetting> {
    let Decided { wiring, decision, .. } = *decided;
    let cords = wiring.cords[element].iter().enumerate();
    let changed = cords.filter(|(cord, (_, own))| decision.gains[element][*cord] != own.gain);
    let row = |(cord, (from, own)): (usize, &(usize, Cord))| ChangedSetting {
        name: wiring.name(element).to_owned(),
        setting: format!("gain of {}", wiring.name(*from)),
        before: jack_name(wiring, element, cord, own.gain),
        after: jack_name(wiring, element, cord, decision.gains[element][cord]),
        rule: cord_rule(decided, element, cord),
    };
    changed.map(row).collect()
}
