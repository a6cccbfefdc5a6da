//! Traces compared to the last bit.

use patchcord_core::trace::{Course, Trace};

/// Every number that a run leaves, as its bits: 0 and -0 are equal, and not the same.
pub fn bits(trace: &Trace) -> Vec<u64> {
    let volts = trace.tracks.iter().flat_map(|track| track.volts.iter().copied());
    let courses = trace.tracks.iter().flat_map(|track| &track.courses).flat_map(parts);
    let overloads = trace.overloads().flat_map(|overload| [overload.time, overload.peak]);
    let marks = trace.marks.iter().flat_map(|mark| [mark.begin, mark.end, mark.problem_time]);
    let ends = trace.sweeps.iter().map(|sweep| sweep.end);
    let all =
        trace.time.iter().copied().chain(volts).chain(courses).chain(overloads).chain(marks).chain(ends);
    all.map(f64::to_bits).collect()
}

/// The numbers of a course.
pub fn parts(course: &Course) -> [f64; 6] {
    let Course { start, end, least, most } = course;
    [*start, *end, least.volts, least.time, most.volts, most.time]
}
