//! The axes of a scope picture and the choice of their ranges.
//!
//! A linear axis has 2 to 100 equal divisions, each 1, 2 or 5 times a power of ten, as on an
//! oscilloscope. The range is the finest one that covers the values and has a division line at zero.

/// The scale along one edge of the screen.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::Axis;
///
/// let axis = Axis::fit("x", "mm", [0.0, 30.0], 10);
/// assert_eq!((axis.low, axis.high, axis.divisions), (0.0, 50.0, 10));
/// let axis = Axis::fit_tight("x", "mm", [0.0, 30.0], 10);
/// assert_eq!((axis.low, axis.high, axis.divisions), (0.0, 30.0, 6));
/// let axis = Axis::logarithmic("frequency", "Hz", 0.1, 1000.0);
/// assert_eq!((axis.low, axis.high, axis.divisions), (0.1, 1000.0, 4));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The name of the quantity, such as `v_i`.
    pub label: String,
    /// The unit, such as `mm/s`; empty if there is none.
    pub unit: String,
    /// The value at the left or lower end.
    pub low: f64,
    /// The value at the right or upper end; may be less than `low`.
    pub high: f64,
    /// The number of divisions of the graticule along this axis, 1 to 100.
    pub divisions: usize,
    /// Whether equal lengths are equal ratios. Both ends are then positive.
    pub logarithmic: bool,
}

/// The part of a division by which values may exceed the range. The rounding of summed time steps
/// must not add a division.
const OVERSHOOT: f64 = 1e-6;

/// Larger values are clamped to this, so that differences of values stay finite.
const MAX_MAGNITUDE: f64 = 1e300;
/// Values that are all smaller than this are treated as zero.
const MIN_MAGNITUDE: f64 = 1e-290;

/// A relative spread of the values below this is rounding, and the values count as constant.
const MIN_RELATIVE_SPREAD: f64 = 1e-9;

/// The minimum number of divisions of an axis whose divisions have the size of those of another axis.
const MIN_EQUAL_DIVISIONS: f64 = 4.0;

/// The range is extended to zero if the gap to zero is at most this part of the spread.
const MAX_GAP_TO_ZERO: f64 = 0.25;

impl Axis {
    /// The maximum number of divisions of an axis.
    pub const MAX_DIVISIONS: usize = 100;

    /// The usual number of divisions of a horizontal axis, as on an oscilloscope.
    pub const HORIZONTAL_DIVISIONS: usize = 10;

    /// The usual number of divisions of a vertical axis, as on an oscilloscope.
    pub const VERTICAL_DIVISIONS: usize = 8;

    /// Returns an axis with exactly `divisions` divisions that covers all finite `values`.
    ///
    /// `divisions` is clamped to 2 to 100. Each division is 1, 2 or 5 times a power of ten. The values
    /// may exceed the range by a millionth of a division. Zero is on a division line, and it is within
    /// the range if it is near the values. If all values are equal, the range extends from zero to
    /// them; if there are none or all are zero, it includes -1 to 1. Example: 0 to 30 with 10
    /// divisions gives 0 to 50.
    pub fn fit(
        label: impl Into<String>,
        unit: impl Into<String>,
        values: impl IntoIterator<Item = f64>,
        divisions: usize,
    ) -> Axis {
        let divisions = divisions.clamp(2, Axis::MAX_DIVISIONS);
        let span = ValueRange::of(values);
        let (step, first) = span.covering_step(divisions as f64);
        Axis::between(label, unit, step, (first, first + divisions as f64))
    }

    /// Returns an axis like [`Axis::fit`], but without empty divisions at the ends.
    ///
    /// `divisions` is the maximum number of divisions. Example: 0 to 30 with at most 10 divisions gives
    /// 0 to 30 with 6 divisions.
    pub fn fit_tight(
        label: impl Into<String>,
        unit: impl Into<String>,
        values: impl IntoIterator<Item = f64>,
        divisions: usize,
    ) -> Axis {
        let max = divisions.clamp(2, Axis::MAX_DIVISIONS);
        let span = ValueRange::of(values);
        let (step, _) = span.covering_step(max as f64);
        Axis::between(label, unit, step, span.lines_around(step))
    }

    /// Returns a horizontal and a vertical axis like [`Axis::fit_tight`] whose divisions have the same size.
    ///
    /// Both have the same unit; each has a label and values. An axis has at least 4 divisions, so that the screen
    /// is not too narrow. Example: 0 to 30 and 0 to 3 give 0 to 30 and -5 to 15, in divisions of 5.
    pub fn fit_equal(unit: &str, quantities: [(String, Vec<f64>); 2]) -> [Axis; 2] {
        let [across, up] = quantities.map(|(label, values)| (label, ValueRange::of(values)));
        let steps = [(&across.1, Axis::HORIZONTAL_DIVISIONS), (&up.1, Axis::VERTICAL_DIVISIONS)]
            .map(|(span, divisions)| span.covering_step(divisions as f64).0);
        let step = if steps[0].times(1.0) >= steps[1].times(1.0) { steps[0] } else { steps[1] };
        [across, up].map(|(label, span)| {
            let (first, last) = span.lines_around(step);
            let missing = (MIN_EQUAL_DIVISIONS - (last - first)).max(0.0);
            let lines = (first - (missing / 2.0).floor(), last + (missing / 2.0).ceil());
            Axis::between(label, unit, step, lines)
        })
    }

    /// Returns an axis between two lines, which are counted in steps from zero.
    fn between(
        label: impl Into<String>,
        unit: impl Into<String>,
        step: Step,
        (first, last): (f64, f64),
    ) -> Axis {
        Axis {
            label: label.into(),
            unit: unit.into(),
            low: step.times(first),
            high: step.times(last),
            divisions: (last - first) as usize,
            logarithmic: false,
        }
    }

    /// Returns a logarithmic axis from `low` to `high`, with one division for each decade.
    ///
    /// The number of divisions is at most [`Axis::MAX_DIVISIONS`]. Both ends must be positive; other
    /// values are replaced by the nearest permitted one, and NaN by 1. If `high` is not greater than
    /// `low`, it becomes ten times `low`.
    pub fn logarithmic(label: impl Into<String>, unit: impl Into<String>, low: f64, high: f64) -> Axis {
        let positive =
            |value: f64| if value.is_nan() { 1.0 } else { value.clamp(1.0 / MAX_MAGNITUDE, MAX_MAGNITUDE) };
        let low = positive(low);
        let high = Some(positive(high)).filter(|high| *high > low).unwrap_or(10.0 * low);
        let decades = (high.log10() - low.log10()).round();
        Axis {
            label: label.into(),
            unit: unit.into(),
            low,
            high,
            divisions: decades.clamp(1.0, Axis::MAX_DIVISIONS as f64) as usize,
            logarithmic: true,
        }
    }

    /// Whether the divisions of a logarithmic axis run from one power of ten to the next.
    pub(super) fn has_decade_divisions(&self) -> bool {
        let ends = [self.low.log10(), self.high.log10()];
        let is_whole = |number: f64| (number - number.round()).abs() < OVERSHOOT;
        ends.iter().all(|end| is_whole(*end)) && (ends[1] - ends[0]).round() == self.divisions as f64
    }

    /// Returns the given multiples of all powers of ten between the ends of a logarithmic axis.
    ///
    /// The values are in ascending order of the power; values at the ends are not included.
    pub(super) fn multiples(&self, factors: std::ops::Range<u32>) -> impl Iterator<Item = f64> {
        let exponents = self.low.log10().floor() as i32..=self.high.log10().floor() as i32;
        let all = exponents.flat_map(move |exponent| {
            // Parsing the decimal text rounds each value only once.
            factors.clone().filter_map(move |factor| format!("{factor}e{exponent}").parse::<f64>().ok())
        });
        all.filter(|value| (OVERSHOOT..1.0 - OVERSHOOT).contains(&self.fraction(*value)))
    }

    /// Returns the position of a finite value: 0 at the low end, 1 at the high end.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        if self.logarithmic {
            let decades = |value: f64| value.max(f64::MIN_POSITIVE).log10() - self.low.log10();
            return decades(value) / decades(self.high);
        }
        // The values are halved so that differences of very large values stay finite.
        (value / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0)
    }

    /// Returns the value at a division line; line 0 is the low end.
    pub(super) fn line(&self, index: usize) -> f64 {
        let part = index as f64 / self.divisions as f64;
        if self.logarithmic {
            return self.low * (self.high / self.low).powf(part);
        }
        self.low * (1.0 - part) + self.high * part
    }

    /// Returns the position of zero between the ends of the axis; `None` if zero is not between them.
    pub(super) fn zero_fraction(&self) -> Option<f64> {
        if self.logarithmic {
            return None;
        }
        let on_line = self.lines_to_zero().map(|line| line / self.divisions as f64);
        on_line.or(Some(self.fraction(0.0))).filter(|fraction| *fraction > 0.0 && *fraction < 1.0)
    }

    /// Returns the first line that has a number if only every `stride`-th line has one.
    ///
    /// The line of zero is then one of them, also if zero is outside the axis.
    pub(super) fn anchor(&self, stride: usize) -> usize {
        let to_zero = self.lines_to_zero().unwrap_or(0.0);
        to_zero.rem_euclid(stride as f64) as usize
    }

    /// Returns the number of divisions from the low end to zero; `None` if it is not whole.
    fn lines_to_zero(&self) -> Option<f64> {
        if self.logarithmic {
            return None;
        }
        let position = self.fraction(0.0) * self.divisions as f64;
        ((position - position.round()).abs() < OVERSHOOT).then_some(position.round())
    }

    /// Whether the range is finite and not empty and the number of divisions is permitted.
    pub(super) fn is_drawable(&self) -> bool {
        (1..=Axis::MAX_DIVISIONS).contains(&self.divisions)
            && self.low.abs().max(self.high.abs()) <= f64::MAX
            && (!self.logarithmic || (self.low > 0.0 && self.high > self.low))
            && self.fraction(self.high) == 1.0
            && self.fraction(self.low) == 0.0
    }
}

/// The range that an axis must cover; never empty.
struct ValueRange {
    /// The lowest value, or 0 if zero is near.
    low: f64,
    /// The highest value, or 0 if zero is near.
    high: f64,
}

impl ValueRange {
    /// Returns the range of all finite values, extended to zero if zero is near.
    fn of(values: impl IntoIterator<Item = f64>) -> ValueRange {
        let (low, high) = values
            .into_iter()
            .filter(|value| value.is_finite())
            .map(|value| value.clamp(-MAX_MAGNITUDE, MAX_MAGNITUDE))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        ValueRange { low, high }.widened().extended_to_zero()
    }

    /// Extends the range of constant values to zero, and an empty or zero range to -1 to 1.
    fn widened(self) -> ValueRange {
        let size = self.low.abs().max(self.high.abs());
        if self.low > self.high || size < MIN_MAGNITUDE {
            ValueRange { low: -1.0, high: 1.0 }
        } else if self.high - self.low < MIN_RELATIVE_SPREAD * size {
            ValueRange { low: self.low.min(0.0), high: self.high.max(0.0) }
        } else {
            self
        }
    }

    /// Extends the range to zero if zero is near.
    fn extended_to_zero(self) -> ValueRange {
        let reach = MAX_GAP_TO_ZERO * (self.high - self.low);
        let low = if (0.0..=reach).contains(&self.low) { 0.0 } else { self.low };
        let high = if (-reach..=0.0).contains(&self.high) { 0.0 } else { self.high };
        ValueRange { low, high }
    }

    /// Returns the division lines just outside the range, counted from zero.
    fn lines_around(&self, step: Step) -> (f64, f64) {
        let unit = step.times(1.0);
        ((self.low / unit + OVERSHOOT).floor(), (self.high / unit - OVERSHOOT).ceil())
    }

    /// Returns the finest step with which `divisions` divisions cover the range, and the first line.
    ///
    /// The first line is the low end of the axis, counted in steps from zero.
    fn covering_step(&self, divisions: f64) -> (Step, f64) {
        let mut step = Step::at_most((self.high - self.low) / divisions);
        loop {
            let (below, above) = self.lines_around(step);
            if above - below <= divisions {
                return (step, self.first_line(above - divisions, below, divisions));
            }
            step = step.next();
        }
    }

    /// Returns the first line of the axis, between `min` and `max`.
    ///
    /// If all values have the same sign, zero is at an end if possible. Otherwise zero is in the middle
    /// if possible, else the values are.
    fn first_line(&self, min: f64, max: f64, divisions: f64) -> f64 {
        let allowed = |line: f64| (min..=max).contains(&line);
        let centred = -(divisions / 2.0).floor();
        if self.low >= 0.0 && allowed(0.0) {
            0.0
        } else if self.high <= 0.0 && allowed(-divisions) {
            -divisions
        } else if allowed(centred) {
            centred
        } else {
            ((min + max) / 2.0).floor()
        }
    }
}

/// The size of a division: 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy)]
struct Step {
    /// 1, 2 or 5.
    mantissa: f64,
    /// The power of ten.
    exponent: i32,
}

impl Step {
    /// Returns the largest power of ten that is at most a positive size.
    fn at_most(size: f64) -> Step {
        Step { mantissa: 1.0, exponent: (size.log10() - OVERSHOOT).floor() as i32 }
    }

    /// Returns the next larger step in the series 1, 2, 5, 10.
    fn next(self) -> Step {
        let (mantissa, carry) = match self.mantissa {
            1.0 => (2.0, 0),
            2.0 => (5.0, 0),
            _ => (1.0, 1),
        };
        Step { mantissa, exponent: self.exponent + carry }
    }

    /// Returns `count` steps.
    ///
    /// Negative exponents divide by a power of ten, because 3 / 10 is the 64-bit number nearest to 0.3
    /// and 3 * 0.1 is not.
    fn times(self, count: f64) -> f64 {
        let power = 10f64.powi(self.exponent.abs());
        if self.exponent < 0 { count * self.mantissa / power } else { count * self.mantissa * power }
    }
}

#[cfg(test)]
mod tests;
