//! The JSON Schema of patch documents.
//!
//! The schema is made from the registry of elements and the table of machines, so it cannot differ from what the
//! decoder reads. Editors use it to complete keys and to mark faults. It cannot check names of cords and units of
//! formulas; the program does.

mod kind;

use serde_json::{Map, Value, json};

use super::document::FORMAT_VERSION;
use crate::document::{MAX_TOLERANCE, MIN_TOLERANCE};
use crate::elements::{Family, REGISTRY};
use crate::machines;
use kind::entry;

/// The JSON Schema (draft 2020-12) of a patch document.
///
/// The file docs/patch.schema.json contains it. Every description is a short text that editors show for a
/// key.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::json_schema;
///
/// let schema = json_schema();
/// assert_eq!(schema["title"], "patchcord patch");
/// assert_eq!(schema["required"], serde_json::json!(["patchcord"]));
/// assert_eq!(schema["properties"]["time_scale"]["exclusiveMinimum"], 0);
/// ```
pub fn json_schema() -> Value {
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "patchcord patch",
        "description": "A patch for the virtual analogue computer patchcord",
        "type": "object",
        "required": ["patchcord"],
        "additionalProperties": false,
        "properties": {
            "$schema": text("where this schema is"),
            "patchcord": {"const": FORMAT_VERSION, "description": "version of the format"},
            "title": text("title of the patch"),
            "source": text("source of the patch"),
            "note": text("free text"),
            "machine": {"enum": machine_names(), "description": "the machine for which the patch is made"},
            "time_scale": {
                "type": "number",
                "exclusiveMinimum": 0,
                "description": "machine seconds per problem second",
            },
            "parameters": section(parameter()),
            "scales": section(scale()),
            "drives": section(drive()),
            "macros": section(macro_definition()),
            "elements": element_section(),
            "signals": section(signal()),
            "equations": equations(),
            "positive_feedback": {
                "type": "boolean",
                "description": "whether loops of integrators that amplify a deviation are intended",
            },
            "run": run(),
            "record": name_list("signals, drives or elements to record"),
            "pictures": {"type": "array", "items": picture()},
        },
        "$defs": {"formula": formula(), "cords": cords(), "element": element(), "phases": phases()},
    })
}

/// The names of all machines.
fn machine_names() -> Vec<&'static str> {
    machines::ALL.iter().map(|machine| machine.name).collect()
}

/// A text with a description.
fn text(description: &str) -> Value {
    json!({"type": "string", "description": description})
}

/// A list of names.
fn name_list(description: &str) -> Value {
    json!({"type": "array", "items": {"type": "string"}, "description": description})
}

/// An object with any names as keys, all with values of one form.
fn section(value: Value) -> Value {
    json!({"type": "object", "additionalProperties": value})
}

/// An object with these keys only.
fn object(required: &[&str], properties: Value) -> Value {
    json!({"type": "object", "required": required, "additionalProperties": false, "properties": properties})
}

/// A number or a formula.
fn formula() -> Value {
    json!({"type": ["number", "string"], "description": "a number, or a formula of parameters and scales"})
}

/// One cord or a list of cords.
fn cords() -> Value {
    json!({
        "description": "the outputs plugged in: names of elements, drives, +100, -100 or ground",
        "oneOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
    })
}

/// An entry of "parameters".
fn parameter() -> Value {
    object(
        &["value", "unit"],
        json!({
            "value": {"type": "number"},
            "unit": text("unit of value and range, such as N s/m"),
            "range": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
            "description": text("description"),
            "note": text("free text"),
        }),
    )
}

/// An entry of "scales".
fn scale() -> Value {
    object(
        &["per_volt", "unit"],
        json!({
            "per_volt": {"$ref": "#/$defs/formula"},
            "unit": text("unit of the quantity"),
            "description": text("description"),
            "note": text("free text"),
        }),
    )
}

/// An entry of "signals".
fn signal() -> Value {
    object(
        &["at"],
        json!({
            "at": text("the element or drive whose output is read"),
            "scale": text("scale of the signal; volts if absent"),
            "factor": {"type": "number", "description": "factor by which the scaled voltage is multiplied"},
            "description": text("description"),
            "note": text("free text"),
        }),
    )
}

/// The section "equations": one equation or a list of equations.
fn equations() -> Value {
    json!({
        "description": "the equations that the wiring is meant to solve, such as m x'' = -k x",
        "oneOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
    })
}

/// The section "run". "for" and "repeat" exclude "phases".
fn run() -> Value {
    let time = json!({"type": "number", "exclusiveMinimum": 0, "description": "problem seconds"});
    let mut run = object(
        &[],
        json!({
            "for": time,
            "step": time,
            "tolerance": {
                "type": "number",
                "minimum": MIN_TOLERANCE,
                "maximum": MAX_TOLERANCE,
                "description": "permitted sum of the errors of all steps, in machine units of 100 V",
            },
            "every": time,
            "repeat": {"type": "integer", "minimum": 1, "description": "runs from initial condition"},
            "hold_on_overload": {"type": "boolean"},
            "phases": {"$ref": "#/$defs/phases"},
            "note": text("free text"),
        }),
    );
    let with_phases = |key: &str| json!({"required": [key, "phases"]});
    run["not"] = json!({"anyOf": [with_phases("for"), with_phases("repeat")]});
    run
}

/// The list "phases". Each phase has one of five forms.
fn phases() -> Value {
    let time = json!({"type": "number", "exclusiveMinimum": 0, "description": "problem seconds"});
    let set = json!({
        "type": "object",
        "minProperties": 1,
        "additionalProperties": {"$ref": "#/$defs/formula"},
        "description": "parameters and their new values; formulas may also contain signals",
    });
    let times = json!({"type": "integer", "minimum": 1, "description": "number of repetitions"});
    let forms = [
        phase("initial_condition", json!({"const": true}), &[]),
        phase("operate", time.clone(), &[("until", until())]),
        phase("hold", time, &[]),
        phase("set", set, &[]),
        phase("repeat", times, &[("phases", json!({"$ref": "#/$defs/phases"}))]),
    ];
    json!({
        "type": "array",
        "minItems": 1,
        "items": {"oneOf": forms},
        "description": "the phases of the run, in order",
    })
}

/// A phase: the key of the action with its value, and the other keys that the action permits.
///
/// A repetition needs its list of phases in addition to the number of repetitions.
fn phase(action: &str, value: Value, other_keys: &[(&str, Value)]) -> Value {
    let mut properties = Map::from_iter([(action.to_owned(), value)]);
    properties.extend(other_keys.iter().map(|(key, value)| ((*key).to_owned(), value.clone())));
    properties.insert("note".into(), text("free text"));
    let required: &[&str] = if action == "repeat" { &["repeat", "phases"] } else { &[action] };
    object(required, Value::Object(properties))
}

/// The relay that ends a phase: its name, or an object with the relay and the position.
fn until() -> Value {
    let positions: Vec<_> = REGISTRY.iter().flat_map(|kind| kind.positions).collect();
    let relay = text("the relay that ends the phase");
    let becomes = json!({"enum": positions, "description": "the position to which the relay must switch"});
    json!({
        "description": "the relay that ends the phase early",
        "oneOf": [{"type": "string"}, object(&["relay"], json!({"relay": relay, "becomes": becomes}))],
    })
}

/// A picture.
fn picture() -> Value {
    object(
        &["y"],
        json!({
            "title": text("title above the picture"),
            "x": text("signal along the horizontal axis; t is time"),
            "y": {"$ref": "#/$defs/cords"},
            "equal_scales": {
                "type": "boolean",
                "description": "same length of one unit on both axes if they have the same unit; true if absent",
            },
            "note": text("free text"),
        }),
    )
}

/// An entry of "drives": one of the kinds of drives.
fn drive() -> Value {
    json!({"oneOf": entries(Family::Drive)})
}

/// The entries of all kinds of a family.
fn entries(family: Family) -> Vec<Value> {
    REGISTRY.iter().filter(|kind| kind.family == family).map(|kind| entry(kind)).collect()
}

/// A section "elements": that of the patch or of a macro.
fn element_section() -> Value {
    section(json!({"$ref": "#/$defs/element"}))
}

/// An entry of "elements": an element of a kind, or an instance of a macro.
fn element() -> Value {
    let mut forms = entries(Family::Computing);
    forms.push(instance());
    json!({"oneOf": forms})
}

/// An instance of a macro. Its kind is any text that is not the name of a kind. The schema does not know the ports and
/// settings of the macro, so it permits any keys.
fn instance() -> Value {
    let kind_names: Vec<_> = REGISTRY.iter().map(|kind| kind.name).collect();
    json!({
        "type": "object",
        "required": ["kind"],
        "properties": {
            "kind": {"type": "string", "not": {"enum": kind_names}, "description": "the name of a macro"},
            "note": text("free text"),
        },
        "additionalProperties": {
            "type": ["string", "number", "array"],
            "items": {"type": "string"},
            "description": "the cord into an input of the macro, or the value of a setting",
        },
    })
}

/// An entry of "macros".
fn macro_definition() -> Value {
    let ports = |description: &str| section(text(description));
    let mut outputs = ports("the element inside the macro whose output it is");
    outputs["minProperties"] = 1.into();
    let setting = object(
        &["unit"],
        json!({
            "unit": text("unit of plain numbers, such as s"),
            "default": {"$ref": "#/$defs/formula"},
            "description": text("effect of the setting"),
            "note": text("free text"),
        }),
    );
    object(
        &["outputs", "elements"],
        json!({
            "note": text("free text"),
            "inputs": ports("description of the input"),
            "outputs": outputs,
            "settings": section(setting),
            "elements": element_section(),
        }),
    )
}

#[cfg(test)]
mod tests;
