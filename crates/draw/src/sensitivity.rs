//! Sensitivity pictures: all derivatives of a signal in one picture.

use crate::picture_data::ScopeError;
use crate::plot::{Axis, Picture};
use crate::scope::picture;
use patchcord_analysis::instruments::SignalFault;
use patchcord_core::document::{Placed, Span};
use patchcord_core::patch::PictureSpec;
use patchcord_core::trace::{Trace, Track};

/// Returns a picture for each signal: its derivatives with respect to parameters against time.
///
/// Each derivative is multiplied by its parameter, p ds/dp, so that all have the unit of the signal.
/// Derivatives with respect to parameters of value 0, and derivatives that are 0, are omitted. The derivatives of a
/// signal are wrong where the signal is, which `faults` says.
///
/// # Errors
///
/// As for [`picture`].
///
/// # Examples
///
/// ```
/// use patchcord_draw::sensitivity_pictures;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // dx/dt = -k x, from x = 50 V
/// let integrator = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
/// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
/// let patch = PatchBuilder::new("Decay").parameter("k", 0.5, "1", [0.0, 1.0]).run(2.0, 1e-3).record(["A1"]);
/// let patch = patch.element("A1", integrator).element("P1", pot).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let settings = RunSettings::of(&circuit)?.with_sensitivities(["k"]);
/// let trace = run(&Program::new(&circuit)?, &settings)?;
///
/// let pictures = sensitivity_pictures(&trace, None, &[])?;
/// assert_eq!(pictures.len(), 1);
/// assert_eq!(pictures[0].title, "What A1 owes to its parameters");
/// # Ok(())
/// # }
/// ```
pub fn sensitivity_pictures(
    trace: &Trace,
    note: Option<&str>,
    faults: &[SignalFault],
) -> Result<Vec<Picture>, ScopeError> {
    let signals = trace.tracks.iter().filter(|track| track.derivative.is_none());
    let scaled = signals.map(|signal| (signal, scaled_derivatives(trace, signal)));
    let drawn = scaled.filter(|(_, trace)| !trace.tracks.is_empty()).map(|(signal, trace)| {
        let faults = derivative_faults(faults, &signal.name, &trace);
        let drawn = picture(&trace, &spec(&signal.name, &trace), note, &faults)?;
        // The names of several derivatives are in the legend.
        let several = drawn.channels.len() > 1;
        let label = if several { format!("p d {} / d p", signal.name) } else { drawn.vertical.label };
        Ok(Picture { vertical: Axis { label, ..drawn.vertical }, ..drawn })
    });
    drawn.collect()
}

/// Returns a trace of the nonzero derivatives of a signal, each multiplied by its parameter.
fn scaled_derivatives(trace: &Trace, signal: &Track) -> Trace {
    let track = |track: &Track| {
        let of = track.derivative.as_ref().filter(|of| of.signal == signal.name && of.value != 0.0)?;
        track.volts.iter().find(|slope| **slope != 0.0)?;
        let name = format!("{} {}", of.parameter, track.name);
        let volts = track.volts.clone();
        Some(Track { volts, ..Track::new(name, &signal.unit, of.value * track.per_volt) })
    };
    Trace { tracks: trace.tracks.iter().filter_map(track).collect(), ..trace.without_tracks() }
}

/// Returns the faults of a signal, as faults of every derivative in the trace.
fn derivative_faults(faults: &[SignalFault], signal: &str, trace: &Trace) -> Vec<SignalFault> {
    let own = faults.iter().filter(|fault| fault.signal == signal);
    let of_each_track = |fault: &SignalFault| -> Vec<SignalFault> {
        let of_track = |track: &Track| SignalFault { signal: track.name.clone(), ..fault.clone() };
        trace.tracks.iter().map(of_track).collect()
    };
    own.flat_map(of_each_track).collect()
}

/// Returns the specification of a picture of all tracks of a trace against time.
fn spec(signal: &str, trace: &Trace) -> PictureSpec {
    let placed = |name: &str| Placed { value: name.to_owned(), span: Span::default() };
    let y = trace.tracks.iter().map(|track| placed(&track.name)).collect();
    let title = format!("What {signal} owes to its parameters");
    PictureSpec { title, x: placed("t"), y, equal_scales: true }
}
