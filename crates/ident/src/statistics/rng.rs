//! Reproducible random numbers.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

/// Draws `count` independent standard normal numbers (mean 0, variance 1) with the Box-Muller transform. The same seed
/// gives the same numbers on every platform.
pub fn standard_normal(seed: u64, count: usize) -> Vec<f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let mut normal = || {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - uniform()));
        radius * libm::cos(std::f64::consts::TAU * uniform())
    };
    (0..count).map(|_| normal()).collect()
}
