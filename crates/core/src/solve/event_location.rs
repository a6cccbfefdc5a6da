//! Location of the first event within a tried step.
//!
//! An event has a value that passes 0 when the event comes. The search keeps a bracket of two shares of the step: at
//! the lower one the event has not come, at the upper one it has. Each try takes the zero of the polynomial through up
//! to four known values, with bisection as a safeguard. A change of mode is located just past its zero, a kink within a
//! tolerance around it. The located event is the first one, because each try may show an earlier event, which is then
//! located instead.

use std::mem;

use crate::divided::divide;

/// An event is located when its instant is known to this share of the step.
const SHARE_TOLERANCE: f64 = 1e-13;
/// An event is also located at this share of the step if the values of the bracket differ by rounding alone.
const SHARE_TOLERANCE_IN_ROUNDING: f64 = 1e-11;
/// Values that differ by less than this, in volts, differ by rounding: one bit of 100 V.
const VALUE_ROUNDING: f64 = 1.5e-14;
/// This number of tries follow the polynomial. After them every third try bisects, and both ends approach the event.
const POLYNOMIAL_TRIES: usize = 10;
/// The first try beyond the expected zero is this share of a step past it: one bit of the end of the step.
const JUST_PAST: f64 = 1e-16;
/// Each further try that falls on the same side as the one before goes this many times further beyond the zero.
const FURTHER: f64 = 8.0;
/// The zero of a polynomial is found by at most this many steps of Newton's method.
const MAX_NEWTON_STEPS: usize = 60;
/// A search takes at most this many tries. They make the bracket smaller than the rounding of the step.
const MAX_TRIES: usize = 150;

/// A step that can be tried at any length, with the events on the way and their values in volts.
pub(super) trait EventFunction {
    type Event: Copy + PartialEq;

    /// Tries a step of this length in seconds. All other methods but `present_value` then refer to its end.
    fn evaluate(&mut self, length: f64);

    /// An event on the way to the end of the tried step; `None` if there is none.
    fn event(&self) -> Option<Self::Event>;

    /// Whether the stages of the tried step show or suggest an event that its end does not show.
    fn has_hint(&self) -> bool;

    /// The share of the tried step at which that event may be.
    fn hint_share(&self) -> f64;

    /// The value of an event at the present: negative before the event.
    fn present_value(&self, event: Self::Event) -> f64;

    /// The value of an event at the end of the tried step: negative before the event.
    fn value(&self, event: Self::Event) -> f64;

    /// A step may end on either side of an event if the value is smaller than this, in volts; 0 if it must end past the
    /// event.
    fn tolerance(&self, event: Self::Event) -> f64;
}

/// Locates the first event of the step tried last: the share of the step (1 without an event), and the event. The step
/// is left tried up to that share. Events that come and go are found if a stage hints at them. `near` is a share near
/// which the event is expected, if that is known.
pub(super) fn first_event<F: EventFunction>(
    function: &mut F,
    length: f64,
    near: Option<f64>,
) -> (f64, Option<F::Event>) {
    let (mut share, mut first) = (1.0, function.event());
    if let Some(event) = &mut first {
        (share, *event) = locate(function, length, *event, near);
    }
    for _ in 0..MAX_TRIES {
        // An event that comes and goes within the tolerance of a share is at that share.
        if !function.has_hint() || share <= SHARE_TOLERANCE {
            break;
        }
        let earlier = share * function.hint_share();
        function.evaluate(earlier * length);
        let Some(event) = function.event() else {
            function.evaluate(share * length);
            break;
        };
        let (place, event) = locate(function, earlier * length, event, None);
        (share, first) = (earlier * place, Some(event));
    }
    (share, first)
}

/// Locates the first event of the step tried last, of which one event is known: by the zero of the polynomial through
/// its values, with bisection as a safeguard.
fn locate<F: EventFunction>(
    function: &mut F,
    length: f64,
    mut event: F::Event,
    mut near: Option<f64>,
) -> (f64, F::Event) {
    let end = Sample { share: 1.0, value: function.value(event) };
    let mut bracket = Bracket::new(function.present_value(event), end);
    for tries in 0..MAX_TRIES {
        if bracket.is_located() {
            break;
        }
        let tolerance = function.tolerance(event);
        let place = near.take().unwrap_or_else(|| bracket.next(tries, tolerance == 0.0));
        let share = bracket.inside(place, tries);
        function.evaluate(share * length);
        let met = function.event();
        if let Some(first) = met.filter(|first| *first != event) {
            event = first;
            let end = Sample { share, value: function.value(event) };
            bracket = Bracket::new(function.present_value(event), end);
            continue;
        }
        let value = function.value(event);
        if value.abs() < tolerance {
            return (share, event);
        }
        bracket.narrow(Sample { share, value }, met.is_some());
    }
    if !bracket.is_at_upper_end() {
        function.evaluate(bracket.high.share * length);
    }
    (bracket.high.share, event)
}

/// The value of an event at a share of the step.
#[derive(Debug, Clone, Copy)]
struct Sample {
    share: f64,
    value: f64,
}

/// The shares of a step between which an event comes.
struct Bracket {
    /// The end at which the event has not come.
    low: Sample,
    /// The end at which it has come.
    high: Sample,
    /// The ends before these, the latest first.
    former: [Sample; 2],
    /// Number of known samples: the two ends and up to two former ends.
    known: usize,
    /// The next try is this far beyond the zero, towards the end that was not moved last.
    beyond: f64,
}

impl Bracket {
    /// The bracket from the present to a share at which the event has come.
    fn new(present_value: f64, high: Sample) -> Self {
        let low = Sample { share: 0.0, value: present_value };
        Bracket { low, high, former: [low, high], known: 2, beyond: 0.0 }
    }

    fn width(&self) -> f64 {
        self.high.share - self.low.share
    }

    /// Whether the instant of the event is known well enough.
    fn is_located(&self) -> bool {
        let rise = self.high.value - self.low.value;
        self.width() <= SHARE_TOLERANCE
            || (self.width() <= SHARE_TOLERANCE_IN_ROUNDING && self.passes_zero() && rise <= VALUE_ROUNDING)
    }

    /// Whether the value rises through 0 between the ends. If there are several events, the value of the first need
    /// not.
    fn passes_zero(&self) -> bool {
        self.low.value <= 0.0 && self.high.value >= 0.0 && self.low.value < self.high.value
    }

    /// Whether the last try was at the upper end.
    fn is_at_upper_end(&self) -> bool {
        self.beyond <= 0.0
    }

    /// The share to try next: the zero of the polynomial, or beyond it if `goes_beyond`, or the middle.
    fn next(&self, tries: usize, goes_beyond: bool) -> f64 {
        if !self.passes_zero() || (tries >= POLYNOMIAL_TRIES && tries.is_multiple_of(3)) {
            return self.low.share + 0.5 * self.width();
        }
        self.zero() + if goes_beyond { self.beyond } else { 0.0 }
    }

    /// A share, or the nearest share strictly between the ends. After many tries it keeps some distance from both.
    fn inside(&self, place: f64, tries: usize) -> f64 {
        let width = self.width();
        let edge =
            if tries >= POLYNOMIAL_TRIES { 0.5 * SHARE_TOLERANCE.max(width * 1e-3) } else { JUST_PAST };
        let edge = edge.min(0.25 * width);
        place.clamp(self.low.share + edge, self.high.share - edge)
    }

    /// The zero of the polynomial through the known samples, by Newton's method. Steps that leave the ends bisect.
    fn zero(&self) -> f64 {
        let samples = [self.low, self.high, self.former[0], self.former[1]];
        let polynomial = Polynomial::through(samples, self.known);
        let (mut low, mut high) = (self.low.share, self.high.share);
        let mut share = low - self.low.value * self.width() / (self.high.value - self.low.value);
        for _ in 0..MAX_NEWTON_STEPS {
            let (value, slope) = polynomial.at(share);
            let back = value / slope;
            if back.abs() < 0.1 * SHARE_TOLERANCE {
                break;
            }
            *(if value < 0.0 { &mut low } else { &mut high }) = share;
            let next = share - back;
            share = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        share
    }

    /// Moves one end to a sample: the upper end if the event has come there, else the lower end.
    fn narrow(&mut self, to: Sample, has_come: bool) {
        let end = if has_come { &mut self.high } else { &mut self.low };
        self.former = [mem::replace(end, to), self.former[0]];
        self.known = (self.known + 1).min(4);
        let back = if has_come { -0.5 * SHARE_TOLERANCE } else { JUST_PAST };
        self.beyond = if self.beyond * back > 0.0 { FURTHER * self.beyond } else { back };
    }
}

/// The polynomial through samples. The end of a Runge-Kutta step is a polynomial in its length if no kink is on the
/// way.
struct Polynomial {
    shares: [f64; 4],
    /// Divided differences of the values.
    differences: [f64; 4],
    known: usize,
}

impl Polynomial {
    /// The polynomial through the first `known` samples.
    fn through(samples: [Sample; 4], known: usize) -> Self {
        let shares = samples.map(|sample| sample.share);
        let mut differences = samples.map(|sample| sample.value);
        divide(&shares, &mut differences[..known]);
        Polynomial { shares, differences, known }
    }

    /// The value and the slope at a share.
    fn at(&self, share: f64) -> (f64, f64) {
        let first = (self.differences[self.known - 1], 0.0);
        (0..self.known - 1).rev().fold(first, |(value, slope), place| {
            let from = share - self.shares[place];
            (value * from + self.differences[place], slope * from + value)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A voltage over the length of a step, and an event while it is above 0.
    struct Voltage<F> {
        value: F,
        length: f64,
        tries: usize,
        hint: Option<f64>,
    }

    impl<F: Fn(f64) -> f64> EventFunction for Voltage<F> {
        type Event = ();

        fn evaluate(&mut self, length: f64) {
            self.length = length;
            self.tries += 1;
        }

        fn event(&self) -> Option<()> {
            (self.value(()) > 0.0).then_some(())
        }

        fn has_hint(&self) -> bool {
            self.hint.is_some()
        }

        fn hint_share(&self) -> f64 {
            self.hint.unwrap_or(1.0)
        }

        fn present_value(&self, (): ()) -> f64 {
            (self.value)(0.0)
        }

        fn value(&self, (): ()) -> f64 {
            (self.value)(self.length)
        }

        fn tolerance(&self, (): ()) -> f64 {
            0.0
        }
    }

    /// The share at which a voltage passes 0 in a step of 1 s, and the number of tries.
    fn first(value: impl Fn(f64) -> f64, hint: Option<f64>) -> (f64, usize) {
        let mut voltage = Voltage { value, length: 1.0, tries: 0, hint };
        let (share, met) = first_event(&mut voltage, 1.0, None);
        assert!(met.is_some() && voltage.length == share && (voltage.value)(share) > 0.0, "{share}");
        (share, voltage.tries)
    }

    #[test]
    fn zeros_are_located_in_a_few_tries() {
        let fall = (0.3_f64).exp();
        type Case<'a> = (&'a dyn Fn(f64) -> f64, f64, usize);
        let cases: [Case<'_>; 6] = [
            (&|t| t - 0.7, 0.7, 3),
            // From rest, as when friction lets go.
            (&|t| 0.6 * t * t - 5e-4, (5e-4_f64 / 0.6).sqrt(), 7),
            (&|t| 40.0 * t * t * t - 1e-3, (1e-3_f64 / 40.0).cbrt(), 10),
            (&|t| fall - (0.3 + 2.0 * (0.15 - t)).exp(), 0.15, 8),
            // A corner on the way.
            (&|t| t.max(30.0 * t - 20.0) - 0.9, 20.9 / 30.0, 18),
            (&|t| 1e-12 * t - 3e-13, 0.3, 6),
        ];
        for (place, (value, expected, most)) in cases.into_iter().enumerate() {
            let (share, tries) = first(value, None);
            assert!(
                (share - expected).abs() <= 2.0 * SHARE_TOLERANCE,
                "case {place}: {share} for {expected}"
            );
            assert!(tries <= most, "case {place}: {tries} tries");
        }
    }

    /// A voltage that is rounded to a bit of 100 V.
    #[test]
    fn the_search_ends_at_the_rounding_of_the_voltage() {
        let rounded = |t: f64| (1e-3 * (t - 0.4) + 50.0) - 50.0;
        let (share, tries) = first(rounded, None);
        assert!((share - 0.4).abs() <= SHARE_TOLERANCE_IN_ROUNDING && tries <= 10, "{share}, {tries} tries");
    }

    /// An event that is due at once, while every try hints at an earlier one.
    #[test]
    fn earlier_events_are_searched_to_the_tolerance_only() {
        let (share, tries) = first(|_| 1e-8, Some(0.5));
        assert!(share <= SHARE_TOLERANCE && tries <= 2 * MAX_TRIES, "{share}, {tries} tries");
    }
}
