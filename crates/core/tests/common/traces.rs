//! Bitwise comparison of traces.

use patchcord_core::trace::{Overload, SignalExtremes, Trace};

/// The bits of every number of a trace. They distinguish 0 from -0, which compare equal as numbers.
pub(crate) fn bits(trace: &Trace) -> Vec<u64> {
    let volts = trace.tracks.iter().flat_map(|track| track.volts.iter().copied());
    let extremes = trace.tracks.iter().flat_map(|track| &track.extremes).flat_map(extreme_values);
    let overloads = trace.overloads().flat_map(overload_values);
    let phases =
        trace.phase_records.iter().flat_map(|record| [record.begin, record.end, record.problem_time]);
    let ends = trace.repetitions.iter().map(|repetition| repetition.end);
    let all =
        trace.time.iter().copied().chain(volts).chain(extremes).chain(overloads).chain(phases).chain(ends);
    all.map(f64::to_bits).collect()
}

/// The numbers of an overload.
fn overload_values(overload: &Overload) -> Vec<f64> {
    let driven = overload.driven().into_iter().flat_map(|driven| [driven.limit, driven.seconds, driven.rate]);
    overload.peak().into_iter().chain(driven).chain([overload.time]).collect()
}

/// The numbers of a signal's extremes.
pub(crate) fn extreme_values(extremes: &SignalExtremes) -> [f64; 6] {
    let SignalExtremes { start, end, least, most } = extremes;
    [*start, *end, least.volts, least.time, most.volts, most.time]
}
