//! All derivatives of a signal in one picture.

use crate::plot::{Axis, Picture};
use crate::scope::{ScopeError, picture};
use patchcord_core::document::{Placed, Span};
use patchcord_core::patch::PictureSpec;
use patchcord_core::trace::{Trace, Track};

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
