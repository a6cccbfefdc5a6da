//! Formats overloads as text and as JSON.

use std::path::Path;

use serde::Serialize;

use super::failure::Failure;
use super::files::quoted;
use super::standard_streams::is_dash;
use patchcord::circuit::Circuit;
use patchcord::document::escape_controls;
use patchcord::instruments::overload_demand;
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
/// The line names the scale of the overloaded amplifier, if a signal there has one. It names the command that compares
/// scales only if the patch is a file: standard input cannot be read again. If the solver is unstable, the overload may
/// be false. Then the text is empty, because the advice about the step comes first.
pub(super) fn overload_advice(trace: &Trace, circuit: &Circuit, patch: &Path) -> String {
    let is_unstable = |warning: &StepWarning| matches!(warning.cause, StepCause::Unstable(_));
    if trace.step_warning.as_ref().is_some_and(is_unstable) {
        return String::new();
    }
    let Some(Overload { element, .. }) = trace.overloads().next() else { return String::new() };
    let mut signals = circuit.signals().iter();
    let scaled = signals.find_map(|point| {
        let scale = point.scale.filter(|_| circuit.element(point.element).name == *element)?;
        Some((&point.name, circuit.derived(scale).0))
    });
    let remedy = match scaled {
        Some((signal, scale)) => {
            let place = if signal == element { String::new() } else { format!(" at {element}") };
            format!("enlarge \"per_volt\" of \"{scale}\", the scale of {signal}{place}, and adapt the gains")
        }
        None => {
            format!("reduce the gains into {element}, or enlarge the scale of the quantity that it computes")
        }
    };
    let command = if is_dash(patch) {
        String::new()
    } else {
        let patch = escape_controls(&quoted(patch));
        format!("; `patchcord check {patch} --scaling` compares scales and gains")
    };
    format!("  = help: {remedy}{command}\n")
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
