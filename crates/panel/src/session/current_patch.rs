//! The patch on the panel: the machine follows its changes.

use super::bench::{Controls, Probes};
use super::checks::check_sweep;
use super::{Session, events};
use crate::command::Command;
use crate::compiled;
use crate::document::{Change, Document, Refusal};
use crate::event::{Event, NullMeter};
use crate::scope::Scope;
use crate::view;
use crate::wiring;

/// Seconds without a change of a parameter after which the views are made again. Until then they would delay the pictures
/// between two movements of a knob.
const TURNING_PAUSE: f64 = 0.25;

/// Replaces the patch and its history.
pub(super) fn open(session: &mut Session, document: Document, list: &mut Vec<Event>) {
    session.document = document;
    session.bench.controls = Controls { speed: session.bench.controls.speed, ..Controls::default() };
    use_patch(session, true);
    connect_usual_probes(session);
    list.extend(events::patch_and_views(session));
    list.push(events::scopes(session));
}

/// Puts the probes at the first signals of a patch: the voltmeter at the first one, the first two at scope 1, and as an
/// X-Y curve at scope 2 what the patch draws so.
fn connect_usual_probes(session: &mut Session) {
    let patch = session.document.patch();
    (session.meter, session.null_meter) = (view::usual_meter(patch), NullMeter::default());
    for (scope, controls) in session.scopes.iter_mut().zip(view::usual_scopes(patch)) {
        *scope = Scope::new();
        // Controls that name outputs of the patch are valid.
        let _ = scope.set_controls(controls);
    }
    session.bench.watch(&session.probes, &session.scopes);
}

/// Carries out a command that edits the patch.
///
/// # Errors
/// If the command is refused by the document, or the value of a parameter by the machine. Nothing is changed then.
pub(super) fn edit(session: &mut Session, command: &Command, list: &mut Vec<Event>) -> Result<(), Refusal> {
    let edited = session.document.edited(command)?;
    let mut machine_has_it = false;
    if let Command::Parameter { name, value } = command
        && !session.bench.is_blocked
    {
        session.bench.set_parameter(name, *value, &mut session.scopes).map_err(Refusal::new)?;
        machine_has_it = true;
    }
    match session.document.commit(edited) {
        Change::Parameter { name, value } if machine_has_it => note_turned(session, name, value, list),
        change => follow(session, change, list),
    }
    Ok(())
}

/// Makes the machine do what a change of the document needs.
pub(super) fn follow(session: &mut Session, change: Change, list: &mut Vec<Event>) {
    let Session { bench, scopes, .. } = session;
    match change {
        // A machine that waits, or does not take the value, is made again with it.
        Change::Parameter { name, value }
            if !bench.is_blocked && bench.set_parameter(&name, value, scopes).is_ok() =>
        {
            note_turned(session, name, value, list);
        }
        Change::Parameter { .. } | Change::Patch => {
            use_patch(session, false);
            list.extend(events::patch_and_views(session));
        }
        Change::Panel => list.push(events::patch(session)),
        Change::Mode(mode) => {
            bench.set_mode(mode, scopes);
            list.push(events::patch(session));
        }
    }
}

/// Notes that the machine has another value of a parameter.
fn note_turned(session: &mut Session, name: String, value: f64, list: &mut Vec<Event>) {
    session.turned = Some(0.0);
    list.push(Event::Parameter { name, value });
}

/// Compiles the patch again for the views when no parameter was turned for a while. The machine has the values already.
pub(super) fn finish_turning(session: &mut Session, seconds: f64, list: &mut Vec<Event>) {
    session.turned = session.turned.map(|turned| turned + seconds);
    if session.turned.is_some_and(|turned| turned >= TURNING_PAUSE) {
        recompile_if_turned(session, list);
    }
}

/// Compiles the patch again if parameters were turned since then.
pub(super) fn recompile_if_turned(session: &mut Session, list: &mut Vec<Event>) {
    if session.turned.is_some() {
        compile(session);
        list.extend(events::patch_and_views(session));
    }
}

/// Compiles the present patch for the machine. Without `resets` the machine continues with its states. A sweep that is
/// shorter than the step of the patch becomes that of the patch.
pub(super) fn use_patch(session: &mut Session, resets: bool) {
    compile(session);
    if check_sweep(session.bench.controls.sweep, session.document.patch()).is_err() {
        session.bench.controls.sweep = None;
    }
    renew_machine(session, resets);
}

/// Compiles the present patch.
fn compile(session: &mut Session) {
    let patch = session.document.patch();
    (session.report, session.compiled) = compiled::compile(patch);
    session.probes = Probes(wiring::outputs(patch));
    session.turned = None;
}

/// Makes a machine for the compiled patch and the length of a sweep. Without `resets` it continues with the states of the
/// present one.
pub(super) fn renew_machine(session: &mut Session, resets: bool) {
    session.bench.set_patch(session.compiled.as_ref(), resets, &session.probes, &mut session.scopes);
}
