//! The events about a session.

use patchcord_core::solve::{RunSettings, run};
use patchcord_draw::schematic::Schematic;

use super::Session;
use crate::compiled::compile;
use crate::document::Refusal;
use crate::event::{EquationsView, Event};
use crate::limits::{self, MAX_TABLE_BYTES};
use crate::places;
use crate::view;

/// The events with which a client begins: everything there is. The state of the machine follows at the end of the
/// answer.
pub(super) fn hello(session: &mut Session) -> Vec<Event> {
    session.known = None;
    let mut events = vec![view::hello()];
    events.extend(patch_and_views(session));
    events.push(scopes(session));
    events
}

/// The event about the patch.
pub(super) fn patch(session: &Session) -> Event {
    let runs = session.compiled.is_some();
    Event::Patch(Box::new(view::patch_view(&session.document, &session.report, runs)))
}

/// The events about the patch, its faults, and the views that the page shows.
pub(super) fn patch_and_views(session: &Session) -> Vec<Event> {
    let mut events = vec![patch(session), findings(session)];
    if session.shows.schematic {
        events.push(schematic(session));
    }
    if session.shows.equations {
        events.push(equations(session));
    }
    events
}

/// The event about the findings of the checker.
pub(super) fn findings(session: &Session) -> Event {
    let document = &session.document;
    let findings = places::findings(&session.report, document.patch(), document.pulled_jacks());
    Event::Findings { findings }
}

/// The event with the schematic.
pub(super) fn schematic(session: &Session) -> Event {
    let Some(compiled) = &session.compiled else {
        let message = Some("the schematic is drawn again when the patch has no faults".to_owned());
        return Event::Schematic { drawing: None, message };
    };
    match Schematic::new(&compiled.circuit, "", "", &|_| None) {
        Ok(schematic) => Event::Schematic { drawing: Some(schematic.to_live_json()), message: None },
        Err(error) => Event::Schematic { drawing: None, message: Some(error.to_string()) },
    }
}

/// The event with the equations.
pub(super) fn equations(session: &Session) -> Event {
    let compiled = session.compiled.as_ref();
    let view = compiled.map(|compiled| view::equations(&compiled.circuit, &compiled.program));
    Event::Equations(view.unwrap_or_else(|| EquationsView {
        message: Some("the equations are listed again when the patch has no faults".to_owned()),
        ..EquationsView::default()
    }))
}

/// The event with the controls of the scopes.
pub(super) fn scopes(session: &Session) -> Event {
    Event::Scopes { scopes: session.scopes.iter().map(|scope| scope.controls().clone()).collect() }
}

/// The event with the text of the patch.
pub(super) fn text(session: &Session) -> Event {
    let patch = session.document.patch();
    Event::Text { name: patch.file().to_owned(), text: patch.text().to_owned() }
}

/// The event with every output and derivative compared with the equations.
///
/// # Errors
/// If the patch has faults, or there are no voltages at the test values.
pub(super) fn static_check(session: &Session, seed: Option<u64>) -> Result<Event, Refusal> {
    let compiled = session.compiled.as_ref().ok_or_else(faulty)?;
    view::static_check_event(&compiled.circuit, &compiled.program, seed).map_err(Refusal::new)
}

/// The event with the samples of a complete run.
///
/// # Errors
/// If the patch cannot run, or if the run or its table are too large.
pub(super) fn table(session: &Session) -> Result<Event, Refusal> {
    let compiled = compile(session.document.patch()).1;
    let compiled = compiled.ok_or_else(faulty)?;
    let mut settings = RunSettings::of(&compiled.circuit).map_err(|error| Refusal::new(error.to_string()))?;
    // The command makes these checks. They evaluate further instants, and the last digits of a loop's solution
    // depend on the solution before it.
    (settings.checks_steps, settings.finds_amplifier_peaks) = (true, true);
    limits::limit_run(&mut settings, compiled.circuit.elements().len()).map_err(Refusal::new)?;
    let trace = run(&compiled.program, &settings)
        .map_err(|stopped| Refusal::new(limits::run_message(&stopped.error)))?;
    let mut csv = Vec::new();
    trace.write_csv(&mut csv).map_err(|error| Refusal::new(error.to_string()))?;
    if csv.len() > MAX_TABLE_BYTES {
        return Err(Refusal::new(limits::table_too_large()));
    }
    let overloads = trace.overloads().map(|overload| overload.element.clone()).collect();
    let csv = String::from_utf8(csv).map_err(|error| Refusal::new(error.to_string()))?;
    Ok(Event::Table { csv, overloads })
}

/// The refusal of a command that needs a patch without faults.
fn faulty() -> Refusal {
    Refusal::new("the patch has faults; correct them first")
}
