//! Times that can be compared: taken in turns, the shortest of each.

use std::time::Instant;

use crate::Outcome;

/// The seconds that something takes.
pub fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

/// The shortest of so many times of one kind of work.
pub fn shortest(rounds: usize, mut work: impl FnMut() -> Outcome<f64>) -> Outcome<f64> {
    (0..rounds).try_fold(f64::INFINITY, |shortest, _| Ok(work()?.min(shortest)))
}

/// The shortest of so many times of two kinds of work, done in turns so that both meet the same machine.
pub fn in_turns(
    rounds: usize,
    mut one: impl FnMut() -> Outcome<f64>,
    mut other: impl FnMut() -> Outcome<f64>,
) -> Outcome<[f64; 2]> {
    let mut shortest = [f64::INFINITY; 2];
    for _ in 0..rounds {
        shortest[0] = shortest[0].min(one()?);
        shortest[1] = shortest[1].min(other()?);
    }
    Ok(shortest)
}

/// Seconds as a person reads them.
pub fn told(seconds: f64) -> String {
    match seconds {
        _ if seconds < 1e-3 => format!("{} µs", three(seconds * 1e6)),
        _ if seconds < 1.0 => format!("{} ms", three(seconds * 1e3)),
        _ => format!("{} s", three(seconds)),
    }
}

/// A number with its three first digits at least.
pub fn three(value: f64) -> String {
    let places = match value {
        _ if value < 9.995 => 2,
        _ if value < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.places$}")
}
