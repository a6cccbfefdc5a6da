/// The scale of one edge of the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What is read on the axis, such as `v_i`.
    pub label: String,
    /// Its unit, such as `mm/s`; empty if it has none.
    pub unit: String,
    /// The value at the left or lower end.
    pub low: f64,
    /// The value at the right or upper end; may lie below `low`.
    pub high: f64,
    /// How many equal divisions the graticule has along this axis, 1 to 100.
    pub divisions: usize,
    /// Whether equal lengths are equal ratios; the ends then lie above 0.
    pub logarithmic: bool,
}

/// By how much of a division data may overshoot before a further one is
/// needed: sums of rounded time steps should not cost a division.
const SLACK: f64 = 1e-6;

/// Values beyond these are as good as infinite, or zero, for a drawing.
const LARGEST: f64 = 1e300;
const SMALLEST: f64 = 1e-290;

/// A spread below this part of the value is rounding, not signal.
const ROUNDING: f64 = 1e-9;

/// A gap to zero of at most this part of the spread is closed.
const NEAR: f64 = 0.25;

impl Axis {
    /// The most divisions an axis can be drawn with.
    pub const MOST_DIVISIONS: usize = 100;

    /// The usual number of divisions along the foot of the screen.
    pub const ACROSS: usize = 10;

    /// The usual number of divisions up the side of the screen.
    pub const UP: usize = 8;

    /// An axis of exactly `divisions` divisions (held to 2 to 100), each 1, 2
    /// or 5 times a power of ten, covering all finite `values` to within a
    /// millionth of a division. Zero lies on a division line, and on the screen
    /// if it is near the values. Values that do not spread get room around them.
    pub fn fit(
        label: impl Into<String>,
        unit: impl Into<String>,
        values: impl Iterator<Item = f64>,
        divisions: usize,
    ) -> Axis {
        let divisions = divisions.clamp(2, Axis::MOST_DIVISIONS);
        let span = Span::of(values);
        let (step, first) = span.whole_screen(divisions as f64);
        Axis {
            label: label.into(),
            unit: unit.into(),
            low: step.times(first),
            high: step.times(first + divisions as f64),
            divisions,
            logarithmic: false,
        }
    }

    /// Like [`Axis::fit`], but with as few of the at most `divisions` divisions
    /// as the values need, so that none at the ends is empty.
    pub fn snug(
        label: impl Into<String>,
        unit: impl Into<String>,
        values: impl Iterator<Item = f64>,
        divisions: usize,
    ) -> Axis {
        let most = divisions.clamp(2, Axis::MOST_DIVISIONS);
        let span = Span::of(values);
        let (step, _) = span.whole_screen(most as f64);
        let (first, last) = span.lines_around(step);
        Axis {
            label: label.into(),
            unit: unit.into(),
            low: step.times(first),
            high: step.times(last),
            divisions: (last - first) as usize,
            logarithmic: false,
        }
    }

    /// A logarithmic axis from one value above 0 to a larger one, with as many divisions as there are decades, at most
    /// [`Axis::MOST_DIVISIONS`].
    pub fn ratios(label: impl Into<String>, unit: impl Into<String>, low: f64, high: f64) -> Axis {
        let above_zero = |value: f64| if value.is_nan() { 1.0 } else { value.clamp(1.0 / LARGEST, LARGEST) };
        let low = above_zero(low);
        let high = Some(above_zero(high)).filter(|high| *high > low).unwrap_or(10.0 * low);
        let decades = (high.log10() - low.log10()).round();
        Axis {
            label: label.into(),
            unit: unit.into(),
            low,
            high,
            divisions: decades.clamp(1.0, Axis::MOST_DIVISIONS as f64) as usize,
            logarithmic: true,
        }
    }

    /// Whether every division of a logarithmic axis is a decade, from one power of ten to the next.
    pub(super) fn is_of_decades(&self) -> bool {
        let ends = [self.low.log10(), self.high.log10()];
        let is_whole = |number: f64| (number - number.round()).abs() < SLACK;
        ends.iter().all(|end| is_whole(*end)) && (ends[1] - ends[0]).round() == self.divisions as f64
    }

    /// So many times the powers of ten, as far as they lie between the ends of a logarithmic axis.
    pub(super) fn multiples(&self, times: std::ops::Range<u32>) -> impl Iterator<Item = f64> {
        let exponents = self.low.log10().floor() as i32..=self.high.log10().floor() as i32;
        let all = exponents.flat_map(move |exponent| {
            // Read as decimals, they are rounded once.
            times.clone().filter_map(move |times| format!("{times}e{exponent}").parse::<f64>().ok())
        });
        all.filter(|value| (SLACK..1.0 - SLACK).contains(&self.fraction(*value)))
    }

    /// Where a finite value lies: 0 at the low end, 1 at the high end.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        if self.logarithmic {
            let decades = |value: f64| value.max(f64::MIN_POSITIVE).log10() - self.low.log10();
            return decades(value) / decades(self.high);
        }
        // Halves keep differences of very large values finite.
        (value / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0)
    }

    /// The value at a division line, counted from the low end.
    pub(super) fn line(&self, index: usize) -> f64 {
        let part = index as f64 / self.divisions as f64;
        if self.logarithmic {
            return self.low * (self.high / self.low).powf(part);
        }
        self.low * (1.0 - part) + self.high * part
    }

    /// The division line at zero, if zero is on one.
    pub(super) fn zero_line(&self) -> Option<usize> {
        let line = self.lines_to_zero()?;
        (0.0..=self.divisions as f64).contains(&line).then_some(line as usize)
    }

    /// Where to begin when only every `stride`-th division line gets a number:
    /// such that zero, wherever it is, would be among the numbers.
    pub(super) fn anchor(&self, stride: usize) -> usize {
        let to_zero = self.lines_to_zero().unwrap_or(0.0);
        to_zero.rem_euclid(stride as f64) as usize
    }

    /// How many divisions above the low end zero is, if that is a whole number.
    fn lines_to_zero(&self) -> Option<f64> {
        if self.logarithmic {
            return None;
        }
        let position = self.fraction(0.0) * self.divisions as f64;
        ((position - position.round()).abs() < SLACK).then_some(position.round())
    }

    /// Whether the axis has a range and a number of divisions to draw.
    pub(super) fn is_drawable(&self) -> bool {
        (1..=Axis::MOST_DIVISIONS).contains(&self.divisions)
            && self.low.abs().max(self.high.abs()) <= f64::MAX
            && (!self.logarithmic || (self.low > 0.0 && self.high > self.low))
            && self.fraction(self.high) == 1.0
            && self.fraction(self.low) == 0.0
    }
}

/// The range that an axis has to cover; never empty.
struct Span {
    low: f64,
    high: f64,
}

impl Span {
    fn of(values: impl Iterator<Item = f64>) -> Span {
        let (low, high) = values
            .filter(|value| value.is_finite())
            .map(|value| value.clamp(-LARGEST, LARGEST))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        Span { low, high }.spread().with_near_zero()
    }

    /// Gives values that do not spread a range to be drawn in: down to zero,
    /// or one to either side of zero.
    fn spread(self) -> Span {
        let size = self.low.abs().max(self.high.abs());
        if self.low > self.high || size < SMALLEST {
            Span { low: -1.0, high: 1.0 }
        } else if self.high - self.low < ROUNDING * size {
            Span { low: self.low.min(0.0), high: self.high.max(0.0) }
        } else {
            self
        }
    }

    fn with_near_zero(self) -> Span {
        let reach = NEAR * (self.high - self.low);
        let low = if (0.0..=reach).contains(&self.low) { 0.0 } else { self.low };
        let high = if (-reach..=0.0).contains(&self.high) { 0.0 } else { self.high };
        Span { low, high }
    }

    /// The division lines just outside the range, counted from zero.
    fn lines_around(&self, step: Step) -> (f64, f64) {
        let unit = step.times(1.0);
        ((self.low / unit + SLACK).floor(), (self.high / unit - SLACK).ceil())
    }

    /// The finest step with which a screen of `divisions` covers the range, and
    /// the division line, counted from zero, at which the screen begins.
    fn whole_screen(&self, divisions: f64) -> (Step, f64) {
        let mut step = Step::below((self.high - self.low) / divisions);
        loop {
            let (below, above) = self.lines_around(step);
            if above - below <= divisions {
                return (step, self.first_line(above - divisions, below, divisions));
            }
            step = step.next();
        }
    }

    /// Where the screen begins, between `least` and `most`: zero at an end if
    /// the data lie on one side of it, else zero or the data in the middle.
    fn first_line(&self, least: f64, most: f64, divisions: f64) -> f64 {
        let allowed = |line: f64| (least..=most).contains(&line);
        let centred = -(divisions / 2.0).floor();
        if self.low >= 0.0 && allowed(0.0) {
            0.0
        } else if self.high <= 0.0 && allowed(-divisions) {
            -divisions
        } else if allowed(centred) {
            centred
        } else {
            ((least + most) / 2.0).floor()
        }
    }
}

/// The size of a division: 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy)]
struct Step {
    mantissa: f64,
    exponent: i32,
}

impl Step {
    /// The power of ten at or just below a positive size.
    fn below(size: f64) -> Step {
        Step { mantissa: 1.0, exponent: (size.log10() - SLACK).floor() as i32 }
    }

    fn next(self) -> Step {
        let (mantissa, carry) = match self.mantissa {
            1.0 => (2.0, 0),
            2.0 => (5.0, 0),
            _ => (1.0, 1),
        };
        Step { mantissa, exponent: self.exponent + carry }
    }

    /// A multiple of the step. Dividing by a whole power of ten gives the
    /// nearest number to 0.3 where multiplying by 0.1 would not.
    fn times(self, count: f64) -> f64 {
        let power = 10f64.powi(self.exponent.abs());
        if self.exponent < 0 { count * self.mantissa / power } else { count * self.mantissa * power }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(values: &[f64], divisions: usize) -> (f64, f64) {
        let axis = Axis::fit("x", "", values.iter().copied(), divisions);
        assert_eq!(axis.divisions, divisions);
        (axis.low, axis.high)
    }

    fn snug(values: &[f64]) -> (f64, f64, usize) {
        let axis = Axis::snug("x", "", values.iter().copied(), 10);
        (axis.low, axis.high, axis.divisions)
    }

    #[test]
    fn ranges_are_those_of_a_scope() {
        assert_eq!(range(&[0.0, 10.0], 10), (0.0, 10.0));
        assert_eq!(range(&[-4.0, 4.0], 8), (-4.0, 4.0));
        assert_eq!(range(&[0.0, 0.8], 8), (0.0, 0.8));
        assert_eq!(range(&[-1.0, 1.0], 8), (-2.0, 2.0));
        assert_eq!(range(&[0.0, 30.0], 10), (0.0, 50.0));
        assert_eq!(range(&[-7.5, -0.5], 8), (-8.0, 0.0));
        assert_eq!(range(&[101.0, 107.0], 8), (100.0, 108.0));
        assert_eq!(range(&[-0.01, 10.0], 8), (-4.0, 12.0));
    }

    #[test]
    fn near_zero_is_taken_in_and_far_zero_is_not() {
        assert_eq!(range(&[1.0, 7.0], 8).0, 0.0);
        assert!(range(&[990.0, 1000.0], 8).0 > 900.0);
    }

    #[test]
    fn rounding_in_the_last_sample_costs_no_division() {
        assert_eq!(range(&[0.0, 10.000000001], 10), (0.0, 10.0));
        assert_eq!(range(&[0.0, 0.1 + 0.2], 3), (0.0, 0.3));
    }

    #[test]
    fn snug_axes_have_no_empty_divisions() {
        assert_eq!(snug(&[0.0, 30.0]), (0.0, 30.0, 6));
        assert_eq!(snug(&[-1.0, 1.0]), (-1.0, 1.0, 10));
        assert_eq!(snug(&[0.0, 0.0]), (-1.0, 1.0, 10));
    }

    #[test]
    fn data_without_spread_have_a_sensible_range() {
        assert_eq!(range(&[], 10), (-1.0, 1.0));
        assert_eq!(range(&[0.0, 0.0], 10), (-1.0, 1.0));
        assert_eq!(range(&[f64::NAN, f64::INFINITY], 10), (-1.0, 1.0));
        assert_eq!(range(&[5.0, 5.0], 8), (0.0, 8.0));
        assert_eq!(range(&[-3.0], 10), (-5.0, 0.0));
        assert_eq!(range(&[1e-320], 10), (-1.0, 1.0));
    }

    #[test]
    fn infinities_and_gaps_are_passed_over() {
        let values = [1.0, f64::NAN, f64::NEG_INFINITY, 10.0, f64::INFINITY];
        assert_eq!(range(&values, 10), (0.0, 10.0));
    }

    #[test]
    fn extreme_values_are_survived() {
        let axis = Axis::fit("x", "", [f64::MAX, f64::MIN].into_iter(), 0);
        assert!(axis.is_drawable(), "{axis:?}");
    }

    #[test]
    fn ratios_have_the_ends_asked_for() {
        let axis = |low, high| Axis::ratios("f", "Hz", low, high);
        let ends = |axis: Axis| (axis.low, axis.high, axis.divisions);
        assert_eq!(ends(axis(0.1, 1000.0)), (0.1, 1000.0, 4));
        assert_eq!(ends(axis(25.0, 40.0)), (25.0, 40.0, 1));
        assert_eq!(ends(axis(5.0, 5.0)), (5.0, 50.0, 1));
        let four = axis(0.1, 1000.0);
        assert_eq!([0.1, 1.0, 10.0, 1000.0].map(|value| four.fraction(value)), [0.0, 0.25, 0.5, 1.0]);
        assert!(four.is_drawable() && four.fraction(-1.0) < -10.0 && four.zero_line().is_none());
        assert!(
            four.is_of_decades() && !axis(25.0, 40.0).is_of_decades() && !axis(1e-99, 1e99).is_of_decades()
        );
        assert_eq!(four.multiples(1..2).collect::<Vec<_>>(), [1.0, 10.0, 100.0]);
        assert_eq!(axis(0.25, 4.0).multiples(2..4).collect::<Vec<_>>(), [0.3, 2.0, 3.0]);
        for (low, high) in [(0.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY), (-1.0, -2.0)] {
            assert!(axis(low, high).is_drawable(), "{low} {high}");
        }
        assert!(!Axis { low: -1.0, ..four }.is_drawable());
    }

    /// A deterministic stream of numbers of widely varying size and sign.
    fn numbers() -> impl Iterator<Item = f64> {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        std::iter::repeat_with(move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let size = 10f64.powi((state >> 20) as i32 % 12);
            ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * size
        })
    }

    #[test]
    fn every_fit_covers_its_values_in_round_steps() {
        let mut stream = numbers();
        for round in 0..5000 {
            let values: Vec<f64> = stream.by_ref().take(1 + round % 4).collect();
            let divisions = 2 + round % 12;
            check(&Axis::fit("x", "", values.iter().copied(), divisions), &values);
            check(&Axis::snug("x", "", values.iter().copied(), divisions), &values);
        }
    }

    fn check(axis: &Axis, values: &[f64]) {
        assert!(axis.is_drawable() && axis.high > axis.low, "{axis:?}");
        let step = (axis.high - axis.low) / axis.divisions as f64;
        for value in values {
            assert!(*value >= axis.low - 2.0 * SLACK * step, "{value} in {axis:?}");
            assert!(*value <= axis.high + 2.0 * SLACK * step, "{value} in {axis:?}");
        }
        let mantissa = step / 10f64.powf((step.log10() + 1e-9).floor());
        assert!([1.0, 2.0, 5.0].iter().any(|m| (mantissa - m).abs() < 1e-6), "{axis:?}");
        let lines_below = axis.low / step;
        assert!((lines_below - lines_below.round()).abs() < 1e-3, "{axis:?}");
    }
}
