//! Sets parameters, settings of elements and the time scale.

use std::collections::HashMap;
use std::iter;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{format_number, parameter_in_si, range_violation, suggestion, unit_suffix};
use patchcord_core::elements::{Setting, SettingDefault, SettingQuantity, Transfer};
use patchcord_core::patch::{ElementBuilder, ElementEntry, Instance, Patch};
use patchcord_expr::Formula;
use serde_json::Value;

use super::history::StepKind;
use super::{Document, Edited, Refusal};
use crate::event::{Finding, Place};
use crate::places;
use crate::wiring;

/// Sets a parameter. A value that makes a setting impossible is refused, as a pot cannot be turned beyond its end.
pub(super) fn parameter(document: &Document, name: &str, value: f64) -> Result<Edited, Refusal> {
    let patch = document.patch();
    let Some(parameter) = patch.parameters.get(name) else {
        let known: Vec<_> = patch.parameters.keys().map(String::as_str).collect();
        let hint = suggestion(name, &known).unwrap_or_else(|| "the patch has none".to_owned());
        return Err(Refusal::new(format!("there is no parameter {name}: {hint}")));
    };
    let refuse = |message: String| {
        Refusal::new(message).at(Place { parameter: Some(name.to_owned()), ..Place::default() })
    };
    let unit = (parameter.unit.text(), parameter.unit.factor());
    parameter_in_si(name, value, unit, parameter.range).map_err(|violation| {
        let kind = if violation.range.is_some() { "a value within it" } else { "another value" };
        refuse(format!("{violation}: choose {kind}"))
    })?;
    let mut editor = patch.edit();
    editor.set_parameter(name, value)?;
    let changed = document.reread(editor)?;
    if let Some(fault) = new_fault(patch, &changed) {
        let value = format_number(value) + &unit_suffix(unit.0);
        return Err(refuse(format!("{name} cannot be {value}: {}; {}", fault.message, fault.hint)));
    }
    let kind = StepKind::Parameter(name.to_owned());
    Ok(Edited { kind, ..Edited::patch(changed, format!("turn {name}")) })
}

/// The first error of a patch that an earlier version does not have at this place.
fn new_fault(before: &Patch, after: &Patch) -> Option<Finding> {
    let errors = |patch: &Patch| {
        let findings =
            Circuit::new(patch).err().map(|report| places::findings(&report, patch, &HashMap::new()));
        let mut findings = findings.unwrap_or_default();
        findings.retain(|finding| finding.severity == "error");
        findings
    };
    let found = errors(after);
    if found.is_empty() {
        return None;
    }
    let known = errors(before);
    let is_known = |finding: &Finding| {
        known.iter().any(|other| (&other.code, &other.place) == (&finding.code, &finding.place))
    };
    found.into_iter().find(|finding| !is_known(finding))
}

/// Sets the time scale.
pub(super) fn time_scale(document: &Document, value: f64) -> Result<Edited, Refusal> {
    if !(value.is_finite() && value > 0.0) {
        return Err(Refusal::new("the time scale is a positive number of machine seconds per second"));
    }
    let mut editor = document.patch().edit();
    editor.set_time_scale(value);
    Ok(Edited::patch(document.reread(editor)?, "set the time scale".to_owned()))
}

/// What has a setting.
enum Owner<'p> {
    /// An element.
    Element(&'p ElementEntry),
    /// A drive.
    Drive(&'p ElementEntry),
    /// An instance of a macro.
    Instance(&'p Instance),
}

/// Sets or removes a setting of an element, a drive or an instance.
pub(super) fn setting(
    document: &Document,
    element: &str,
    setting: &str,
    value: &Value,
) -> Result<Edited, Refusal> {
    let patch = document.patch();
    let place =
        Place { element: Some(element.to_owned()), setting: Some(setting.to_owned()), ..Place::default() };
    let refuse = |message: String| Refusal::new(message).at(place.clone());
    let owner = owner(patch, element)?;
    let value = checked_value(&owner, setting, value)
        .map_err(|fault| refuse(format!("{setting} of {element} {fault}")))?;
    let mut editor = patch.edit();
    match (&owner, value) {
        (Owner::Drive(_), Value::Null) => editor.put_drive(element, drive_without(patch, element, setting)),
        (_, Value::Null) => editor.remove_setting(element, setting)?,
        (Owner::Element(_), value) => editor.set_setting(element, setting, value)?,
        (Owner::Drive(_), value) => editor.put(path("drives", element, setting), value),
        (Owner::Instance(_), value) => editor.put(path("elements", element, setting), value),
    }
    let patch = document.reread(editor)?;
    let label = match &owner {
        Owner::Element(entry) if entry.kind.transfer == Transfer::Share => format!("turn {element}"),
        _ => format!("set {setting} of {element}"),
    };
    let kind = StepKind::Setting { element: element.to_owned(), setting: setting.to_owned() };
    Ok(Edited { kind, ..Edited::patch(patch, label) })
}

/// The entry of a drive in the document, without a setting.
fn drive_without(patch: &Patch, drive: &str, setting: &str) -> ElementBuilder {
    let mut entry = patch.value()["drives"][drive].as_object().cloned().unwrap_or_default();
    entry.shift_remove(setting);
    ElementBuilder::from_entry(entry)
}

/// The keys that lead to a setting in the document.
fn path<'k>(section: &'k str, element: &'k str, setting: &'k str) -> impl Iterator<Item = &'k str> {
    iter::once(section).chain([element]).chain(setting.split('.'))
}

/// The element, drive or instance with this name.
fn owner<'p>(patch: &'p Patch, name: &str) -> Result<Owner<'p>, Refusal> {
    if let Some(drive) = patch.drives.get(name) {
        return Ok(Owner::Drive(drive));
    }
    if wiring::is_in_section(patch, name) {
        let instance = patch.instances.get(name).map(Owner::Instance);
        if let Some(owner) = instance.or_else(|| patch.elements.get(name).map(Owner::Element)) {
            return Ok(owner);
        }
    }
    Err(Refusal::unknown(format!("there is no element {name}"), name, &wiring::entry_names(patch)))
}

/// The value for the document. The error is the predicate of a message.
fn checked_value(owner: &Owner<'_>, name: &str, value: &Value) -> Result<Value, String> {
    let entry = match owner {
        Owner::Element(entry) | Owner::Drive(entry) => entry,
        Owner::Instance(instance) => {
            let known: Vec<_> = instance.settings.keys().map(String::as_str).collect();
            if !known.contains(&name) {
                return Err(unknown_setting(name, &known));
            }
            return if value.is_null() { Ok(Value::Null) } else { number_or_formula(value, |_| Ok(())) };
        }
    };
    let settings = entry.kind.settings;
    let Some(row) = settings.iter().find(|row| row.name == name) else {
        let known: Vec<_> = settings.iter().map(|row| row.name).collect();
        return Err(unknown_setting(name, &known));
    };
    if value.is_null() {
        return removable(row);
    }
    match row.quantity {
        SettingQuantity::Flag if value.is_boolean() => Ok(value.clone()),
        SettingQuantity::Flag => Err("is true or false".to_owned()),
        SettingQuantity::Choice(words) if value.as_str().is_some_and(|word| words.contains(&word)) => {
            Ok(value.clone())
        }
        SettingQuantity::Choice(words) => Err(format!("is one of these words: {}", words.join(", "))),
        SettingQuantity::Points | SettingQuantity::Curve(_) if value.is_array() => Ok(value.clone()),
        SettingQuantity::Points | SettingQuantity::Curve(_) => {
            Err("is a list of points, such as [[0, 0], [100, 50]]".to_owned())
        }
        _ => number_or_formula(value, |number| check_number(row, number)),
    }
}

/// The message about a setting that does not exist.
fn unknown_setting(name: &str, known: &[&str]) -> String {
    let hint = suggestion(name, known).unwrap_or_else(|| "it has no settings".to_owned());
    format!("does not exist: {hint}")
}

/// Null, if the element works without the setting.
fn removable(row: &Setting) -> Result<Value, String> {
    match row.default {
        SettingDefault::Required => Err("cannot be removed: set it to another value".to_owned()),
        SettingDefault::Number(_) | SettingDefault::Absent => Ok(Value::Null),
    }
}

/// A number, or a formula in the right syntax. A text that is a number becomes a number.
fn number_or_formula(value: &Value, check: impl Fn(f64) -> Result<(), String>) -> Result<Value, String> {
    match value {
        Value::Number(number) => match number.as_f64().filter(|number| number.is_finite()) {
            Some(finite) => check(finite).map(|()| value.clone()),
            None => Err("is too large: choose a smaller number".to_owned()),
        },
        Value::String(text) => match text.trim().parse::<f64>() {
            Ok(number) => number_or_formula(&Value::from(number), check),
            Err(_) => {
                Formula::parse(text).map_err(|error| format!("is not a formula: {error}"))?;
                Ok(value.clone())
            }
        },
        _ => Err("is a number or a formula".to_owned()),
    }
}

/// Checks a number in the unit of a setting.
fn check_number(row: &Setting, number: f64) -> Result<(), String> {
    if !row.is_allowed(number) {
        let violation = range_violation(number, row.range, row.unit());
        return Err(format!("is {}, {violation}: choose a value within the range", format_number(number)));
    }
    if row.quantity == SettingQuantity::Whole && number.fract() != 0.0 {
        return Err("is a whole number".to_owned());
    }
    Ok(())
}
