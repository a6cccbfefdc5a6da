//! The content of a snapshot, checked before a session takes it.

use patchcord_core::patch::TableAccess;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::{check_rate, check_speed, check_sweep};
use crate::command::{Mode, PROTOCOL_VERSION};
use crate::document::{Document, Refusal};
use crate::scope::{SCOPES, Scope, ScopeControls};

/// A saved session.
pub(super) struct Saved {
    /// The patch and its history.
    pub document: Document,
    /// The mode of the machine.
    pub mode: Mode,
    /// The speed factor; `None` for as fast as possible.
    pub speed: Option<f64>,
    /// Length of a sweep in problem seconds; `None` for that of the patch.
    pub sweep: Option<f64>,
    /// Sweeps per second of the clock; `None` if the speed decides.
    pub rate: Option<f64>,
    /// The scopes, with empty screens.
    pub scopes: Vec<Scope>,
    /// The output at the voltmeter.
    pub meter: Option<String>,
}

impl Saved {
    /// Reads a snapshot.
    ///
    /// # Errors
    /// If it is not one of this version, or has a value that is not permitted.
    pub(super) fn read(snapshot: &Value, table_access: &TableAccess) -> Result<Saved, Refusal> {
        if snapshot["protocol"] != PROTOCOL_VERSION {
            return Err(Refusal::new("the saved session is of another version of the panel"));
        }
        let document = Document::restore(&snapshot["document"], table_access)?;
        let [speed, sweep, rate]: [Option<f64>; 3] =
            [field(snapshot, "speed")?, field(snapshot, "sweep")?, field(snapshot, "rate")?];
        check_speed(speed)?;
        check_sweep(sweep, document.patch())?;
        check_rate(rate)?;
        Ok(Saved {
            mode: field(snapshot, "mode")?,
            speed,
            sweep,
            rate,
            scopes: scopes(field(snapshot, "scopes")?)?,
            meter: field(snapshot, "meter")?,
            document,
        })
    }
}

/// A field of a snapshot. An absent one is null.
///
/// # Errors
/// If its value has another form.
fn field<T: DeserializeOwned>(snapshot: &Value, key: &str) -> Result<T, Refusal> {
    let value = snapshot.get(key).cloned().unwrap_or_default();
    serde_json::from_value(value)
        .map_err(|error| Refusal::new(format!("the saved session cannot be read: {key}: {error}")))
}

/// The scopes with these controls. Those without controls have the usual ones.
///
/// # Errors
/// If a control has a value that is not permitted.
fn scopes(controls: Vec<ScopeControls>) -> Result<Vec<Scope>, Refusal> {
    let mut scopes: Vec<Scope> = (0..SCOPES).map(|_| Scope::new()).collect();
    for (scope, controls) in scopes.iter_mut().zip(controls) {
        scope.set_controls(controls).map_err(Refusal::new)?;
    }
    Ok(scopes)
}
