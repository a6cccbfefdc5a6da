//! Marks in a picture where its curves are wrong.
//!
//! The caller says which signals are wrong, from when and why. Every curve is pale where one of its two signals is
//! wrong. A warning under the title has the earliest cause. A picture against time also has a line at this time, and
//! its screen is darker from there on.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::picture_data::PointSource;
use crate::plot::{Marker, Picture};
use patchcord_analysis::format::{QuantityFormat, format_quantity};
use patchcord_analysis::instruments::SignalFault;
use patchcord_core::document::derivative_of;
use patchcord_core::patch::PictureSpec;
use patchcord_core::trace::Trace;

/// Marks the faults of the signals of a picture. `sources` are the points of its channels, and `across` is the display of
/// the values along the horizontal axis.
pub(super) fn mark(
    mut picture: Picture,
    (trace, sources): (&Trace, &[PointSource<'_>]),
    spec: &PictureSpec,
    faults: &[SignalFault],
    across: &QuantityFormat,
) -> Picture {
    let x = &spec.x.value;
    let curves: Vec<_> = spec.y.iter().map(|y| curve_faults(faults, [&y.value, x])).collect();
    let all = curves.iter().flatten().copied();
    let Some(first) = all.min_by(|one, other| one.time.total_cmp(&other.time)) else { return picture };
    for ((channel, faults), source) in picture.channels.iter_mut().zip(&curves).zip(sources) {
        channel.wrong = faults.iter().map(|fault| wrong_points(source, fault)).collect();
    }
    let label = format!("{} from {}", first.cause, time_text(first, x, across));
    picture.warning = Some(warning(&label, first, &curves, trace));
    if x == "t" {
        let at = across.value(first.time);
        picture.spans.push([at, picture.horizontal.high]);
        picture.markers.push(Marker { at, label });
    }
    picture
}

/// Returns the earliest fault of one of two signals in each run. A derivative is wrong if its signal is.
fn curve_faults<'f>(faults: &'f [SignalFault], names: [&str; 2]) -> Vec<&'f SignalFault> {
    let signals = names.map(|name| derivative_of(name).map_or(name, |(signal, _)| signal));
    let is_shown = |signal: &str| names.contains(&signal) || signals.contains(&signal);
    let mut earliest: Vec<&SignalFault> = Vec::new();
    for fault in faults.iter().filter(|fault| is_shown(&fault.signal)) {
        match earliest.iter_mut().find(|other| other.repetition == fault.repetition) {
            Some(other) if fault.time < other.time => *other = fault,
            Some(_) => (),
            None => earliest.push(fault),
        }
    }
    earliest
}

/// Returns the points from a fault to the end of its run.
fn wrong_points(source: &PointSource<'_>, fault: &SignalFault) -> Range<usize> {
    let first = |run: usize| source.begins.get(run).copied().unwrap_or(source.time.len());
    let (begin, end) = (first(fault.repetition), first(fault.repetition + 1));
    let times = source.time.get(begin..end).unwrap_or_default();
    begin + times.partition_point(|time| *time < fault.time)..end
}

/// Returns the time of a fault, in the unit of a time axis if there is one.
fn time_text(fault: &SignalFault, x: &str, across: &QuantityFormat) -> String {
    if x == "t" { across.text(fault.time) } else { format_quantity(fault.time, "s") }
}

/// Returns the warning under the title: the first fault, the run, and the number of other causes.
fn warning(label: &str, first: &SignalFault, curves: &[Vec<&SignalFault>], trace: &Trace) -> String {
    let run = match trace.repetitions.len() {
        0 | 1 => String::new(),
        _ => format!(" of run {}", first.repetition + 1),
    };
    let causes = curves.iter().flatten().map(|fault| (fault.repetition, fault.cause.as_str()));
    let more = match causes.collect::<BTreeSet<_>>().len() {
        0 | 1 => String::new(),
        count => format!(", and {} more", count - 1),
    };
    format!("{label}{run}{more}: curves are wrong where they are pale")
}
