//! Parameter sensitivities: the largest value of each recorded derivative of a signal.

use super::voltmeter::Extreme;
use patchcord_core::trace::{Derivative, Trace, Track};

/// The largest derivative of a signal with respect to a parameter in one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Index of the run, from 0.
    pub run: usize,
    /// Name of the derivative.
    pub name: String,
    /// Name of the signal.
    pub signal: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Unit of the derivative as text.
    pub unit: String,
    /// The derivative of largest absolute value, and the first time at which it occurs.
    pub most: Extreme,
    /// Relative sensitivity: |derivative x parameter| / largest absolute value of the signal. It is the change of the
    /// signal in percent per percent of the parameter. None if the signal or the parameter is 0.
    pub relative: Option<f64>,
}

/// The largest derivatives of a trace, run by run.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::sensitivities;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // dx/dt = -k x, from x = 50 V
/// let integrator = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
/// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
/// let patch = PatchBuilder::new("Decay").parameter("k", 0.5, "1", [0.0, 1.0]).run(1.0, 1e-3).record(["A1"]);
/// let patch = patch.element("A1", integrator).element("P1", pot).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let settings = RunSettings::of(&circuit)?.with_sensitivities(["k"]);
/// let trace = run(&Program::new(&circuit)?, &settings)?;
///
/// // x = 50 e^(-k t), so dx/dk = -50 t e^(-k t), which is largest at the end.
/// let found = &sensitivities(&trace)[0];
/// assert_eq!((found.signal.as_str(), found.parameter.as_str()), ("A1", "k"));
/// assert!((found.most.value + 50.0 * (-0.5f64).exp()).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
pub fn sensitivities(trace: &Trace) -> Vec<Sensitivity> {
    let of_run = |run| {
        let derivatives = trace.tracks.iter().filter_map(|track| Some((track, track.derivative.as_ref()?)));
        derivatives.filter_map(move |(track, of)| sensitivity(trace, run, track, of))
    };
    (0..trace.repetitions.len()).flat_map(of_run).collect()
}

/// The sensitivity of one derivative in one run. None if the run has no value of the derivative or of its signal, or if
/// the trace lacks the signal.
fn sensitivity(trace: &Trace, run: usize, track: &Track, of: &Derivative) -> Option<Sensitivity> {
    let extremes = track.extremes.get(run)?;
    let larger =
        if extremes.most.volts.abs() >= -extremes.least.volts { extremes.most } else { extremes.least };
    let most = Extreme { value: larger.volts * track.per_volt, time: larger.time };
    let signal = trace.track(&of.signal)?;
    let range = signal.extremes.get(run)?;
    let size = range.least.volts.abs().max(range.most.volts.abs()) * signal.per_volt.abs();
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
