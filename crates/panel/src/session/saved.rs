//! A session as a snapshot. Its content is checked before a session takes it.

use patchcord_core::patch::TableAccess;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::bench::Controls;
use super::checks::{check_divider, check_rate, check_speed, check_sweep};
use super::current_patch::use_patch;
use super::{Session, events, table_access};
use crate::command::{Mode, PROTOCOL_VERSION};
use crate::document::{Document, Refusal};
use crate::event::{Event, NullMeter};
use crate::scope::{SCOPES, Scope, ScopeControls};

/// A saved session.
struct Saved {
    /// The patch and its history.
    document: Document,
    /// The mode of the machine.
    mode: Mode,
    /// The speed factor; `None` for as fast as possible.
    speed: Option<f64>,
    /// Length of a sweep in problem seconds; `None` for that of the patch.
    sweep: Option<f64>,
    /// Sweeps per second of the clock; `None` if the speed decides.
    rate: Option<f64>,
    /// The scopes, with empty screens.
    scopes: Vec<Scope>,
    /// The output at the voltmeter.
    meter: Option<String>,
    /// The null meter.
    null_meter: NullMeter,
}

/// The session as data.
pub(super) fn snapshot(session: &Session) -> Value {
    let scopes: Vec<&ScopeControls> = session.scopes.iter().map(Scope::controls).collect();
    let controls = &session.bench.controls;
    json!({
        "protocol": PROTOCOL_VERSION,
        "document": session.document.snapshot(),
        "mode": controls.mode,
        "speed": controls.speed,
        "sweep": controls.sweep,
        "rate": controls.rate,
        "scopes": scopes,
        "meter": session.meter,
        "null_meter": session.null_meter,
    })
}

/// Replaces the session by one from a snapshot.
///
/// # Errors
/// If the snapshot is not one of this version, or has a value that is not permitted. Nothing is changed then.
pub(super) fn restore(session: &mut Session, snapshot: &Value, list: &mut Vec<Event>) -> Result<(), Refusal> {
    let saved = read(snapshot, &table_access(&session.options))?;
    let Saved { document, mode, speed, sweep, rate, scopes, meter, null_meter } = saved;
    session.document = document;
    session.scopes = scopes;
    session.bench.controls = Controls { speed, sweep, rate, ..Controls::default() };
    use_patch(session, true);
    session.bench.set_mode(mode, &mut session.scopes);
    (session.meter, session.null_meter) = (meter, null_meter);
    list.extend(events::hello(session));
    Ok(())
}

/// Reads a snapshot.
///
/// # Errors
/// If it is not one of this version, or has a value that is not permitted.
fn read(snapshot: &Value, table_access: &TableAccess) -> Result<Saved, Refusal> {
    if snapshot["protocol"] != PROTOCOL_VERSION {
        return Err(Refusal::new("the saved session is of another version of the panel"));
    }
    let document = Document::restore(&snapshot["document"], table_access)?;
    let [speed, sweep, rate]: [Option<f64>; 3] =
        [field(snapshot, "speed")?, field(snapshot, "sweep")?, field(snapshot, "rate")?];
    check_speed(speed)?;
    check_sweep(sweep, document.patch())?;
    check_rate(rate)?;
    let null_meter = field::<Option<NullMeter>>(snapshot, "null_meter")?.unwrap_or_default();
    check_divider(null_meter.divider)?;
    Ok(Saved {
        mode: field(snapshot, "mode")?,
        speed,
        sweep,
        rate,
        scopes: scopes(field(snapshot, "scopes")?)?,
        meter: field(snapshot, "meter")?,
        null_meter,
        document,
    })
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
