use super::Axis;

/// A number beside a division line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    /// Where the line is: 0 at the low end of the axis, 1 at the high end.
    pub fraction: f64,
    pub text: String,
}

/// Values from the first to below the second are written out; larger and
/// smaller ones with a power of ten beside the unit.
const WRITTEN_OUT: std::ops::Range<f64> = 0.01..100_000.0;

/// Large numbers with divisions below this are written out all the same, since
/// a power of ten would move their digits behind the point.
const COARSE: f64 = 100.0;

/// A difference that is not worth a decimal, in divisions.
const NO_DIFFERENCE: f64 = 1e-6;

/// Decimals beyond the first digit of a division that are worth showing.
const EXTRA_DECIMALS: i32 = 2;

/// As many numbers as fit beside an axis `length` long, each taking `room_for`
/// its text: at every division line, or every second, fifth or tenth.
pub(super) fn fitting(axis: &Axis, length: f64, room_for: impl Fn(&str) -> f64) -> Vec<Tick> {
    if axis.logarithmic && !axis.is_of_decades() {
        return between(axis, length, room_for);
    }
    let division = length / axis.divisions as f64;
    let fits = |ticks: &[Tick], stride: usize| {
        let widest = ticks.iter().map(|tick| room_for(&tick.text));
        widest.fold(0.0, f64::max) <= division * stride as f64
    };
    [1, 2, 5, 10, 20, 50]
        .into_iter()
        .map(|stride| (stride, every(axis, stride)))
        .find(|(stride, ticks)| fits(ticks, *stride))
        .map(|(_, ticks)| ticks)
        .unwrap_or_else(|| every(axis, axis.divisions))
}

/// The numbers at every `stride`-th division line, zero among them if it can be.
pub(super) fn every(axis: &Axis, stride: usize) -> Vec<Tick> {
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
            text: number(value, division, decimals),
        })
        .collect()
}

fn decades(axis: &Axis, stride: usize) -> Vec<Tick> {
    (0..=axis.divisions).step_by(stride).map(|line| tick(axis, axis.line(line))).collect()
}

/// The numbers of a logarithmic axis whose ends are no decades: both ends, and between them at 1 to 9 times the
/// decades, or at the decades, or none.
fn between(axis: &Axis, length: f64, room_for: impl Fn(&str) -> f64) -> Vec<Tick> {
    let apart = |one: &Tick, next: &Tick| {
        (next.fraction - one.fraction) * length >= room_for(&one.text).max(room_for(&next.text))
    };
    let ends = [axis.low, axis.high].map(|end| tick(axis, end));
    let inner = [1..10, 1..2].map(|times| {
        let all = axis.multiples(times).map(|value| tick(axis, value));
        all.filter(|tick| apart(&ends[0], tick) && apart(tick, &ends[1])).collect::<Vec<_>>()
    });
    let fits = |ticks: &Vec<Tick>| ticks.windows(2).all(|pair| apart(&pair[0], &pair[1]));
    let [low, high] = ends.clone();
    [low].into_iter().chain(inner.into_iter().find(fits).into_iter().flatten()).chain([high]).collect()
}

/// The number of a value on a logarithmic axis, to four digits.
fn tick(axis: &Axis, value: f64) -> Tick {
    let power = format!("{value:.3e}");
    let short = power.parse().unwrap_or(value);
    let text = match power.split_once('e') {
        Some((times, exponent)) if !RATIOS_WRITTEN_OUT.contains(&short) => {
            let times = times.trim_end_matches('0').trim_end_matches('.');
            let power = format!("10{}", raised(exponent.parse().unwrap_or(0)));
            if times == "1" { power } else { format!("{times}·{power}") }
        }
        _ => short.to_string(),
    };
    Tick { fraction: axis.fraction(value), text }
}

/// Values on a logarithmic axis from the first to below the second are written out.
const RATIOS_WRITTEN_OUT: std::ops::Range<f64> = 0.001..100_000.0;

/// What stands after the label of an axis in its title: the unit, with the power
/// of ten by which the numbers are to be taken.
pub(super) fn unit(axis: &Axis) -> String {
    let power = match exponent(axis) {
        0 => String::new(),
        exponent => format!("10{}", raised(exponent)),
    };
    let parts = [power.as_str(), axis.unit.as_str()];
    let unit = parts.map(str::trim).join(" ").trim().to_owned();
    if unit.is_empty() || axis.label.is_empty() { unit } else { format!(", {unit}") }
}

/// The power of ten, a multiple of three, left out of the numbers.
fn exponent(axis: &Axis) -> i32 {
    if axis.logarithmic {
        return 0;
    }
    let size = axis.low.abs().max(axis.high.abs());
    let detailed = size >= WRITTEN_OUT.end && division(axis, 1.0) < COARSE;
    if WRITTEN_OUT.contains(&size) || size == 0.0 || detailed {
        0
    } else {
        // Smaller powers would come out as zero.
        ((size.log10() / 3.0).floor() as i32 * 3).max(-306)
    }
}

/// The size of a division in a unit.
fn division(axis: &Axis, unit: f64) -> f64 {
    ((axis.high / unit - axis.low / unit) / axis.divisions as f64).abs()
}

/// The fewest decimals that tell all the numbers exactly, within reason.
fn decimals(values: &[f64], division: f64) -> usize {
    let most = (EXTRA_DECIMALS - division.log10().floor() as i32).max(0) as usize;
    let exact = |decimals: usize| {
        let power = 10f64.powi(decimals as i32);
        let error = |value: &f64| ((value * power).round() / power - value).abs();
        values.iter().all(|value| error(value) < NO_DIFFERENCE * division)
    };
    (0..most).find(|decimals| exact(*decimals)).unwrap_or(most)
}

fn number(value: f64, division: f64, decimals: usize) -> String {
    if value.abs() < NO_DIFFERENCE * division {
        "0".to_owned()
    } else {
        format!("{value:.decimals$}").replace('-', "−")
    }
}

/// A whole number in superscript digits.
fn raised(number: i32) -> String {
    let digit = |letter: char| match letter {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => char::from_u32('⁰' as u32 + letter.to_digit(10).unwrap_or(0)).unwrap_or(letter),
    };
    number.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(low: f64, high: f64, divisions: usize) -> Axis {
        Axis { label: "v_o".to_owned(), unit: "mm/s".to_owned(), low, high, divisions, logarithmic: false }
    }

    fn texts(low: f64, high: f64, divisions: usize, stride: usize) -> String {
        let ticks = every(&axis(low, high, divisions), stride);
        let texts: Vec<String> = ticks.into_iter().map(|tick| tick.text).collect();
        texts.join(" ")
    }

    #[test]
    fn numbers_are_short_and_alike() {
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
    fn decades_are_numbers_as_long_as_they_are_short() {
        let axis = Axis::ratios("f", "Hz", 1e-5, 1e6);
        let texts: Vec<String> = every(&axis, 1).into_iter().map(|tick| tick.text).collect();
        assert_eq!(texts.join(" "), "10⁻⁵ 10⁻⁴ 0.001 0.01 0.1 1 10 100 1000 10000 10⁵ 10⁶");
        assert_eq!((every(&axis, 5).len(), unit(&axis).as_str()), (3, ", Hz"));
    }

    #[test]
    fn ends_that_are_no_decades_have_their_numbers() {
        let texts = |low, high, length| {
            let ticks = fitting(&Axis::ratios("f", "Hz", low, high), length, |text| 10.0 * text.len() as f64);
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
    fn titles_do_without_what_is_missing() {
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
        let ticks = fitting(&axis(-3.0, 5.0, 8), 80.0, |_| 15.0);
        let texts: Vec<&str> = ticks.iter().map(|tick| tick.text.as_str()).collect();
        assert_eq!(texts, ["−2", "0", "2", "4"]);
        assert!(!fitting(&axis(-3.0, 5.0, 8), 8.0, |_| 1000.0).is_empty());
    }

    #[test]
    fn extreme_ranges_have_finite_numbers() {
        for size in [1e-300, 1e-12, 1e12, 1e300] {
            for tick in every(&axis(-size, size, 2), 1) {
                assert!(tick.text.len() < 8, "{size}: {}", tick.text);
            }
        }
    }
}
