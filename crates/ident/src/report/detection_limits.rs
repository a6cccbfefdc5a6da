//! Detection limits as text and as JSON documents.
//!
//! The verdict sentence quotes the most detectable effect. Tables list all limits with [`limit_text`]. For an effect
//! that is not detectable at any strength, [`needs_text`] says what data it needs.

use indexmap::IndexMap;
use serde::Serialize;

use crate::design::detectability::detection_limit::{DetectionLimit, best_sites};
use crate::effects::Library;
use crate::report::labels::label;
use crate::report::values::{ValueDocument, parameter_values_text, value_documents, value_text};

/// A detection limit as a JSON document.
///
/// Example of a detectable effect:
///
/// ```json
/// {
///   "name": "viscous-friction", "junction": "IV", "reads": [], "parameter": "c",
///   "seen": true, "value": 0.4, "unit": "N s/m", "with": {}
/// }
/// ```
///
/// An effect that is not detectable has `"seen": false` and none of the last three keys.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DetectionLimitDocument {
    /// Name of the effect.
    pub name: String,
    /// The element that it acts on.
    pub junction: String,
    /// The signals that it reads, if there is a choice.
    pub reads: Vec<String>,
    /// The parameter that is its strength.
    pub parameter: String,
    /// Whether some strength of the effect is detectable.
    pub seen: bool,
    /// The smallest detectable strength. The last three members are absent if no strength is detectable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The unit of the strength.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The values of the effect's other parameters at that strength, by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with: Option<IndexMap<String, ValueDocument>>,
}

impl From<&DetectionLimit> for DetectionLimitDocument {
    /// Copies the limit. `unit` and `with` are dropped if no strength is detectable, because they describe that
    /// strength.
    fn from(limit: &DetectionLimit) -> Self {
        let is_detectable = limit.is_detectable();
        DetectionLimitDocument {
            name: limit.effect.clone(),
            junction: limit.site.clone(),
            reads: limit.reads.clone(),
            parameter: limit.parameter.clone(),
            seen: is_detectable,
            value: limit.value,
            unit: is_detectable.then(|| limit.unit.clone()),
            with: is_detectable.then(|| value_documents(&limit.other_parameters)),
        }
    }
}

/// The effect of a limit at its site, for example "leak at I2".
pub fn limit_label(limit: &DetectionLimit) -> String {
    label(&limit.effect, &limit.site)
}

/// The limit as a sentence. None if no strength of the effect is detectable.
pub fn limit_sentence(limit: &DetectionLimit) -> Option<String> {
    let value = limit_text(limit)?;
    Some(format!("the smallest detectable {} has {} = {value}", limit_label(limit), limit.parameter))
}

/// The limit with its unit, for example "0.12 N". None if no strength of the effect is detectable.
pub fn limit_text(limit: &DetectionLimit) -> Option<String> {
    limit.value.map(|value| value_text(value, &limit.unit))
}

/// What the table of detection limits shows after a search that named no effect, as a heading without a full stop.
pub const DETECTION_LIMITS_INTRODUCTION: &str = "weakest effects that these data would have shown, each at the place and values where it is easiest to detect";

/// Headings of the table of detection limits.
pub const DETECTION_LIMIT_HEADINGS: [&str; 5] = ["effect", "at", "parameter", "weakest detectable", "with"];

/// The rows of the table of detection limits, one per effect: the site at which it is most detectable.
pub fn detection_limit_rows(limits: &[DetectionLimit]) -> Vec<[String; 5]> {
    let row = |limit: &DetectionLimit| {
        let value = limit_text(limit).unwrap_or_else(|| "not detectable".to_owned());
        let (effect, site, parameter) = (limit.effect.clone(), limit.site.clone(), limit.parameter.clone());
        [effect, site, parameter, value, parameter_values_text(&limit.other_parameters)]
    };
    best_sites(limits).into_iter().map(row).collect()
}

/// The data that the effect needs, for example "; needs: a drive with both signs". Empty if the library lacks the
/// effect.
pub fn needs_text(limit: &DetectionLimit, library: &Library) -> String {
    let effect = library.get(&limit.effect);
    effect.map(|effect| format!("; needs: {}", effect.excitation)).unwrap_or_default()
}
