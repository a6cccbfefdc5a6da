//! The JSON Schema of patch documents, made from the table of elements.

use serde_json::{Map, Value, json};

use super::document::FORMAT_VERSION;
use crate::document::LEAST_TOLERANCE;
use crate::elements::{Default, Family, Input, Jacks, Kind, Measure, REGISTRY, Setting};
use crate::machines::{self, Part, REFERENCE};

/// The schema (draft 2020-12) that editors can check and complete patches with.
pub fn json_schema() -> Value {
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "patchcord patch",
        "description": "A patch for the virtual analogue computer patchcord",
        "type": "object",
        "required": ["patchcord"],
        "additionalProperties": false,
        "properties": {
            "$schema": text("where this schema stands"),
            "patchcord": {"const": FORMAT_VERSION, "description": "version of the format"},
            "title": text("what the patch is"),
            "source": text("where it comes from"),
            "note": text("anything else"),
            "machine": {"enum": machine_names(), "description": "the machine it is made for"},
            "time_scale": {"type": "number", "exclusiveMinimum": 0, "description": "machine seconds per problem second"},
            "parameters": named(parameter()),
            "scales": named(scale()),
            "drives": named(one_of(Family::Drive)),
            "macros": named(macro_of_elements()),
            "elements": elements(),
            "signals": named(signal()),
            "run": run(),
            "record": names("signals, drives or elements to record"),
            "pictures": {"type": "array", "items": picture()},
        },
        "$defs": {"formula": formula(), "cords": cords(), "element": element(), "phases": phases()},
    })
}

fn machine_names() -> Vec<&'static str> {
    machines::ALL.iter().map(|machine| machine.name).collect()
}

fn text(description: &str) -> Value {
    json!({"type": "string", "description": description})
}

fn names(description: &str) -> Value {
    json!({"type": "array", "items": {"type": "string"}, "description": description})
}

fn named(value: Value) -> Value {
    json!({"type": "object", "additionalProperties": value})
}

fn object(required: &[&str], properties: Value) -> Value {
    json!({"type": "object", "required": required, "additionalProperties": false, "properties": properties})
}

fn formula() -> Value {
    json!({"type": ["number", "string"], "description": "a number, or a formula of parameters and scales"})
}

fn cords() -> Value {
    json!({
        "description": "the outputs plugged in: names of elements, drives, +100, -100 or ground",
        "oneOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
    })
}

fn parameter() -> Value {
    object(
        &["value", "unit"],
        json!({
            "value": {"type": "number"},
            "unit": text("unit of value and range, such as N s/m"),
            "range": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
            "description": text("what it is"),
            "note": text("anything else"),
        }),
    )
}

fn scale() -> Value {
    object(
        &["per_volt", "unit"],
        json!({
            "per_volt": {"$ref": "#/$defs/formula"},
            "unit": text("unit of the quantity"),
            "description": text("what it scales"),
            "note": text("anything else"),
        }),
    )
}

fn signal() -> Value {
    object(
        &["at"],
        json!({
            "at": text("the element at whose output it is read"),
            "scale": text("its scale; volts without one"),
            "factor": {"type": "number", "description": "what the scaled voltage is multiplied by"},
            "description": text("what it is"),
            "note": text("anything else"),
        }),
    )
}

fn run() -> Value {
    let time = json!({"type": "number", "exclusiveMinimum": 0, "description": "problem seconds"});
    let mut run = object(
        &[],
        json!({
            "for": time,
            "step": time,
            "tolerance": {
                "type": "number",
                "minimum": LEAST_TOLERANCE,
                "description": "what the errors of all steps may add up to, in machine units of 100 V",
            },
            "every": time,
            "repeat": {"type": "integer", "minimum": 1, "description": "runs from initial condition"},
            "hold_on_overload": {"type": "boolean"},
            "phases": {"$ref": "#/$defs/phases"},
            "note": text("anything else"),
        }),
    );
    let beside_phases = |key: &str| json!({"required": [key, "phases"]});
    run["not"] = json!({"anyOf": [beside_phases("for"), beside_phases("repeat")]});
    run
}

fn phases() -> Value {
    let time = json!({"type": "number", "exclusiveMinimum": 0, "description": "problem seconds"});
    let set = json!({
        "type": "object",
        "minProperties": 1,
        "additionalProperties": {"$ref": "#/$defs/formula"},
        "description": "parameters, and what they are set to: in formulas signals may stand too",
    });
    let times = json!({"type": "integer", "minimum": 1, "description": "how many times"});
    let one_of = [
        phase("initial_condition", json!({"const": true}), &[]),
        phase("operate", time.clone(), &[("until", until())]),
        phase("hold", time, &[]),
        phase("set", set, &[]),
        phase("repeat", times, &[("phases", json!({"$ref": "#/$defs/phases"}))]),
    ];
    json!({
        "type": "array",
        "minItems": 1,
        "items": {"oneOf": one_of},
        "description": "what is done in the run, one after the other",
    })
}

fn phase(deed: &str, value: Value, others: &[(&str, Value)]) -> Value {
    let mut properties = Map::from_iter([(deed.to_owned(), value)]);
    properties.extend(others.iter().map(|(key, value)| ((*key).to_owned(), value.clone())));
    properties.insert("note".into(), text("anything else"));
    let required: &[&str] = if deed == "repeat" { &["repeat", "phases"] } else { &[deed] };
    object(required, Value::Object(properties))
}

fn until() -> Value {
    let positions: Vec<_> = REGISTRY.iter().flat_map(|kind| kind.positions).collect();
    let relay = text("the relay that ends the phase");
    let becomes = json!({"enum": positions, "description": "the position that it must go to"});
    json!({
        "description": "the switching that ends the phase before its time",
        "oneOf": [{"type": "string"}, object(&["relay"], json!({"relay": relay, "becomes": becomes}))],
    })
}

fn picture() -> Value {
    object(
        &["y"],
        json!({
            "title": text("title above the picture"),
            "x": text("signal along the horizontal axis; t is time"),
            "y": {"$ref": "#/$defs/cords"},
            "note": text("anything else"),
        }),
    )
}

fn one_of(family: Family) -> Value {
    json!({"oneOf": kinds(family)})
}

fn kinds(family: Family) -> Vec<Value> {
    REGISTRY.iter().filter(|kind| kind.family == family).map(|kind| entry(kind)).collect()
}

fn elements() -> Value {
    named(json!({"$ref": "#/$defs/element"}))
}

/// An element of a kind, or an instance of a macro.
fn element() -> Value {
    let mut choices = kinds(Family::Computing);
    choices.push(instance());
    json!({"oneOf": choices})
}

/// Any other kind is a macro of the patch: its ports and settings are known there only.
fn instance() -> Value {
    let taken: Vec<_> = REGISTRY.iter().map(|kind| kind.name).collect();
    json!({
        "type": "object",
        "required": ["kind"],
        "properties": {
            "kind": {"type": "string", "not": {"enum": taken}, "description": "the name of a macro"},
            "note": text("anything else"),
        },
        "additionalProperties": {
            "type": ["string", "number", "array"],
            "items": {"type": "string"},
            "description": "what is plugged into an input of the macro, or the value of a setting",
        },
    })
}

fn macro_of_elements() -> Value {
    let ports = |description: &str| named(text(description));
    let mut outputs = ports("the element inside that it is");
    outputs["minProperties"] = 1.into();
    let setting = object(
        &["unit"],
        json!({
            "unit": text("its unit, such as s: plain numbers stand in it"),
            "default": {"$ref": "#/$defs/formula"},
            "description": text("what it does"),
            "note": text("anything else"),
        }),
    );
    object(
        &["outputs", "elements"],
        json!({
            "note": text("what it is"),
            "inputs": ports("what is plugged in there"),
            "outputs": outputs,
            "settings": named(setting),
            "elements": elements(),
        }),
    )
}

fn entry(kind: &Kind) -> Value {
    let mut properties = Map::new();
    properties.insert("kind".into(), json!({"const": kind.name, "description": kind.summary}));
    let mut required = vec!["kind"];
    inputs(kind, &mut properties, &mut required);
    for setting in kind.settings {
        insert_setting(setting, &mut properties);
        if setting.default == Default::Required {
            required.push(setting.name);
        }
    }
    if kind.family == Family::Drive {
        properties.insert("scale".into(), text("the scale of what it gives"));
        required.push("scale");
    } else {
        properties.insert("uses".into(), uses(kind));
    }
    properties.insert("note".into(), text("anything else"));
    object(&required, Value::Object(properties))
}

fn inputs(kind: &Kind, properties: &mut Map<String, Value>, required: &mut Vec<&'static str>) {
    let Some(main) = kind.inputs.first() else { return };
    if main.jacks == Jacks::Gains {
        properties.insert("in".into(), jacks(kind.inputs));
        required.extend(kind.inputs.iter().any(|input| input.required).then_some("in"));
        return;
    }
    for input in kind.inputs {
        properties.insert(input.name.into(), plugged(input));
        required.extend(input.required.then_some(input.name));
    }
}

fn jacks(inputs: &[Input]) -> Value {
    let (mut patterns, mut properties) = (Map::new(), Map::new());
    for input in inputs {
        match input.jacks {
            Jacks::Gains => patterns.insert(format!("^{}[0-9.]+$", input.name), plugged(input)),
            _ => properties.insert(input.name.to_owned(), plugged(input)),
        };
    }
    json!({
        "type": "object",
        "minProperties": 1,
        "additionalProperties": false,
        "patternProperties": patterns,
        "properties": properties,
    })
}

/// The cords of an input.
fn plugged(input: &Input) -> Value {
    let Jacks::Exactly(count) = input.jacks else {
        return json!({"$ref": "#/$defs/cords", "description": input.description});
    };
    let mut cords = names(input.description);
    cords["minItems"] = count.into();
    cords["maxItems"] = count.into();
    cords
}

fn insert_setting(setting: &Setting, properties: &mut Map<String, Value>) {
    match setting.name.split_once('.') {
        None => {
            properties.insert(setting.name.into(), value(setting));
        }
        Some((group, key)) => {
            let empty = json!({"type": "object", "additionalProperties": false, "properties": {}});
            let group = properties.entry(group).or_insert(empty);
            group["properties"][key] = value(setting);
        }
    }
}

fn value(setting: &Setting) -> Value {
    let description = format!("{} [{}]", setting.description, setting.unit());
    match setting.measure {
        Measure::Flag => json!({"type": "boolean", "description": description}),
        Measure::Choice(words) => json!({"enum": words, "description": description}),
        Measure::Points => points(json!({"type": "number"}), 1, &description),
        Measure::Curve(_) => {
            points(json!({"type": "number", "minimum": -REFERENCE, "maximum": REFERENCE}), 2, &description)
        }
        _ => json!({"$ref": "#/$defs/formula", "description": description}),
    }
}

/// A list of points, or the file that holds them.
fn points(number: Value, least: usize, description: &str) -> Value {
    let list = json!({
        "type": "array",
        "minItems": least,
        "items": {"type": "array", "items": number, "minItems": 2, "maxItems": 2},
    });
    let file = object(
        &["csv"],
        json!({
            "csv": text("CSV file, from the folder of the patch: a line of names, and a line of numbers for every point"),
            "x": text("column of the first numbers; the first column if absent"),
            "y": text("column of the second numbers; the one beside x if absent"),
        }),
    );
    json!({"oneOf": [list, file], "description": description})
}

fn uses(kind: &Kind) -> Value {
    let mut properties = Map::new();
    for part in Part::ALL.iter().filter(|part| kind.parts.iter().any(|takes| takes.part == **part)) {
        properties.insert(part.key().to_owned(), names("which of the machine's parts it is made of"));
    }
    json!({"type": "object", "additionalProperties": false, "properties": properties})
}

#[cfg(test)]
mod tests {
    use super::*;

    fn schema_of(kind: &str) -> Value {
        entry(REGISTRY.iter().find(|row| row.name == kind).unwrap())
    }

    #[test]
    fn an_input_that_takes_two_cords_says_so() {
        let cords = &schema_of("diode-lower-of")["properties"]["in"];
        assert_eq!((&cords["minItems"], &cords["maxItems"]), (&json!(2), &json!(2)));
    }

    #[test]
    fn required_are_the_inputs_that_the_patch_must_drive() {
        for kind in REGISTRY.iter().filter(|kind| kind.family == Family::Computing) {
            let schema = entry(kind);
            let required = schema["required"].as_array().unwrap();
            for input in kind.inputs.iter().filter(|_| kind.inputs[0].jacks != Jacks::Gains) {
                assert_eq!(
                    required.contains(&json!(input.name)),
                    input.required,
                    "{} {}",
                    kind.name,
                    input.name
                );
            }
        }
    }
}
