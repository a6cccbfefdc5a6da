//! Detection limits in words and as a document.

use indexmap::IndexMap;
use serde::Serialize;

use crate::design::detectability::detection_limit::Limit;
use crate::effects::Library;
use crate::report::values::{ValueDocument, value_documents};
use patchcord_analysis::instruments::number;
use patchcord_core::document::behind;

/// A detection limit as a JSON document.
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
    /// Whether the data can show the effect at all.
    pub seen: bool,
    /// The smallest strength that shows; the three last members are absent if none does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The unit of the strength.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The values of the effect's other parameters at that strength, by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with: Option<IndexMap<String, ValueDocument>>,
}

impl From<&Limit> for DetectionLimitDocument {
    fn from(limit: &Limit) -> Self {
        let is_seen = limit.is_seen();
        DetectionLimitDocument {
            name: limit.effect.clone(),
            junction: limit.junction.clone(),
            reads: limit.reads.clone(),
            parameter: limit.parameter.clone(),
            seen: is_seen,
            value: limit.value,
            unit: is_seen.then(|| limit.unit.clone()),
            with: is_seen.then(|| value_documents(&limit.beside)),
        }
    }
}

/// The limit in a sentence; None if the data cannot show the effect at all.
pub fn limit_sentence(limit: &Limit) -> Option<String> {
    let value = limit_text(limit)?;
    Some(format!("the weakest {} that would have shown has {} = {value}", limit.named(), limit.parameter))
}

/// The limit with its unit, for example "0.12 N"; None if the data cannot show the effect at all.
pub fn limit_text(limit: &Limit) -> Option<String> {
    limit.value.map(|value| format!("{}{}", number(value), behind(&limit.unit)))
}

/// What data must hold for the effect to be judged, after a semicolon; empty if the library does not have the effect.
pub fn needs_text(limit: &Limit, library: &Library) -> String {
    let effect = library.get(&limit.effect);
    effect.map(|own| format!("; needs: {}", own.excitation)).unwrap_or_default()
}
