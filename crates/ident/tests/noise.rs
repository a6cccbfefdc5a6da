//! Pseudorandom noise from fixed seeds, so that every run of a test has the same data.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

/// White noise of standard deviation 1, almost normally distributed.
///
/// Each sample is the sum of twelve uniform numbers in 0 ... 1, less 6. Their variances are 1/12 each.
pub(crate) fn white(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    move || (0..12).map(|_| f64::from(rng.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0
}

/// First-order autoregressive noise of standard deviation 1: x' = `correlation` x + white noise.
///
/// `correlation` is the correlation of neighbouring samples, in 0 ... 1.
pub(crate) fn autoregressive(seed: u64, correlation: f64) -> impl FnMut() -> f64 {
    let (mut white, mut level) = (white(seed), 0.0);
    move || {
        level = correlation * level + (1.0_f64 - correlation * correlation).sqrt() * white();
        level
    }
}
