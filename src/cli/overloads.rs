//! Formats overloads as text and as JSON.

use std::path::Path;

use serde::Serialize;

use super::failure::Failure;
use super::files::quoted;
use super::load::problem_check;
use super::standard_streams::is_dash;
use patchcord::circuit::Circuit;
use patchcord::document::escape_controls;
use patchcord::equations::{Agreement, compare_equations};
use patchcord::instruments::{overload_demand, overload_remedy};
use patchcord::ir::Program;
use patchcord::linear::{GrowingLoop, check_size, unintended_growth};
use patchcord::trace::{LimitDrive, Overload, StepCause, StepWarning, Trace};

/// The codes that begin and end the colour of overloads on a terminal: bold red, as for errors.
const COLOUR: [&str; 2] = ["\x1b[1;31m", "\x1b[0m"];

/// The overloads of one run, one per line. `run` is the beginning of each line, such as "run 2: ". `is_coloured` adds
/// the colour of errors.
pub(super) fn overload_lines(run: &str, overloads: &[Overload], is_coloured: bool) -> String {
    let [begin, end] = if is_coloured { COLOUR } else { ["", ""] };
    let lines = overloads.iter().enumerate();
    lines.map(|(order, overload)| format!("{begin}{run}{}{end}\n", overload_text(order, overload))).collect()
}

/// An overload in one line. `order` is its position among those of its run, from 0.
fn overload_text(order: usize, overload: &Overload) -> String {
    let Overload { element, time, caused_by, .. } = overload;
    let cause = match caused_by {
        Some(cause) => format!("caused by {cause}"),
        None if order == 0 => "first".to_owned(),
        None => "not caused by an earlier one".to_owned(),
    };
    format!("overload: {element} at t = {time:.6} s, {} ({cause})", overload_demand(overload))
}

/// What to do about the first overload of a run, in one line. Empty if there is none. `patch` is the path of the patch.
///
/// If the wiring does not solve a stated equation, the line names the equation, because a wrong sign is the likeliest
/// cause then. If a loop that amplifies deviations can be the cause, the line names the loop: a larger scale would only
/// delay the overload. Otherwise it has a scale or gains with their new values. It names a command only if the patch is a file:
/// standard input cannot be read again. If the solver is unstable, the overload may be false. Then the text is empty,
/// because the advice about the step comes first.
pub(super) fn overload_advice(
    trace: &Trace,
    (circuit, program): (&Circuit, &Program),
    patch: &Path,
) -> String {
    let is_unstable = |warning: &StepWarning| matches!(warning.cause, StepCause::Unstable(_));
    if trace.step_warning.as_ref().is_some_and(is_unstable) {
        return String::new();
    }
    let Some(first) = trace.overloads().next() else { return String::new() };
    let command = |options: &str, purpose: &str| {
        let patch = escape_controls(&quoted(patch));
        format!("; `patchcord check {patch}{options}` {purpose}")
    };
    let (remedy, command) = if let Some(equation) = unsolved_equation(circuit, program) {
        let remedy = format!(
            "the wiring does not solve the stated equation {equation}: correct this before the scales, because \
             a wrong sign can cause the overload"
        );
        (remedy, command("", "says what differs"))
    } else if let Some(growing) = growing_loop_behind(circuit, program, first) {
        let remedy = format!("{}, and a larger scale only delays this", growing.description());
        (remedy, command("", "says how to correct it"))
    } else {
        let remedy = overload_remedy(circuit, trace).unwrap_or_default();
        (remedy, command(" --scaling", "compares scales and gains"))
    };
    let command: &str = if is_dash(patch) { "" } else { &command };
    format!("  = help: {remedy}{command}\n")
}

/// The first stated equation that the wiring does not solve. `None` if it solves all that can be compared, or if the
/// patch is too large for a comparison after a run.
fn unsolved_equation<'a>(circuit: &'a Circuit, program: &Program) -> Option<&'a str> {
    check_size(program).ok()?;
    let compared = compare_equations(circuit, program);
    let is_different = |agreement: &Agreement| matches!(agreement, Agreement::Different { .. });
    let different = compared.iter().find(|compared| is_different(&compared.agreement))?;
    Some(circuit.equations()[different.index].value.text())
}

/// The loop of integrators that amplifies deviations and can have caused an overload. `None` if there is none, or if
/// it is intended.
fn growing_loop_behind(circuit: &Circuit, program: &Program, overload: &Overload) -> Option<GrowingLoop> {
    check_size(program).ok()?;
    let machine = problem_check(circuit, program).ok()?;
    let growing = unintended_growth(circuit, &machine.state_space())?;
    growing.explains(circuit, &overload.element, overload.time).then_some(growing)
}

/// The failure of a run with overloads, with an exit code of its own. None if there is no overload.
pub(super) fn overload_failure(trace: &Trace) -> Option<Failure> {
    let first = trace.overloads().next()?;
    let more = match trace.overloads().count() - 1 {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    let advice = "the curves are wrong from there on; choose larger scales or smaller gains";
    let message = format!("overload of {} at t = {:.6} s{more}: {advice}", first.element, first.time);
    Some(Failure::overload(message))
}

/// An overload for `--json`: time in seconds, peak in volts. `driven` replaces a peak that is not known.
#[derive(Serialize)]
pub(super) struct OverloadDocument<'a> {
    element: &'a str,
    #[serde(rename = "t")]
    time: f64,
    peak: Option<f64>,
    driven: Option<DriveDocument>,
    caused_by: Option<&'a str>,
}

/// How an integrator was driven against its limit, for `--json`: the limit in volts, the longest time in seconds,
/// whether this time lasts to the end of the record, and the largest rate in volts per second.
#[derive(Serialize)]
struct DriveDocument {
    limit: f64,
    seconds: f64,
    to_end: bool,
    rate: f64,
}

impl From<LimitDrive> for DriveDocument {
    fn from(LimitDrive { limit, seconds, is_at_end, rate }: LimitDrive) -> Self {
        DriveDocument { limit, seconds, to_end: is_at_end, rate }
    }
}

impl<'a> OverloadDocument<'a> {
    /// The documents of several overloads, in the same order.
    pub(super) fn all(overloads: &'a [Overload]) -> Vec<Self> {
        let document = |overload: &'a Overload| OverloadDocument {
            element: &overload.element,
            time: overload.time,
            peak: overload.peak(),
            driven: overload.driven().map(DriveDocument::from),
            caused_by: overload.caused_by.as_deref(),
        };
        overloads.iter().map(document).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord::trace::Demand;

    #[test]
    fn overloads_are_coloured_on_request_only() {
        let demand = Demand::Peak(120.0);
        let overload = Overload { element: "A2".to_owned(), time: 0.31, demand, caused_by: None };
        let plain = "run 2: overload: A2 at t = 0.310000 s, needs 120.0 V (first)";
        let overloads = std::slice::from_ref(&overload);
        assert_eq!(overload_lines("run 2: ", overloads, false), format!("{plain}\n"));
        assert_eq!(overload_lines("run 2: ", overloads, true), format!("\x1b[1;31m{plain}\x1b[0m\n"));
    }
}
