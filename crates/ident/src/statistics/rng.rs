//! Normal numbers drawn by chance.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

/// So many normal numbers of variance 1, by a seed.
pub fn normal(seed: u64, count: usize) -> Vec<f64> {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let mut even = || (dice.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let mut one = || {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - even()));
        radius * libm::cos(std::f64::consts::TAU * even())
    };
    (0..count).map(|_| one()).collect()
}
