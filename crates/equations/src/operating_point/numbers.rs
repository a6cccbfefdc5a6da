//! Random numbers that depend on a seed only.

/// Smallest share of a random number in the largest one, so that no term is lost.
const SMALLEST_SHARE: f64 = 0.2;

/// Random numbers: splitmix64 of Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014.
pub(crate) struct Numbers(u64);

impl Numbers {
    /// The numbers of a seed.
    pub(crate) fn new(seed: u64) -> Self {
        Numbers(seed)
    }

    /// The next number from -1 to 1, with at least the smallest share.
    pub(crate) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
        let size = (mixed >> 12) as f64 / (1u64 << 52) as f64;
        let share = SMALLEST_SHARE + (1.0 - SMALLEST_SHARE) * size;
        if mixed & 1 == 0 { share } else { -share }
    }
}
