//! Comparable durations: works are measured in turns, and the shortest duration of each counts.

use std::time::Instant;

use crate::Outcome;

/// The duration of some work in s, and its result.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

/// A work to be measured. It returns its own duration in s, so that preparations need not count.
pub(crate) type Work<'a> = Box<dyn FnMut() -> Outcome<f64> + 'a>;

/// The shortest duration of each work in s.
///
/// The works are done in turns, `rounds` times each, so that a slow phase of the machine affects all of them.
pub(crate) fn in_turns(rounds: usize, mut works: Vec<Work<'_>>) -> Outcome<Vec<f64>> {
    let mut shortest = vec![f64::INFINITY; works.len()];
    for _ in 0..rounds {
        for (shortest, work) in shortest.iter_mut().zip(&mut works) {
            *shortest = shortest.min(work()?);
        }
    }
    Ok(shortest)
}

/// A duration with three digits in s, ms or µs.
pub(crate) fn format_seconds(seconds: f64) -> String {
    match seconds {
        _ if seconds < 1e-3 => format!("{} µs", format_digits(seconds * 1e6)),
        _ if seconds < 1.0 => format!("{} ms", format_digits(seconds * 1e3)),
        _ => format!("{} s", format_digits(seconds)),
    }
}

/// A number with at least its first three digits, such as "1.23", "12.3" or "1234".
pub(crate) fn format_digits(value: f64) -> String {
    let decimals = match value {
        _ if value < 9.995 => 2,
        _ if value < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.decimals$}")
}
