//! Location of the first event within a tried step.
//!
//! An event has a value that rises through 0 when the event occurs. The search keeps a bracket of two shares of the
//! step: at the lower one the event has not occurred, at the upper one it has. Each try takes the zero of the
//! polynomial through up to four known values, with bisection as a safeguard. A change of mode is located just past its
//! zero, a kink within a tolerance around it. If a try shows an earlier event, the search continues with that one, so
//! the located event is the first.
//!
//! The solver and the kernels use the same search, through the trait [`EventFunction`].

use std::mem;

use crate::divided_differences::newton_coefficients;

/// Width of the bracket at which an event is located, as a share of the step.
const SHARE_TOLERANCE: f64 = 1e-13;
/// Width of the bracket, as a share of the step, at which an event is also located if the values at both ends differ by
/// rounding only.
const SHARE_TOLERANCE_IN_ROUNDING: f64 = 1e-11;
/// Difference of two values, in volts, that rounding explains: one bit of 100 V is 1.4e-14 V.
const VALUE_ROUNDING: f64 = 1.5e-14;
/// Number of tries that follow the polynomial. After them every third try bisects, and both ends approach the event.
const POLYNOMIAL_TRIES: usize = 10;
/// Distance of the first try past the expected zero, as a share of the step: about one bit of the share 1.
const MIN_OVERSHOOT: f64 = 1e-16;
/// Factor by which that distance grows with each further try that falls on the same side as the try before.
const OVERSHOOT_GROWTH: f64 = 8.0;
/// Largest number of steps of Newton's method for the zero of a polynomial.
const MAX_NEWTON_STEPS: usize = 60;
/// Largest number of tries of a search. Every third try bisects, so the bracket is then as small as the rounding of the
/// step.
const MAX_TRIES: usize = 150;

/// A step that can be tried at any length, with the events that it would cross and their values in volts.
pub(super) trait EventFunction {
    /// Identifies an event, such as the guard of a mode or the index of a kink.
    type Event: Copy + PartialEq;

    /// Tries a step of this length in problem seconds. All other methods except `present_value` then refer to its end.
    fn evaluate(&mut self, length: f64);

    /// An event that has occurred at the end of the tried step; `None` if there is none.
    fn event(&self) -> Option<Self::Event>;

    /// Whether the stages of the tried step show or suggest an event that its end does not show.
    fn has_hint(&self) -> bool;

    /// The share (0 ... 1) of the tried step at which that event may be.
    fn hint_share(&self) -> f64;

    /// The value of an event at the present, in volts: negative before the event.
    fn present_value(&self, event: Self::Event) -> f64;

    /// The value of an event at the end of the tried step, in volts: negative before the event.
    fn value(&self, event: Self::Event) -> f64;

    /// The value without sign, in volts, up to which a step may end on either side of an event; 0 if it must end past
    /// the event.
    fn tolerance(&self, event: Self::Event) -> f64;
}

/// Locates the first event of the step tried last. Returns the share of the step (1 without an event) and the event;
/// the step up to that share is the one tried last. Events that come and go are found if a stage hints at them.
/// `expected_share` is a share near which the event is expected, if that is known. `length` is in problem seconds.
pub(super) fn first_event<F: EventFunction>(
    function: &mut F,
    length: f64,
    expected_share: Option<f64>,
) -> (f64, Option<F::Event>) {
    let (mut share, mut first) = (1.0, function.event());
    if let Some(event) = &mut first {
        (share, *event) = locate(function, length, *event, expected_share);
    }
    for _ in 0..MAX_TRIES {
        // Below the tolerance, no earlier event is searched.
        if !function.has_hint() || share <= SHARE_TOLERANCE {
            break;
        }
        let earlier = share * function.hint_share();
        function.evaluate(earlier * length);
        let Some(event) = function.event() else {
            function.evaluate(share * length);
            break;
        };
        let (fraction, event) = locate(function, earlier * length, event, None);
        (share, first) = (earlier * fraction, Some(event));
    }
    (share, first)
}

/// Locates the first event of the step tried last, which has an event at its end. Each pass takes the zero of the
/// polynomial through the known values, or bisects. An earlier event that a try shows begins a new bracket.
fn locate<F: EventFunction>(
    function: &mut F,
    length: f64,
    mut event: F::Event,
    mut expected_share: Option<f64>,
) -> (f64, F::Event) {
    let end = Sample { share: 1.0, value: function.value(event) };
    let mut bracket = Bracket::new(value_before(function, event), end);
    for tries in 0..MAX_TRIES {
        if bracket.is_located() {
            break;
        }
        let tolerance = function.tolerance(event);
        let candidate = expected_share.take().unwrap_or_else(|| bracket.next(tries, tolerance == 0.0));
        let share = bracket.clamp_inside(candidate, tries);
        function.evaluate(share * length);
        let reached = function.event();
        if let Some(first) = reached.filter(|first| *first != event) {
            event = first;
            let end = Sample { share, value: function.value(event) };
            bracket = Bracket::new(value_before(function, event), end);
            continue;
        }
        let value = function.value(event);
        if value.abs() < tolerance {
            return (share, event);
        }
        bracket.narrow(Sample { share, value }, reached.is_some());
    }
    if !bracket.is_at_upper_end() {
        function.evaluate(bracket.high.share * length);
    }
    (bracket.high.share, event)
}

/// The value of an event at the present. If the step begins within the tolerance of the event, it is positive: then there
/// is no sign change between the ends, and the search bisects, because the zero at the beginning is not the event.
fn value_before<F: EventFunction>(function: &F, event: F::Event) -> f64 {
    let (value, tolerance) = (function.present_value(event), function.tolerance(event));
    if tolerance > 0.0 && value >= -tolerance { value.max(f64::MIN_POSITIVE) } else { value }
}

/// The value of an event at a share of the step.
#[derive(Debug, Clone, Copy)]
struct Sample {
    /// Share of the step, 0 ... 1.
    share: f64,
    /// Value in volts; negative before the event.
    value: f64,
}

/// The shares of a step between which an event occurs.
struct Bracket {
    /// The end at which the event has not occurred.
    low: Sample,
    /// The end at which it has occurred.
    high: Sample,
    /// The ends that were replaced last, the latest first.
    previous_ends: [Sample; 2],
    /// Number of known samples (2 ... 4): the two ends and up to two previous ends.
    sample_count: usize,
    /// Distance of the next try past the zero, as a share of the step, towards the end that was not moved last:
    /// positive after the lower end moved, negative after the upper end moved.
    overshoot: f64,
}

impl Bracket {
    /// The bracket from the present to a share at which the event has occurred.
    fn new(present_value: f64, high: Sample) -> Self {
        let low = Sample { share: 0.0, value: present_value };
        Bracket { low, high, previous_ends: [low, high], sample_count: 2, overshoot: 0.0 }
    }

    /// The distance between the ends, as a share of the step.
    fn width(&self) -> f64 {
        self.high.share - self.low.share
    }

    /// Whether the bracket is narrow enough to locate the event.
    fn is_located(&self) -> bool {
        let value_range = self.high.value - self.low.value;
        self.width() <= SHARE_TOLERANCE
            || (self.width() <= SHARE_TOLERANCE_IN_ROUNDING
                && self.has_sign_change()
                && value_range <= VALUE_ROUNDING)
    }

    /// Whether the value rises through 0 between the ends. If several events are near each other, the value of this one
    /// may not.
    fn has_sign_change(&self) -> bool {
        self.low.value <= 0.0 && self.high.value >= 0.0 && self.low.value < self.high.value
    }

    /// Whether the last try was at the upper end.
    fn is_at_upper_end(&self) -> bool {
        self.overshoot <= 0.0
    }

    /// The share to try next: the zero of the polynomial, or a share past it if the step must end past the event, or
    /// the middle. `tries` is the number of tries before.
    fn next(&self, tries: usize, must_pass: bool) -> f64 {
        if !self.has_sign_change() || (tries >= POLYNOMIAL_TRIES && tries.is_multiple_of(3)) {
            return self.low.share + 0.5 * self.width();
        }
        self.zero() + if must_pass { self.overshoot } else { 0.0 }
    }

    /// A share, or the nearest share strictly between the ends. After many tries it keeps a larger distance from both.
    fn clamp_inside(&self, candidate: f64, tries: usize) -> f64 {
        let width = self.width();
        let margin =
            if tries >= POLYNOMIAL_TRIES { 0.5 * SHARE_TOLERANCE.max(width * 1e-3) } else { MIN_OVERSHOOT };
        let margin = margin.min(0.25 * width);
        candidate.clamp(self.low.share + margin, self.high.share - margin)
    }

    /// The zero of the polynomial through the known samples, by Newton's method from the secant. A Newton step that
    /// leaves the bracket is replaced by a bisection.
    fn zero(&self) -> f64 {
        let samples = [self.low, self.high, self.previous_ends[0], self.previous_ends[1]];
        let polynomial = Polynomial::through(samples, self.sample_count);
        let (mut low, mut high) = (self.low.share, self.high.share);
        let mut share = low - self.low.value * self.width() / (self.high.value - self.low.value);
        for _ in 0..MAX_NEWTON_STEPS {
            let (value, slope) = polynomial.evaluate(share);
            let newton_step = value / slope;
            if newton_step.abs() < 0.1 * SHARE_TOLERANCE {
                break;
            }
            *(if value < 0.0 { &mut low } else { &mut high }) = share;
            let next = share - newton_step;
            share = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        share
    }

    /// Moves one end to a sample: the upper end if the event has occurred there, else the lower end.
    fn narrow(&mut self, sample: Sample, is_past_event: bool) {
        let end = if is_past_event { &mut self.high } else { &mut self.low };
        self.previous_ends = [mem::replace(end, sample), self.previous_ends[0]];
        self.sample_count = (self.sample_count + 1).min(4);
        let first_overshoot = if is_past_event { -0.5 * SHARE_TOLERANCE } else { MIN_OVERSHOOT };
        self.overshoot = if self.overshoot * first_overshoot > 0.0 {
            OVERSHOOT_GROWTH * self.overshoot
        } else {
            first_overshoot
        };
    }
}

/// The polynomial through two to four samples in Newton's form. It predicts well, because the end of a Runge-Kutta step
/// is a polynomial in its length as long as the step crosses no kink.
struct Polynomial {
    /// The shares of the samples.
    shares: [f64; 4],
    /// Divided differences of the values; only the first `sample_count` are used.
    differences: [f64; 4],
    /// The number of samples.
    sample_count: usize,
}

impl Polynomial {
    /// The polynomial through the first `sample_count` samples.
    fn through(samples: [Sample; 4], sample_count: usize) -> Self {
        let shares = samples.map(|sample| sample.share);
        let mut differences = samples.map(|sample| sample.value);
        newton_coefficients(&shares, &mut differences[..sample_count]);
        Polynomial { shares, differences, sample_count }
    }

    /// The value and the slope at a share, by Horner's scheme.
    fn evaluate(&self, share: f64) -> (f64, f64) {
        let highest = (self.differences[self.sample_count - 1], 0.0);
        (0..self.sample_count - 1).rev().fold(highest, |(value, slope), index| {
            let offset = share - self.shares[index];
            (value * offset + self.differences[index], slope * offset + value)
        })
    }
}

#[cfg(test)]
mod tests;
