//! The fragment of an effect as a macro of the patch: its names and gains are adapted to the patch and the site.

use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::GraftBuilder;
use crate::data::drive_timing::uses_record_start;
use crate::effects::InputRole;
use crate::effects::unused_names::unused_name;
use patchcord_expr::{Dimension, Formula, Scope, Unit};

impl GraftBuilder<'_> {
    /// Whether a drive of the fragment depends on the start of the record.
    ///
    /// The parameter is then set for every record, so that the drive keeps the clock of the file.
    pub(super) fn needs_record_start(&self) -> bool {
        self.placement.form.drives.values().any(uses_record_start)
    }

    /// The macro of the fragment, as in a patch document.
    ///
    /// The note of the macro has physics, law and source of the effect, so that the patch explains itself.
    pub(super) fn macro_definition(&self) -> Map<String, Value> {
        let effect = self.placement.effect;
        let inputs = self.inputs.keys().map(|port| {
            let meaning =
                InputRole::ALL.iter().find(|role| role.word() == port).map_or("", |role| role.meaning());
            (port.clone(), Value::from(meaning))
        });
        let form = self.placement.form;
        let outputs =
            form.gives.iter().map(|(role, element)| (role.word().to_owned(), Value::from(element.as_str())));
        let elements = form.elements.iter().map(|(name, element)| {
            let mut element = self.renamed_value(element);
            if form.free_states.contains(name) {
                element["initial"] = Value::String(self.initial_parameter(name));
            }
            (name.clone(), element)
        });
        let note = format!("{} {}. Source: {}", effect.physics, effect.law, effect.source);
        let keys = [
            ("note", Value::String(note)),
            ("inputs", Value::Object(inputs.collect())),
            ("outputs", Value::Object(outputs.collect())),
            ("elements", Value::Object(elements.collect())),
        ];
        keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    }

    /// Name of the parameter that is the initial voltage of a state of the fragment.
    pub(super) fn initial_parameter(&self, state: &str) -> String {
        let is_taken =
            |name: &str| self.patch.parameters.contains_key(name) || self.patch.scales.contains_key(name);
        unused_name(&format!("{}_{state}_initial", self.instance), is_taken)
    }

    /// A value of the fragment's document, such as an element or a drive, with the names of the patch. Ports and
    /// elements of the fragment keep their names.
    pub(super) fn renamed_value(&self, value: &Value) -> Value {
        match value {
            Value::Object(entries) => {
                let mut renamed = Map::new();
                for (key, value) in entries {
                    let is_plain = key == "note" || key == "kind";
                    let value = if is_plain { value.clone() } else { self.renamed_value(value) };
                    // Two jacks can get the same gain: their cords are merged.
                    match (renamed.get_mut(&self.jack(key)), value) {
                        (Some(Value::Array(cords)), Value::Array(more)) => cords.extend(more),
                        (_, value) => {
                            renamed.insert(self.jack(key), value);
                        }
                    }
                }
                Value::Object(renamed)
            }
            Value::Array(items) => Value::Array(items.iter().map(|item| self.renamed_value(item)).collect()),
            // An input port has the word of its role as name.
            Value::String(text) if self.inputs.contains_key(text) => value.clone(),
            Value::String(text) if self.placement.form.elements.contains_key(text) => value.clone(),
            Value::String(text) => Value::String(renamed_formula(text, &self.renames)),
            _ => value.clone(),
        }
    }

    /// The key of a jack: "xG" with the power of ten of gain G, any other key unchanged.
    fn jack(&self, key: &str) -> String {
        let gain = key.strip_prefix('x').filter(|gain| self.placement.form.gains.contains_key(*gain));
        gain.map_or_else(|| key.to_owned(), |gain| format!("x{}", self.renames[gain]))
    }

    /// The largest magnitude of a formula over all corners of the parameters' ranges, at least 1.
    ///
    /// A potentiometer cannot exceed 1. The result is the factor by which the jack behind it must amplify, before it is
    /// rounded up to a power of ten.
    pub(super) fn largest(&self, formula: &Formula) -> f64 {
        let mut values = NamedValues { values: Vec::new() };
        for (role, quantity) in self.placement.site.quantities() {
            values.values.push((role, quantity.unit().to_si(quantity.per_volt())));
        }
        values.values.push(("time_scale", self.patch.time_scale));
        let constants = values.values.len();
        // The bits of the corner's number choose the end of each range.
        let corner = |number: usize| {
            let mut values = NamedValues { values: values.values[..constants].to_vec() };
            for (index, added) in self.parameters.iter().enumerate() {
                let factor = Unit::parse(&added.unit).map_or(1.0, |unit| unit.factor());
                values.values.push((&added.name_in_effect, factor * added.range[number >> index & 1]));
            }
            formula.evaluate(&values).ok().map(f64::abs)
        };
        (0..1 << self.parameters.len()).filter_map(corner).fold(1.0, f64::max)
    }
}

/// The values of the names in a formula, in SI units.
struct NamedValues<'a> {
    /// Name and value.
    values: Vec<(&'a str, f64)>,
}

impl Scope for NamedValues<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        self.values.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }

    fn dimension(&self, _: &str) -> Option<Dimension> {
        None
    }

    fn names(&self) -> Vec<&str> {
        self.values.iter().map(|(name, _)| *name).collect()
    }
}

/// The least power of ten from 1 to 1e12 that is not below a value; 1e12 if there is none.
pub(super) fn power_of_ten_above(value: f64) -> f64 {
    let mut ten = 1.0;
    while ten < value && ten < 1e12 {
        ten *= 10.0;
    }
    ten
}

/// A formula with other names. Names of functions, which an opening parenthesis follows, remain.
fn renamed_formula(text: &str, renames: &IndexMap<String, String>) -> String {
    let mut renamed = String::new();
    let mut rest = text;
    let is_in_name = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    while let Some(first) = rest.chars().next() {
        let length = rest.find(|letter| !is_in_name(letter)).unwrap_or(rest.len()).max(first.len_utf8());
        let (name, after) = rest.split_at(length);
        let is_function = after.trim_start().starts_with('(');
        match renames.get(name).filter(|_| !is_function) {
            Some(other) => renamed.push_str(other),
            None => renamed.push_str(name),
        }
        rest = after;
    }
    renamed
}
