//! Unit tests of `event_location`.

use super::*;

/// A voltage over the length of a step, and an event while it is above 0.
struct Voltage<F> {
    /// The voltage at the end of a step of a length.
    value: F,
    /// The length tried last, in seconds.
    length: f64,
    /// The number of evaluations.
    tries: usize,
    /// The share at which every try hints at an earlier event.
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
fn locate_zero(value: impl Fn(f64) -> f64, hint: Option<f64>) -> (f64, usize) {
    let mut voltage = Voltage { value, length: 1.0, tries: 0, hint };
    let (share, reached) = first_event(&mut voltage, 1.0, None);
    assert!(reached.is_some() && voltage.length == share && (voltage.value)(share) > 0.0, "{share}");
    (share, voltage.tries)
}

#[test]
fn a_zero_is_located_in_a_few_tries() {
    let threshold = (0.3_f64).exp();
    type Case<'a> = (&'a dyn Fn(f64) -> f64, f64, usize);
    let cases: [Case<'_>; 6] = [
        (&|t| t - 0.7, 0.7, 3),
        // From rest, as when a stuck body begins to slide.
        (&|t| 0.6 * t * t - 5e-4, (5e-4_f64 / 0.6).sqrt(), 7),
        (&|t| 40.0 * t * t * t - 1e-3, (1e-3_f64 / 40.0).cbrt(), 10),
        (&|t| threshold - (0.3 + 2.0 * (0.15 - t)).exp(), 0.15, 8),
        // A corner within the step.
        (&|t| t.max(30.0 * t - 20.0) - 0.9, 20.9 / 30.0, 18),
        (&|t| 1e-12 * t - 3e-13, 0.3, 6),
    ];
    for (case, (value, expected, max_tries)) in cases.into_iter().enumerate() {
        let (share, tries) = locate_zero(value, None);
        assert!((share - expected).abs() <= 2.0 * SHARE_TOLERANCE, "case {case}: {share} for {expected}");
        assert!(tries <= max_tries, "case {case}: {tries} tries");
    }
}

/// The voltage is rounded to a bit of 100 V.
#[test]
fn the_search_ends_when_only_rounding_is_left() {
    let rounded = |t: f64| (1e-3 * (t - 0.4) + 50.0) - 50.0;
    let (share, tries) = locate_zero(rounded, None);
    assert!((share - 0.4).abs() <= SHARE_TOLERANCE_IN_ROUNDING && tries <= 10, "{share}, {tries} tries");
}

/// The event is due at once, while every try hints at an earlier one.
#[test]
fn no_earlier_event_is_searched_below_the_tolerance() {
    let (share, tries) = locate_zero(|_| 1e-8, Some(0.5));
    assert!(share <= SHARE_TOLERANCE && tries <= 2 * MAX_TRIES, "{share}, {tries} tries");
}
