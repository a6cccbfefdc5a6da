//! Reads commands and other values of an enum from a JSON object that has the name of the variant among its fields.

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// Reads a value of an enum from an object with the name of the variant under `key` and its fields at the same level.
///
/// It works like serde's attribute `tag`. But numbers in such an enum cannot be read while serde_json keeps their texts,
/// so the name is moved out of the object first.
///
/// # Errors
/// A message if there is no name, the name is unknown, or a field is missing, unknown or of the wrong type.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::read_variant;
/// use serde_json::json;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let object = json!({"command": "Ok", "seconds": 0.5}).as_object().cloned().ok_or("an object")?;
/// let variant: Result<std::collections::BTreeMap<String, f64>, u8> = read_variant(object, "command")?;
/// assert_eq!(variant.map(|fields| fields["seconds"]), Ok(0.5));
/// # Ok(())
/// # }
/// ```
pub fn read_variant<T: DeserializeOwned>(mut object: Map<String, Value>, key: &str) -> Result<T, String> {
    let Some(Value::String(name)) = object.remove(key) else {
        return Err(format!("a {key} is an object with its name under the key \"{key}\""));
    };
    let has_fields = !object.is_empty();
    let variant = Value::Object(Map::from_iter([(name.clone(), Value::Object(object))]));
    let outcome = serde_json::from_value(variant);
    // A variant without fields is a word. For other variants the first error is right: it names a missing field.
    let outcome = match outcome {
        Err(error) if !has_fields => serde_json::from_value(Value::String(name.clone())).map_err(|_| error),
        outcome => outcome,
    };
    outcome.map_err(|error| format!("{key} \"{name}\": {error}"))
}
