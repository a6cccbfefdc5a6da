//! Amplitude and frequency of a sustained oscillation of any shape.

use super::ringing::vertex;
use super::{NOT_A_SIGNAL, is_signal};
use patchcord_core::document::plural;

/// Amplitude and frequency of a sustained oscillation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// Half the difference of largest and smallest value, in the unit of the signal.
    pub amplitude: f64,
    /// Number of whole cycles divided by their duration, in Hz.
    pub frequency: f64,
    /// The number of whole cycles.
    pub cycles: usize,
}

/// Why the oscillation cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OscillationError {
    /// Times and values do not form a signal.
    #[error("{NOT_A_SIGNAL}")]
    NotASignal,
    /// The signal is constant, except for rounding errors.
    #[error("no oscillation: apart from rounding, the signal is constant")]
    Constant,
    /// The signal has too few whole cycles. The field is their number.
    #[error("no oscillation: {} was found, at least {MIN_CYCLES} are needed", cycles_text(*.0))]
    TooFewCycles(usize),
    /// The cycles have too few samples. The field is the mean number per cycle.
    #[error("{0:.1} samples per cycle, at least {MIN_SAMPLES} are needed")]
    TooCoarse(f64),
}

/// A number of cycles for messages: "no whole cycle" or "only 1 whole cycle".
fn cycles_text(cycles: usize) -> String {
    if cycles == 0 { "no whole cycle".to_owned() } else { format!("only {}", plural(cycles, "whole cycle")) }
}

/// The fewest whole cycles that count as an oscillation.
const MIN_CYCLES: usize = 2;
/// The fewest samples per cycle that show its shape.
const MIN_SAMPLES: f64 = 8.0;
/// A cycle passes the middle by at least this fraction of the whole swing on both sides; less is ripple.
const BAND: f64 = 0.1;
/// A swing below this fraction of the largest absolute value is a rounding error.
const NEGLIGIBLE_SWING: f64 = 1e-9;

/// Reads amplitude and frequency off a signal. Cycles are counted where the signal rises through the middle between its
/// smallest and largest value.
///
/// The signal must be steady: drift and decay increase the amplitude. Extremes are refined by the parabola through
/// three samples, or at a corner by the straight lines on both sides of it. `time` is in seconds and strictly
/// increasing.
///
/// # Errors
/// If the slices do not form a signal, or the signal is constant, or it has fewer than two whole cycles or fewer than
/// eight samples per cycle.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{OscillationError, oscillation};
///
/// let time: Vec<f64> = (0..2000).map(|index| 1e-3 * f64::from(index)).collect();
/// let values: Vec<f64> = time.iter().map(|t| 3.0 + 2.0 * (std::f64::consts::TAU * 7.0 * t).sin()).collect();
///
/// let read = oscillation(&time, &values)?;
/// assert!((read.amplitude - 2.0).abs() < 1e-3);
/// assert!((read.frequency - 7.0).abs() < 1e-2);
/// assert_eq!(oscillation(&time, &time), Err(OscillationError::TooFewCycles(0)));
/// # Ok::<(), OscillationError>(())
/// ```
pub fn oscillation(time: &[f64], values: &[f64]) -> Result<Oscillation, OscillationError> {
    oscillation_within(time, values, [f64::NEG_INFINITY, f64::INFINITY])
}

/// Like [`oscillation`], for a signal whose range is known: a corner is not extrapolated beyond it.
pub(super) fn oscillation_within(
    time: &[f64],
    values: &[f64],
    [least, most]: [f64; 2],
) -> Result<Oscillation, OscillationError> {
    if values.is_empty() || !is_signal(time, values) {
        return Err(OscillationError::NotASignal);
    }
    let (low, high) = (extreme(time, values, -1.0, least), extreme(time, values, 1.0, most));
    if high - low <= NEGLIGIBLE_SWING * low.abs().max(high.abs()) {
        return Err(OscillationError::Constant);
    }
    let rises = rises(time, values, (low, high));
    let cycles = rises.len().saturating_sub(1);
    if cycles < MIN_CYCLES {
        return Err(OscillationError::TooFewCycles(cycles));
    }
    let (begin, end) = (rises[0], rises[cycles]);
    let samples = time.iter().filter(|instant| (begin..end).contains(*instant)).count() as f64;
    if samples < MIN_SAMPLES * cycles as f64 {
        return Err(OscillationError::TooCoarse(samples / cycles as f64));
    }
    Ok(Oscillation { amplitude: 0.5 * (high - low), frequency: cycles as f64 / (end - begin), cycles })
}

/// The largest value (sign 1) or the smallest (sign -1), refined between samples. A corner is limited to `limit`.
pub(super) fn extreme(time: &[f64], values: &[f64], sign: f64, limit: f64) -> f64 {
    let mut best = 0;
    for (index, value) in values.iter().enumerate() {
        if sign * (value - values[best]) > 0.0 {
            best = index;
        }
    }
    let is_inside = best > 0 && best + 1 < values.len();
    if !is_inside || values[best - 1] == values[best] || values[best] == values[best + 1] {
        return values[best];
    }
    match corner(time, values, best) {
        Some(corner) => sign * (sign * values[best]).max((sign * corner).min(sign * limit)),
        None => vertex(&time[best - 1..=best + 1], &values[best - 1..=best + 1]).value,
    }
}

/// The value where the straight lines on both sides of an extreme meet; None if the extreme is round.
fn corner(time: &[f64], values: &[f64], top: usize) -> Option<f64> {
    if top < 2 || top + 2 >= values.len() {
        return None;
    }
    let slope = |from: usize| (values[from + 1] - values[from]) / (time[from + 1] - time[from]);
    let bend = |at: usize| ((slope(at) - slope(at - 1)) / (time[at + 1] - time[at - 1])).abs();
    let [before, after] = [bend(top - 1), bend(top + 1)];
    if before.min(after) > ROUND_BEND * bend(top) {
        return None;
    }
    // The extreme sample belongs to the side that is straighter with it.
    let (left, right) = if before < after { (top - 1, top + 1) } else { (top - 2, top) };
    let (up, down) = (slope(left), slope(right));
    let reach = time[right] - time[left + 1];
    let beyond = (values[right] - values[left + 1] - down * reach) / (up - down);
    (up * down < 0.0).then_some(values[left + 1] + up * beyond)
}

/// An extreme is round if the bend at both neighbouring samples exceeds this fraction of its own bend. A sine of eight
/// samples per period has 0.41.
const ROUND_BEND: f64 = 0.25;

/// The times at which the signal rises through the middle, coming from below a band about it and continuing to above.
fn rises(time: &[f64], values: &[f64], (low, high): (f64, f64)) -> Vec<f64> {
    let (middle, band) = (0.5 * (low + high), BAND * (high - low));
    let (mut came_from_below, mut crossed, mut found) = (false, None, Vec::new());
    for index in 0..values.len() {
        if values[index] < middle - band {
            (came_from_below, crossed) = (true, None);
        }
        if came_from_below && index > 0 && values[index - 1] < middle && values[index] >= middle {
            let share = (middle - values[index - 1]) / (values[index] - values[index - 1]);
            crossed = Some(time[index - 1] + share * (time[index] - time[index - 1]));
        }
        if came_from_below && values[index] > middle + band {
            found.extend(crossed);
            came_from_below = false;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::instruments::sampled;

    #[test]
    fn a_sine_gives_its_amplitude_and_frequency() {
        for (frequency, phase) in [(7.0, 0.3), (51.9, -2.0), (0.8, 1.0)] {
            let (time, values) = sampled(10_000, 1e-3, |t| 3.0 + 2.0 * (TAU * frequency * t + phase).sin());
            let read = oscillation(&time, &values).unwrap();
            assert!((read.amplitude - 2.0).abs() < 1e-4, "{read:?}");
            assert!((read.frequency / frequency - 1.0).abs() < 1e-4, "{read:?}");
        }
    }

    /// A relay thermostat that heats towards 1 and cools towards -3, with corners at 0.2 and 0.1.
    fn thermostat(time: f64) -> f64 {
        let (rise, fall) = ((0.9f64 / 0.8).ln(), (3.2f64 / 3.1).ln());
        let phase = time.rem_euclid(rise + fall);
        if phase < rise { 1.0 - 0.9 * (-phase).exp() } else { 3.2 * (rise - phase).exp() - 3.0 }
    }

    #[test]
    fn corners_are_reached_but_not_exceeded() {
        for spacing in [0.003, 0.007, 0.011] {
            let (time, values) = sampled(2000, spacing, |t| thermostat(t + 0.05));
            let read = oscillation(&time, &values).unwrap();
            assert!((read.amplitude / 0.05 - 1.0).abs() < 2e-3, "{spacing}: {read:?}");
            let known = oscillation_within(&time, &values, [0.1, 0.2]).unwrap();
            assert!((-1e-3..=1e-15).contains(&(known.amplitude / 0.05 - 1.0)), "{spacing}: {known:?}");
        }
    }

    #[test]
    fn ripple_during_slips_is_not_counted() {
        let slips = |t: f64| (t * 5.0).fract().powi(4) + 0.05 * (TAU * 60.0 * t).sin();
        let (time, values) = sampled(4001, 1e-3, slips);
        let read = oscillation(&time, &values).unwrap();
        assert_eq!(read.cycles, 19, "{read:?}");
        assert!((read.frequency - 5.0).abs() < 0.01, "{read:?}");
    }

    #[test]
    fn signals_without_oscillation_return_errors() {
        let read = |signal: &dyn Fn(f64) -> f64| {
            let (time, values) = sampled(1000, 1e-3, signal);
            oscillation(&time, &values)
        };
        assert_eq!(read(&|_| 2.0), Err(OscillationError::Constant));
        assert_eq!(read(&|t| t), Err(OscillationError::TooFewCycles(0)));
        assert_eq!(read(&|t| (TAU * t).sin()), Err(OscillationError::TooFewCycles(0)));
        assert_eq!(read(&|t| 1.0 + 1e-12 * (50.0 * t).sin()), Err(OscillationError::Constant));
        assert!(matches!(read(&|t| (TAU * 180.0 * t).sin()), Err(OscillationError::TooCoarse(_))));
        let texts = [0, 1].map(|cycles| OscillationError::TooFewCycles(cycles).to_string());
        assert_eq!(texts[0], "no oscillation: no whole cycle was found, at least 2 are needed");
        assert_eq!(texts[1], "no oscillation: only 1 whole cycle was found, at least 2 are needed");
        assert_eq!(oscillation(&[], &[]), Err(OscillationError::NotASignal));
        assert_eq!(oscillation(&[0.0, 1.0], &[0.0, f64::NAN]), Err(OscillationError::NotASignal));
    }
}
