//! The numbers at the division lines of an axis.
//!
//! A linear axis shows as many numbers as fit: at every division line, or every second, fifth or
//! tenth, always including zero if zero is on a line. Very large and very small values are divided by
//! a power of ten that is shown with the unit. A logarithmic axis shows its decades, or its two ends
//! and round values between them.

use super::Axis;
use super::font::with_minus_sign;
use patchcord_expr::round_significant;

/// A number at a division line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    /// The position of the line: 0 at the low end of the axis, 1 at the high end.
    pub fraction: f64,
    /// The number, without the unit.
    pub text: String,
}

/// If the largest absolute value of an axis is in this range, its numbers have no power of ten.
const PLAIN_SIZES: std::ops::Range<f64> = 0.01..100_000.0;

/// Large values with divisions smaller than this have no power of ten either. A power of ten would
/// move their significant digits behind the decimal point.
const MIN_SCALED_DIVISION: f64 = 100.0;

/// Rounding errors below this part of a division need no further decimal.
const DECIMAL_TOLERANCE: f64 = 1e-6;

/// The maximum number of decimals after the first digit of a division.
const EXTRA_DECIMALS: i32 = 2;

/// Returns as many numbers as fit along an axis of this length.
///
/// `extent` returns the length that a text needs along the axis, including the gap to the next. The
/// numbers are at every division line, or at every second, fifth, tenth, twentieth or fiftieth.
pub(super) fn fit(axis: &Axis, length: f64, extent: impl Fn(&str) -> f64) -> Vec<Tick> {
    if axis.logarithmic && !axis.has_decade_divisions() {
        return logarithmic_ticks(axis, length, extent);
    }
    let division = length / axis.divisions as f64;
    let fits = |ticks: &[Tick], stride: usize| {
        let widest = ticks.iter().map(|tick| extent(&tick.text));
        widest.fold(0.0, f64::max) <= division * stride as f64
    };
    [1, 2, 5, 10, 20, 50]
        .into_iter()
        .map(|stride| (stride, with_stride(axis, stride)))
        .find(|(stride, ticks)| fits(ticks, *stride))
        .map(|(_, ticks)| ticks)
        .unwrap_or_else(|| with_stride(axis, axis.divisions))
}

/// Returns the numbers at every `stride`-th division line. Zero is one of them if it is on a line.
pub(super) fn with_stride(axis: &Axis, stride: usize) -> Vec<Tick> {
    if axis.logarithmic {
        return decades(axis, stride);
    }
    let anchor = axis.anchor(stride);
    let lines: Vec<usize> = (0..=axis.divisions).filter(|line| line % stride == anchor).collect();
    let unit = 10f64.powi(exponent(axis));
    let division = division(axis, unit);
    let values: Vec<f64> = lines.iter().map(|line| axis.line(*line) / unit).collect();
    let decimals = decimals(&values, division);
    lines
        .iter()
        .zip(values)
        .map(|(line, value)| Tick {
            fraction: *line as f64 / axis.divisions as f64,
            text: line_text(value, division, decimals),
        })
        .collect()
}

/// Returns the numbers at every `stride`-th decade of a logarithmic axis.
fn decades(axis: &Axis, stride: usize) -> Vec<Tick> {
    (0..=axis.divisions).step_by(stride).map(|line| tick(axis, axis.line(line))).collect()
}

/// Returns the numbers of a logarithmic axis whose ends are not powers of ten.
///
/// Both ends have a number. Between them are the multiples 1 to 9 of the powers of ten if they fit,
/// else the powers of ten if they fit, else none.
fn logarithmic_ticks(axis: &Axis, length: f64, extent: impl Fn(&str) -> f64) -> Vec<Tick> {
    let is_separate = |one: &Tick, next: &Tick| {
        (next.fraction - one.fraction) * length >= extent(&one.text).max(extent(&next.text))
    };
    let ends = [axis.low, axis.high].map(|end| tick(axis, end));
    let inner = [1..10, 1..2].map(|times| {
        let all = axis.multiples(times).map(|value| tick(axis, value));
        all.filter(|tick| is_separate(&ends[0], tick) && is_separate(tick, &ends[1])).collect::<Vec<_>>()
    });
    let fits = |ticks: &Vec<Tick>| ticks.windows(2).all(|pair| is_separate(&pair[0], &pair[1]));
    let [low, high] = ends.clone();
    [low].into_iter().chain(inner.into_iter().find(fits).into_iter().flatten()).chain([high]).collect()
}

/// Returns the number of a value on a logarithmic axis, to four digits: `0.3`, `33.33`, `2·10⁵`.
fn tick(axis: &Axis, value: f64) -> Tick {
    let rounded = round_significant(value, 4);
    let is_plain = PLAIN_LOGARITHMIC_VALUES.contains(&rounded);
    let text = if is_plain { rounded.to_string() } else { scientific(rounded) };
    Tick { fraction: axis.fraction(value), text }
}

/// Formats a number with a power of ten: `2·10⁵`, or `10⁵` if the factor is 1.
fn scientific(value: f64) -> String {
    let text = format!("{value:e}");
    let (factor, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let power = power_of_ten(exponent.parse().unwrap_or(0));
    if factor == "1" { power } else { format!("{factor}·{power}") }
}

/// Values in this range have no power of ten on a logarithmic axis.
const PLAIN_LOGARITHMIC_VALUES: std::ops::Range<f64> = 0.001..100_000.0;

/// Returns the text after the label in the title of an axis: `, mm/s` or `, 10⁻³ mm/s`.
///
/// The power of ten is the factor by which the numbers of the axis are multiplied.
pub(super) fn unit(axis: &Axis) -> String {
    let power = match exponent(axis) {
        0 => String::new(),
        exponent => power_of_ten(exponent),
    };
    let parts = [power.as_str(), axis.unit.as_str()];
    let unit = parts.map(str::trim).join(" ").trim().to_owned();
    if unit.is_empty() || axis.label.is_empty() { unit } else { format!(", {unit}") }
}

/// Returns the exponent of the power of ten by which the numbers are divided; a multiple of three.
fn exponent(axis: &Axis) -> i32 {
    if axis.logarithmic {
        return 0;
    }
    let size = axis.low.abs().max(axis.high.abs());
    let detailed = size >= PLAIN_SIZES.end && division(axis, 1.0) < MIN_SCALED_DIVISION;
    if PLAIN_SIZES.contains(&size) || size == 0.0 || detailed {
        0
    } else {
        // The power for a smaller exponent would underflow to zero.
        ((size.log10() / 3.0).floor() as i32 * 3).max(-306)
    }
}

/// Returns the absolute size of a division, in multiples of `unit`.
fn division(axis: &Axis, unit: f64) -> f64 {
    ((axis.high / unit - axis.low / unit) / axis.divisions as f64).abs()
}

/// Returns the smallest number of decimals with which all numbers are exact, up to a maximum.
fn decimals(values: &[f64], division: f64) -> usize {
    let max = (EXTRA_DECIMALS - division.log10().floor() as i32).max(0) as usize;
    let exact = |decimals: usize| {
        let power = 10f64.powi(decimals as i32);
        let error = |value: &f64| ((value * power).round() / power - value).abs();
        values.iter().all(|value| error(value) < DECIMAL_TOLERANCE * division)
    };
    (0..max).find(|decimals| exact(*decimals)).unwrap_or(max)
}

/// Formats the number at a division line; values that are zero up to rounding become `0`.
fn line_text(value: f64, division: f64, decimals: usize) -> String {
    if value.abs() < DECIMAL_TOLERANCE * division {
        "0".to_owned()
    } else {
        with_minus_sign(&format!("{value:.decimals$}"))
    }
}

/// Formats a power of ten with its exponent in superscript digits: `10⁻³`.
fn power_of_ten(exponent: i32) -> String {
    let digit = |letter: char| match letter {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => char::from_u32('⁰' as u32 + letter.to_digit(10).unwrap_or(0)).unwrap_or(letter),
    };
    let digits: String = exponent.to_string().chars().map(digit).collect();
    format!("10{digits}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(low: f64, high: f64, divisions: usize) -> Axis {
        Axis { label: "v_o".to_owned(), unit: "mm/s".to_owned(), low, high, divisions, logarithmic: false }
    }

    fn texts(low: f64, high: f64, divisions: usize, stride: usize) -> String {
        let ticks = with_stride(&axis(low, high, divisions), stride);
        let texts: Vec<String> = ticks.into_iter().map(|tick| tick.text).collect();
        texts.join(" ")
    }

    #[test]
    fn numbers_are_short_and_uniform() {
        assert_eq!(texts(0.0, 8.0, 4, 1), "0 2 4 6 8");
        assert_eq!(texts(-0.4, 0.4, 8, 2), "−0.4 −0.2 0 0.2 0.4");
        assert_eq!(texts(0.0, 2.0, 4, 1), "0 0.5 1.0 1.5 2.0");
        assert_eq!(texts(0.0, 2.0, 4, 2), "0 1 2");
        assert_eq!(texts(0.0, 1.0, 3, 1), "0 0.333 0.667 1.000");
        assert_eq!(texts(2.0, 0.0, 2, 1), "2 1 0");
        assert_eq!(texts(9.0, 17.0, 8, 5), "10 15");
        assert_eq!(texts(0.3, 1.3, 2, 1), "0.3 0.8 1.3");
    }

    #[test]
    fn powers_of_ten_move_to_the_unit() {
        assert_eq!(texts(0.0, 0.008, 4, 1), "0 2 4 6 8");
        assert_eq!(unit(&axis(0.0, 0.008, 4)), ", 10⁻³ mm/s");
        assert_eq!(texts(0.0, 4e5, 2, 1), "0 200 400");
        assert_eq!(unit(&axis(0.0, 4e14, 2)), ", 10¹² mm/s");
        assert_eq!(unit(&axis(-1.0, 1.0, 2)), ", mm/s");
        assert_eq!(texts(1e6, 1e6 + 2.0, 2, 1), "1000000 1000001 1000002");
    }

    #[test]
    fn long_decades_become_powers_of_ten() {
        let axis = Axis::logarithmic("f", "Hz", 1e-5, 1e6);
        let texts: Vec<String> = with_stride(&axis, 1).into_iter().map(|tick| tick.text).collect();
        assert_eq!(texts.join(" "), "10⁻⁵ 10⁻⁴ 0.001 0.01 0.1 1 10 100 1000 10000 10⁵ 10⁶");
        assert_eq!((with_stride(&axis, 5).len(), unit(&axis).as_str()), (3, ", Hz"));
    }

    #[test]
    fn ends_between_decades_have_numbers() {
        let texts = |low, high, length| {
            let ticks =
                fit(&Axis::logarithmic("f", "Hz", low, high), length, |text| 10.0 * text.len() as f64);
            ticks.into_iter().map(|tick| tick.text).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(texts(25.0, 40.0, 500.0), "25 30 40");
        assert_eq!(texts(31.4, 31.6, 500.0), "31.4 31.6");
        assert_eq!(
            texts(0.3, 33.333333, 2000.0),
            "0.3 0.4 0.5 0.6 0.7 0.8 0.9 1 2 3 4 5 6 7 8 9 10 20 33.33"
        );
        assert_eq!(texts(0.3, 33.333333, 300.0), "0.3 1 10 33.33");
        assert_eq!(texts(2e5, 3e7, 400.0), "2·10⁵ 10⁶ 10⁷ 3·10⁷");
        assert_eq!(texts(1e-99, 1e99, 300.0), "10⁻⁹⁹ 10⁹⁹");
    }

    #[test]
    fn titles_omit_missing_parts() {
        let mut bare = axis(-1.0, 1.0, 2);
        bare.unit.clear();
        assert_eq!(unit(&bare), "");
        bare.high = 1e6;
        assert_eq!(unit(&bare), ", 10⁶");
        bare.label.clear();
        assert_eq!(unit(&bare), "10⁶");
    }

    #[test]
    fn crowded_numbers_are_thinned_around_zero() {
        let ticks = fit(&axis(-3.0, 5.0, 8), 80.0, |_| 15.0);
        let texts: Vec<&str> = ticks.iter().map(|tick| tick.text.as_str()).collect();
        assert_eq!(texts, ["−2", "0", "2", "4"]);
        assert!(!fit(&axis(-3.0, 5.0, 8), 8.0, |_| 1000.0).is_empty());
    }

    #[test]
    fn extreme_ranges_have_finite_numbers() {
        for size in [1e-300, 1e-12, 1e12, 1e300] {
            for tick in with_stride(&axis(-size, size, 2), 1) {
                assert!(tick.text.len() < 8, "{size}: {}", tick.text);
            }
        }
    }
}
