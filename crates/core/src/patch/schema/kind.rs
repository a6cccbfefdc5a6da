//! The schema of the elements and drives of one kind.

use serde_json::{Map, Value, json};

use super::{name_list, object, text};
use crate::elements::{Family, Input, Jacks, Kind, Setting, SettingDefault, SettingQuantity};
use crate::machines::{Part, REFERENCE};

/// An entry of one kind, with its inputs and settings.
///
/// Unknown keys are refused. Required keys are "kind", the inputs that must be driven, the settings without a
/// default and the scale of a drive.
pub(super) fn entry(kind: &Kind) -> Value {
    let mut properties = Map::new();
    properties.insert("kind".into(), json!({"const": kind.name, "description": kind.summary}));
    let mut required = vec!["kind"];
    inputs(kind, &mut properties, &mut required);
    for setting in kind.settings {
        insert_setting(setting, &mut properties);
        if setting.default == SettingDefault::Required {
            required.push(setting.name);
        }
    }
    if kind.family == Family::Drive {
        properties.insert("scale".into(), text("the scale of the drive's output"));
        required.push("scale");
    } else {
        properties.insert("uses".into(), machine_parts(kind));
    }
    properties.insert("note".into(), text("free text"));
    object(&required, Value::Object(properties))
}

/// Adds the inputs of a kind: one key "in" with jacks for an amplifier, otherwise a key for each input.
fn inputs(kind: &Kind, properties: &mut Map<String, Value>, required: &mut Vec<&'static str>) {
    if kind.has_gains() {
        properties.insert("in".into(), jacks(kind.inputs));
        required.extend(kind.inputs.iter().any(|input| input.required).then_some("in"));
        return;
    }
    for input in kind.inputs {
        properties.insert(input.name.into(), input_cords(input));
        required.extend(input.required.then_some(input.name));
    }
}

/// The object "in" of an amplifier. An input with gains permits any gain in its key: "x1", "x10", "x2.5".
fn jacks(inputs: &[Input]) -> Value {
    let (mut patterns, mut properties) = (Map::new(), Map::new());
    for input in inputs {
        match input.jacks {
            Jacks::Gains => patterns.insert(format!("^{}[0-9.]+$", input.name), input_cords(input)),
            _ => properties.insert(input.name.to_owned(), input_cords(input)),
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

/// The cords of an input: any number, or a list of the number that the input requires.
fn input_cords(input: &Input) -> Value {
    let Jacks::Exactly(count) = input.jacks else {
        return json!({"$ref": "#/$defs/cords", "description": input.description});
    };
    let mut cords = name_list(input.description);
    cords["minItems"] = count.into();
    cords["maxItems"] = count.into();
    cords
}

/// Adds a setting to the keys. A setting such as "limit.lower" is added to the object "limit".
fn insert_setting(setting: &Setting, properties: &mut Map<String, Value>) {
    match setting.name.split_once('.') {
        None => {
            properties.insert(setting.name.into(), setting_value(setting));
        }
        Some((group, key)) => {
            let empty = json!({"type": "object", "additionalProperties": false, "properties": {}});
            let group = properties.entry(group).or_insert(empty);
            group["properties"][key] = setting_value(setting);
        }
    }
}

/// The value of a setting, in the form of its quantity.
///
/// The description ends with the unit in brackets. A number in the document can be a formula too, except in points.
fn setting_value(setting: &Setting) -> Value {
    let description = format!("{} [{}]", setting.description, setting.unit());
    match setting.quantity {
        SettingQuantity::Flag => json!({"type": "boolean", "description": description}),
        SettingQuantity::Choice(words) => json!({"enum": words, "description": description}),
        SettingQuantity::Points => points(json!({"type": "number"}), 1, &description),
        SettingQuantity::Curve(_) => {
            points(json!({"type": "number", "minimum": -REFERENCE, "maximum": REFERENCE}), 2, &description)
        }
        _ => json!({"$ref": "#/$defs/formula", "description": description}),
    }
}

/// A list of at least `minimum_count` points, or a reference to a CSV file.
fn points(number: Value, minimum_count: usize, description: &str) -> Value {
    let list = json!({
        "type": "array",
        "minItems": minimum_count,
        "items": {"type": "array", "items": number, "minItems": 2, "maxItems": 2},
    });
    let file = object(
        &["csv"],
        json!({
            "csv": text("CSV file, relative to the folder of the patch: a line of column names, then a line per point"),
            "x": text("column of the first numbers; the first column if absent"),
            "y": text("column of the second numbers; the column to the right of x if absent"),
        }),
    );
    json!({"oneOf": [list, file], "description": description})
}

/// The object "uses": lists of machine parts, for the parts that the kind can use.
fn machine_parts(kind: &Kind) -> Value {
    let mut properties = Map::new();
    for part in Part::ALL.iter().filter(|part| kind.parts.iter().any(|takes| takes.part == **part)) {
        properties.insert(part.key().to_owned(), name_list("names of the machine's parts that it uses"));
    }
    json!({"type": "object", "additionalProperties": false, "properties": properties})
}
