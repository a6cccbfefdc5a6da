//! Instruments: what can be read from a trace.

mod family;
mod harmonic;
mod log;
mod quantity;
mod ringing;
mod scope;
mod voltmeter;

pub use harmonic::{Harmonic, HarmonicError, harmonic};
pub use log::{deed, ending, missed};
pub use quantity::Display;
pub use ringing::{Ringing, RingingError, ringing};
pub use scope::{ScopeError, picture};
pub use voltmeter::{Extreme, Reading, readings};

/// A signal at so many instants, for tests.
#[cfg(test)]
fn sampled(count: usize, step: f64, signal: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    let time: Vec<f64> = (0..count).map(|index| index as f64 * step).collect();
    let values = time.iter().map(|t| signal(*t)).collect();
    (time, values)
}
