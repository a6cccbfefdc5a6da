//! Which parameter matters: the derivatives of a trace, and how large they grow.

use super::voltmeter::Extreme;
use patchcord_core::trace::{Derivative, Trace, Track};

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
