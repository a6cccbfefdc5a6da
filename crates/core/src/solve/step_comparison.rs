//! Compares a run with one of a shorter step, and recommends a step.

use super::step_check::StepDoubt;
use crate::ir::Program;
use crate::machines::REFERENCE;
use crate::trace::{Overload, StepCause, StepWarning, Trace, Track};

/// Difference of a signal between both runs, as a share of its range, above which the step is too long.
const LARGEST_SHARE: f64 = 1e-3;
/// Difference that the recommended step aims at, as a share of the range.
const RECOMMENDED_SHARE: f64 = 1e-4;
/// Least range of a signal to which its difference is related, in volts.
const LEAST_RANGE: f64 = 1e-4;
/// Difference of two samples in time up to which they are the same sample, as a share of the mean recording interval.
const SAME_SAMPLE: f64 = 1e-6;
/// Distance of an output from 100 V, in volts, that may be an error of the solver but no instability.
pub(super) const SLIGHT_EXCESS: f64 = 1.0;
/// Order of the error of a run: it grows with the step to this power.
const ERROR_ORDER: f64 = 4.0;

/// The largest difference of a signal between two runs.
struct Difference<'t> {
    /// Name of the signal.
    name: &'t str,
    /// Its unit.
    unit: &'t str,
    /// The largest difference, in the unit of the signal.
    largest: f64,
    /// The same as a share of the range.
    share: f64,
    /// Time at which the difference exceeded [`LARGEST_SHARE`] of the range, in seconds.
    time: f64,
}

/// The warning that steps were too long, from the traces of a run and of the same run with the shorter step of the doubt;
/// `None` if they agree.
pub(super) fn step_warning(
    program: &Program,
    doubt: StepDoubt,
    step: f64,
    trace: &Trace,
    other: &Trace,
) -> Option<StepWarning> {
    let tolerance = SAME_SAMPLE * trace.time.last()? / trace.len() as f64;
    let pairs = trace.time.iter().zip(&other.time);
    let common = pairs.take_while(|(one, other)| (*one - *other).abs() <= tolerance).count();
    let tracks = trace.tracks.iter().zip(&other.tracks).filter(|(track, _)| track.derivative.is_none());
    let with_extremes = matches!(doubt, StepDoubt::Fast { .. });
    let times = &trace.time[..common];
    let differences = tracks.filter_map(|(track, other)| difference(times, track, other, with_extremes));
    let worst = differences.max_by(|a, b| a.share.total_cmp(&b.share));
    let worst = worst.or_else(|| false_overload(trace, other))?;
    let by_error = step * (RECOMMENDED_SHARE / worst.share).powf(1.0 / ERROR_ORDER);
    let name = |element: usize| program.name(element).to_owned();
    let (cause, recommended) = match doubt {
        StepDoubt::Inaccurate | StepDoubt::Interrupted => (StepCause::Inaccurate, by_error.min(0.5 * step)),
        StepDoubt::Fast { element, recommended } => (StepCause::Fast(name(element)), recommended),
        StepDoubt::Unstable { element, recommended, .. } => (StepCause::Unstable(name(element)), recommended),
    };
    Some(StepWarning {
        signal: worst.name.to_owned(),
        error: worst.largest,
        unit: worst.unit.to_owned(),
        time: worst.time,
        cause,
        step,
        compared_step: doubt.compared_step(step),
        recommended: rounded_down(recommended),
    })
}

/// The difference of a signal over the samples at these times; `None` if it is a small share of the range. An oscillation
/// may have the same value at all samples, so its extremes count too if `with_extremes`.
fn difference<'t>(
    times: &[f64],
    track: &'t Track,
    other: &Track,
    with_extremes: bool,
) -> Option<Difference<'t>> {
    let pairs = track.values().zip(other.values()).zip(times);
    let mut points: Vec<(f64, [f64; 2])> = pairs.map(|((one, other), time)| (*time, [one, other])).collect();
    if with_extremes {
        points.extend(track.extremes.iter().zip(&other.extremes).flat_map(|(one, other)| {
            [(one.least, other.least), (one.most, other.most)].map(|(one, other)| {
                (other.time, [one.volts, other.volts].map(|volts| volts * track.per_volt))
            })
        }));
    }
    let values = || points.iter().flat_map(|(_, values)| values).copied();
    let range = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
    let range = range.max(LEAST_RANGE * track.per_volt.abs());
    let gap = |[one, other]: [f64; 2]| (one - other).abs();
    let largest = points.iter().map(|(_, values)| gap(*values)).fold(0.0, f64::max);
    let (time, _) = points.iter().find(|(_, values)| gap(*values) > LARGEST_SHARE * range)?;
    Some(Difference { name: &track.name, unit: &track.unit, largest, share: largest / range, time: *time })
}

/// The first overload of a run, with its time in seconds summed over all repetitions.
pub(super) fn first_overload(trace: &Trace) -> Option<(f64, &Overload)> {
    let mut begin = 0.0;
    for repetition in &trace.repetitions {
        if let Some(overload) = repetition.overloads.first() {
            return Some((begin + overload.time, overload));
        }
        begin += repetition.end;
    }
    None
}

/// The first overload of a run, if another run has passed its time, and the amplifier has stayed clearly below 100 V there.
/// The last track of the other run is the output of the amplifier.
fn false_overload<'t>(trace: &'t Trace, other: &Trace) -> Option<Difference<'t>> {
    let (time, first) = first_overload(trace)?;
    let reached: f64 = other.repetitions.iter().map(|repetition| repetition.end).sum();
    let extremes = other.tracks.last()?.extremes.iter();
    let peak = extremes.flat_map(|extremes| [extremes.least.volts.abs(), extremes.most.volts.abs()]);
    let largest = REFERENCE - peak.fold(0.0, f64::max);
    let is_overloaded = other.overloads().any(|overload| overload.element == first.element);
    (reached >= time && largest > SLIGHT_EXCESS && !is_overloaded).then_some(Difference {
        name: &first.element,
        unit: "V",
        largest,
        share: largest / REFERENCE,
        time: first.time,
    })
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a number.
fn rounded_down(value: f64) -> f64 {
    let decade = libm::floor(libm::log10(value));
    let power = libm::exp10(decade);
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|round| *round <= value).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_rounded_to_1_2_and_5() {
        for (value, expected) in [(0.0031, 0.002), (0.0056, 0.005), (1.0, 1.0), (0.99, 0.5), (1.9e-7, 1e-7)] {
            let found = rounded_down(value);
            assert!((found / expected - 1.0).abs() < 1e-12, "{value}: {found}");
        }
    }
}
