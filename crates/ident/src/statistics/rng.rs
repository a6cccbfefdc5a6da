//! Reproducible random numbers.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

use patchcord_core::ir::box_muller;

/// Draws `count` independent standard normal numbers (mean 0, variance 1) with the Box-Muller transform. The same seed
/// gives the same numbers on every platform.
pub(crate) fn standard_normal(seed: u64, count: usize) -> Vec<f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..count).map(|_| box_muller(1.0 - uniform(), uniform())).collect()
}
