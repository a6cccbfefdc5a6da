//! Noise that looks like chance and is the same in every run.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

/// White noise of standard deviation 1: the sum of twelve even numbers.
pub fn white(seed: u64) -> impl FnMut() -> f64 {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    move || (0..12).map(|_| f64::from(dice.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0
}

/// Noise of standard deviation 1 of which so much is left from sample to sample.
pub fn slow(seed: u64, keeps: f64) -> impl FnMut() -> f64 {
    let (mut white, mut level) = (white(seed), 0.0);
    move || {
        level = keeps * level + (1.0_f64 - keeps * keeps).sqrt() * white();
        level
    }
}
