//! Carries out commands.

use super::checks::{check_divider, check_rate, check_speed, check_sweep, within};
use super::current_patch::{self, follow, recompile_if_turned};
use super::{Session, Shown, events, files, saved, table_access};
use crate::command::{Command, Mode};
use crate::compiled::advise;
use crate::document::{Document, Refusal};
use crate::event::{Event, NullMeter};
use crate::scope::{Scope, ScopeControls};

/// Carries out one command and adds its events to `list`.
///
/// # Errors
/// If the command is refused. Nothing is changed then.
pub(super) fn carry_out(
    session: &mut Session,
    command: &Command,
    must_stop: &mut dyn FnMut() -> bool,
    list: &mut Vec<Event>,
) -> Result<(), Refusal> {
    match command {
        Command::Hello => list.extend(events::hello(session)),
        Command::Open { name, text } => open(session, name, text, list)?,
        Command::OpenFile { name } => open_file(session, name, list)?,
        Command::New { machine } => begin(session, machine.as_deref(), list),
        Command::Text => list.push(events::text(session)),
        Command::Snapshot => list.push(Event::Snapshot { snapshot: saved::snapshot(session) }),
        Command::Restore { snapshot } => saved::restore(session, snapshot, list)?,
        Command::Mode { mode } => select_mode(session, *mode, list),
        Command::Speed { factor } => set_speed(session, *factor)?,
        Command::Pause { paused } => session.bench.controls.paused = *paused,
        Command::Sweep { seconds } => set_sweep(session, *seconds, list)?,
        Command::Rate { hertz } => set_rate(session, *hertz)?,
        Command::Scrub { time } => scrub(session, *time, must_stop)?,
        Command::Advance { seconds } => advance(session, *seconds, must_stop, list)?,
        Command::Scope { scope, controls } => set_scope(session, *scope, controls, list)?,
        Command::Erase { scope } => numbered(&mut session.scopes, *scope)?.erase(),
        Command::Meter { output } => connect_meter(session, output.as_deref())?,
        Command::NullMeter { output, divider } => connect_null_meter(session, output.as_deref(), *divider)?,
        Command::Views { schematic, equations } => {
            show(session, Shown { schematic: *schematic, equations: *equations }, list);
        }
        Command::Run => list.push(events::table(session)?),
        Command::Advise => search_corrections(session, list),
        Command::StaticCheck { seed } => static_check(session, *seed, list)?,
        edit => change_document(session, edit, list)?,
    }
    Ok(())
}

/// Opens a patch.
///
/// # Errors
/// As for [`Document::open`].
fn open(session: &mut Session, name: &str, text: &str, list: &mut Vec<Event>) -> Result<(), Refusal> {
    let document = Document::open(name, text, &table_access(&session.options))?;
    current_patch::open(session, document, list);
    Ok(())
}

/// Opens the patch in a file below the folder of the host.
///
/// # Errors
/// As for [`files::read`].
fn open_file(session: &mut Session, name: &str, list: &mut Vec<Event>) -> Result<(), Refusal> {
    let document = files::read(&session.options, name)?;
    current_patch::open(session, document, list);
    Ok(())
}

/// Begins with an empty patch for a machine; for that of the present patch if it is `None`.
fn begin(session: &mut Session, machine: Option<&str>, list: &mut Vec<Event>) {
    let present = session.document.patch().machine.as_ref().map(|name| &*name.value);
    let document = Document::empty(machine.or(present), &table_access(&session.options));
    current_patch::open(session, document, list);
}

/// Selects a mode. Another mode is a step of the history, which is in the view of the patch.
fn select_mode(session: &mut Session, mode: Mode, list: &mut Vec<Event>) {
    let before = session.bench.controls.mode;
    session.bench.set_mode(mode, &mut session.scopes);
    if before != mode {
        session.document.record_mode(before, mode);
        list.push(events::patch(session));
    }
}

/// Sets the speed factor.
///
/// # Errors
/// As for [`check_speed`].
fn set_speed(session: &mut Session, factor: Option<f64>) -> Result<(), Refusal> {
    check_speed(factor)?;
    session.bench.controls.speed = factor;
    Ok(())
}

/// Sets the rate of repetitive operation.
///
/// # Errors
/// As for [`check_rate`].
fn set_rate(session: &mut Session, hertz: Option<f64>) -> Result<(), Refusal> {
    check_rate(hertz)?;
    session.bench.controls.rate = hertz;
    Ok(())
}

/// Sets the length of a sweep. Only times of the machine change, so the patch is not compiled again.
///
/// # Errors
/// As for [`check_sweep`].
fn set_sweep(session: &mut Session, seconds: Option<f64>, list: &mut Vec<Event>) -> Result<(), Refusal> {
    check_sweep(seconds, session.document.patch())?;
    recompile_if_turned(session, list);
    session.bench.controls.sweep = seconds;
    current_patch::renew_machine(session, false);
    session.bench.set_mode(session.bench.controls.mode, &mut session.scopes);
    Ok(())
}

/// Moves the machine to another time of its run. The client has to know its state, also if only the time is another one.
///
/// # Errors
/// If the time is not within its run, or the patch has faults.
fn scrub(session: &mut Session, time: f64, must_stop: &mut dyn FnMut() -> bool) -> Result<(), Refusal> {
    session.bench.scrub(time, &mut session.scopes, must_stop).map_err(Refusal::new)?;
    session.known = None;
    Ok(())
}

/// Advances the clock.
///
/// # Errors
/// If the time is out of range.
fn advance(
    session: &mut Session,
    seconds: f64,
    must_stop: &mut dyn FnMut() -> bool,
    list: &mut Vec<Event>,
) -> Result<(), Refusal> {
    within("the time to advance", Some(seconds), [0.0, 1.0])?;
    current_patch::finish_turning(session, seconds, list);
    session.bench.advance(seconds, &mut session.scopes, must_stop);
    Ok(())
}

/// Sets the controls of a scope.
///
/// # Errors
/// If there is no such scope, or a control has a value that is not permitted.
fn set_scope(
    session: &mut Session,
    number: usize,
    controls: &ScopeControls,
    list: &mut Vec<Event>,
) -> Result<(), Refusal> {
    numbered(&mut session.scopes, number)?.set_controls(controls.clone()).map_err(Refusal::new)?;
    session.bench.watch(&session.probes, &session.scopes);
    list.push(events::scopes(session));
    Ok(())
}

/// The scope of this number.
///
/// # Errors
/// If there is none.
fn numbered(scopes: &mut [Scope], number: usize) -> Result<&mut Scope, Refusal> {
    let last = scopes.len() - 1;
    scopes.get_mut(number).ok_or_else(|| Refusal::new(format!("there are scopes 0 ... {last}")))
}

/// Connects the voltmeter.
///
/// # Errors
/// If there is no such output.
fn connect_meter(session: &mut Session, output: Option<&str>) -> Result<(), Refusal> {
    check_output(session, output)?;
    session.meter = output.map(str::to_owned);
    Ok(())
}

/// Connects the null meter and sets its reference divider.
///
/// # Errors
/// If there is no such output, or the divider is out of range.
fn connect_null_meter(session: &mut Session, output: Option<&str>, divider: f64) -> Result<(), Refusal> {
    check_divider(divider)?;
    check_output(session, output)?;
    session.null_meter = NullMeter { output: output.map(str::to_owned), divider };
    Ok(())
}

/// Checks that the patch has an output of this name.
///
/// # Errors
/// If it does not.
fn check_output(session: &Session, output: Option<&str>) -> Result<(), Refusal> {
    match output {
        Some(output) if session.probes.element(output).is_none() => {
            Err(Refusal::new(format!("there is no output {output}")))
        }
        _ => Ok(()),
    }
}

/// Notes which views the page shows, and adds the events for new ones.
fn show(session: &mut Session, shows: Shown, list: &mut Vec<Event>) {
    let before = session.shows;
    session.shows = shows;
    if shows.schematic && !before.schematic {
        list.push(events::schematic(session));
    }
    if shows.equations && !before.equations {
        list.push(events::equations(session));
    }
}

/// Searches for corrections of equations that the wiring does not solve.
fn search_corrections(session: &mut Session, list: &mut Vec<Event>) {
    if let Some(report) = advise(session.document.patch()) {
        session.report = report;
    }
    list.push(events::findings(session));
}

/// Compares every output and derivative with the equations.
///
/// # Errors
/// If the patch has faults, or there are no voltages at the test values.
fn static_check(session: &mut Session, seed: Option<u64>, list: &mut Vec<Event>) -> Result<(), Refusal> {
    recompile_if_turned(session, list);
    list.push(events::static_check(session, seed)?);
    Ok(())
}

/// Carries out a command that edits the patch, or moves in the history.
///
/// # Errors
/// If the command is refused by the document, or the value of a parameter by the machine. Nothing is changed then.
fn change_document(session: &mut Session, command: &Command, list: &mut Vec<Event>) -> Result<(), Refusal> {
    let change = match command {
        Command::Undo => session.document.undo()?,
        Command::Redo => session.document.redo()?,
        edit => return current_patch::edit(session, edit, list),
    };
    follow(session, change, list);
    Ok(())
}
