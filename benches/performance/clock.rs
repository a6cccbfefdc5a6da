//! Times that can be compared: taken in turns, the shortest of each.

use std::time::Instant;

use crate::Outcome;

/// The seconds that something takes.
pub fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

/// What is measured: the seconds that it takes.
pub type Work<'a> = Box<dyn FnMut() -> Outcome<f64> + 'a>;

/// The shortest of so many times of each kind of work, done in turns so that all meet the same machine.
pub fn in_turns(rounds: usize, mut works: Vec<Work<'_>>) -> Outcome<Vec<f64>> {
    let mut shortest = vec![f64::INFINITY; works.len()];
    for _ in 0..rounds {
        for (shortest, work) in shortest.iter_mut().zip(&mut works) {
            *shortest = shortest.min(work()?);
        }
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
