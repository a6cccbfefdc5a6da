//! Random numbers that are the same on every machine.
//!
//! Each number is a function of the seed and of its index only. So a run does not depend on the order of evaluation,
//! the step or the number of threads.

use std::f64::consts::TAU;

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

/// A noise source of a program.
#[derive(Debug, Clone)]
pub struct Noise {
    /// Index of the drive.
    pub element: usize,
    /// Index of the coefficient with the seed.
    pub seed: u32,
    /// Index of the coefficient with the time between two numbers, in problem seconds.
    pub every: u32,
    /// Distribution of the numbers.
    pub distribution: Distribution,
}

/// The distribution of the numbers, which have mean 0 and variance 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// Normal (Gaussian).
    Normal,
    /// Uniform from -sqrt(3) to sqrt(3).
    Uniform,
}

/// Number of 32-bit words of the stream per random number.
const WORDS_PER_NUMBER: u128 = 4;

impl Distribution {
    /// The number with this index in the sequence of a seed.
    ///
    /// It uses words 4 k to 4 k + 3 of the ChaCha stream with 8 rounds (Bernstein 2008), whose key begins with the
    /// bits of the seed. The words give two numbers between 0 and 1. [`box_muller`] makes one normal number from
    /// them; a uniform number uses the first.
    pub(crate) fn number(self, seed: f64, index: u64) -> f64 {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_bits().to_le_bytes());
        let mut stream = ChaCha8Rng::from_seed(key);
        stream.set_word_pos(u128::from(index) * WORDS_PER_NUMBER);
        let [first, second] = [(); 2].map(|()| between_0_and_1(stream.next_u64()));
        match self {
            Distribution::Normal => box_muller(first, second),
            Distribution::Uniform => libm::sqrt(12.0) * (first - 0.5),
        }
    }
}

/// A standard normal number (mean 0, variance 1) from two independent uniform numbers: sqrt(-2 ln `first`)
/// cos(2 pi `second`), by the method of Box and Muller (1958).
///
/// `first` is above 0 and at most 1, `second` is from 0 to 1. The bits of the result are the same on every platform.
///
/// # Examples
///
/// ```
/// use patchcord_core::ir::box_muller;
///
/// assert_eq!(box_muller(1.0, 0.25), 0.0);
/// assert!((box_muller(0.5, 0.0) - (2.0 * 2f64.ln()).sqrt()).abs() < 1e-12);
/// ```
pub fn box_muller(first: f64, second: f64) -> f64 {
    libm::sqrt(-2.0 * libm::log(first)) * libm::cos(TAU * second)
}

/// The middle of one of 2^52 equal parts of the interval from 0 to 1. The ends never occur.
fn between_0_and_1(word: u64) -> f64 {
    ((word >> 12) as f64 + 0.5) / (1u64 << 52) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first words of the ChaCha stream of 8 rounds under a key of zeros, from
    /// draft-strombergson-chacha-test-vectors-01 (TC1, 256 bits).
    #[test]
    fn the_stream_is_the_published_one() {
        let mut stream = ChaCha8Rng::from_seed([0; 32]);
        let mut bytes = [0; 16];
        stream.fill_bytes(&mut bytes);
        assert_eq!(
            bytes,
            [0x3e, 0x00, 0xef, 0x2f, 0x89, 0x5f, 0x40, 0xd6, 0x7f, 0x5b, 0xb8, 0xe8, 0x1f, 0x09, 0xa5, 0xa1]
        );
    }

    #[test]
    fn numbers_are_the_same_in_every_order() {
        let row: Vec<f64> = (0..50).map(|index| Distribution::Normal.number(7.0, index)).collect();
        assert!((0..50).rev().all(|index| Distribution::Normal.number(7.0, index) == row[index as usize]));
        assert_ne!(Distribution::Normal.number(8.0, 0), row[0]);
    }

    #[test]
    fn the_ends_are_never_drawn() {
        assert!(between_0_and_1(0) > 0.0 && between_0_and_1(u64::MAX) < 1.0);
    }
}
