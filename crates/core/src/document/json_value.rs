//! Converts documents for programs into JSON values.

use serde::Serialize;
use serde_json::Value;

/// A document as a JSON value. A number that is not finite becomes null.
///
/// The conversion fails only if a map has keys that are not texts; no document has such a map. The value would be null.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::json_value;
///
/// assert_eq!(json_value(&[1.5, f64::NAN]).to_string(), "[1.5,null]");
/// ```
pub fn json_value(document: &(impl Serialize + ?Sized)) -> Value {
    serde_json::to_value(document).unwrap_or_default()
}
