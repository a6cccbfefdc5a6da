//! What matters: the derivatives of a trace, how large they grow, and all of a signal in one picture.

use super::scope::{ScopeError, picture};
use super::voltmeter::Extreme;
use crate::patch::{PictureSpec, Placed, Span};
use crate::plot::{Axis, Picture};
use crate::trace::{Derivative, Trace, Track};

/// How a signal follows a parameter in one run, where it does so most.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// The run, counted from 0.
    pub run: usize,
    /// Name of the derivative.
    pub name: String,
    /// Name of the signal.
    pub signal: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Text of the derivative's unit.
    pub unit: String,
    /// The derivative of largest size, and when it was met first.
    pub most: Extreme,
    /// By how many percent of its own largest size the signal changes there for a percent more of the parameter;
    /// nothing where either is 0.
    pub relative: Option<f64>,
}

/// The largest derivatives, one run after the other.
pub fn sensitivities(trace: &Trace) -> Vec<Sensitivity> {
    let of_run = |run| {
        let derivatives = trace.tracks.iter().filter_map(|track| Some((track, track.derivative.as_ref()?)));
        derivatives.filter_map(move |(track, of)| sensitivity(trace, run, track, of))
    };
    (0..trace.sweeps.len()).flat_map(of_run).collect()
}

fn sensitivity(trace: &Trace, run: usize, track: &Track, of: &Derivative) -> Option<Sensitivity> {
    let course = track.courses.get(run)?;
    let larger = if course.most.volts.abs() >= -course.least.volts { course.most } else { course.least };
    let most = Extreme { value: larger.volts * track.per_volt, time: larger.time };
    let signal = trace.track(&of.signal)?;
    let reached = signal.courses.get(run)?;
    let size = reached.least.volts.abs().max(reached.most.volts.abs()) * signal.per_volt.abs();
    let relative = (size > 0.0 && of.value != 0.0).then(|| (most.value * of.value).abs() / size);
    Some(Sensitivity {
        run,
        name: track.name.clone(),
        signal: of.signal.clone(),
        parameter: of.parameter.clone(),
        unit: track.unit.clone(),
        most,
        relative,
    })
}

/// A picture for every signal: its derivatives against time, each times its parameter, so that all are in the
/// signal's unit. Derivatives by what is 0, and those that are 0, are left out.
///
/// # Errors
/// Those of [`picture`].
pub fn sensitivity_pictures(trace: &Trace, note: Option<&str>) -> Result<Vec<Picture>, ScopeError> {
    let signals = trace.tracks.iter().filter(|track| track.derivative.is_none());
    let weighed = signals.map(|signal| (signal, weighed(trace, signal)));
    let drawn = weighed.filter(|(_, trace)| !trace.tracks.is_empty()).map(|(signal, trace)| {
        let drawn = picture(&trace, &spec(&signal.name, &trace), note.map(str::to_owned))?;
        // The names of several stand above.
        let several = drawn.channels.len() > 1;
        let label = if several { format!("p d {} / d p", signal.name) } else { drawn.vertical.label };
        Ok(Picture { vertical: Axis { label, ..drawn.vertical }, ..drawn })
    });
    drawn.collect()
}

/// A trace of what a signal owes to its parameters, but for those that it does not follow.
fn weighed(trace: &Trace, signal: &Track) -> Trace {
    let track = |track: &Track| {
        let of = track.derivative.as_ref().filter(|of| of.signal == signal.name && of.value != 0.0)?;
        track.volts.iter().find(|slope| **slope != 0.0)?;
        let name = format!("{} {}", of.parameter, track.name);
        let volts = track.volts.clone();
        Some(Track { volts, ..Track::new(name, &signal.unit, of.value * track.per_volt) })
    };
    Trace { tracks: trace.tracks.iter().filter_map(track).collect(), ..trace.without_tracks() }
}

fn spec(signal: &str, trace: &Trace) -> PictureSpec {
    let placed = |name: &str| Placed { value: name.to_owned(), span: Span::default() };
    let y = trace.tracks.iter().map(|track| placed(&track.name)).collect();
    PictureSpec { title: format!("What {signal} owes to its parameters"), x: placed("t"), y }
}
