//! Round factors that bring a peak into the range of an amplifier.

use patchcord_core::machines::GOOD_VOLTS;

/// Largest peak of an amplifier that is scaled well, in volts. The rest of the range is a reserve.
const LARGEST_PEAK: f64 = GOOD_VOLTS[1];
/// Peak from which an amplifier is scaled well, in volts.
const SUFFICIENT_PEAK: f64 = GOOD_VOLTS[0];
/// The round factors of one decade. Neighbours differ by a factor of at most 1.6, so that a peak of at most 95 V can be
/// made larger than 59 V.
const ROUND_FACTORS: [f64; 9] = [1.0, 1.2, 1.5, 2.0, 2.5, 4.0, 5.0, 8.0, 10.0];
/// Smallest factor that is worth a change.
const LEAST_FACTOR: f64 = 1.2;
/// Share of a ratio that counts as its rounding error.
const RATIO_TOLERANCE: f64 = 1e-9;
/// Largest power of ten among the factors.
const LARGEST_DECADE: f64 = 1e12;

/// The smallest round factor by which a peak in volts must be divided to be at most 95 V. It is at least 1.2.
pub(crate) fn reduction(volts: f64) -> f64 {
    let ratio = (volts / LARGEST_PEAK).max(LEAST_FACTOR) * (1.0 - RATIO_TOLERANCE);
    let decade = decade_of(ratio);
    let mut factors = ROUND_FACTORS.iter().map(|factor| factor * decade);
    factors.find(|factor| *factor >= ratio).unwrap_or(10.0 * decade)
}

/// A round factor by which a positive peak in volts can be multiplied to be from 50 to 95 V: a power of ten if one does,
/// and otherwise the largest factor. It is 1 for a peak from 50 V on.
pub(crate) fn enlargement(volts: f64) -> f64 {
    let ratio = (LARGEST_PEAK / volts).max(1.0) * (1.0 + RATIO_TOLERANCE);
    let decade = decade_of(ratio);
    if decade * volts >= SUFFICIENT_PEAK {
        return decade;
    }
    let factors = ROUND_FACTORS.iter().map(|factor| factor * decade);
    factors.filter(|factor| *factor <= ratio).fold(1.0, f64::max)
}

/// The largest power of ten up to a ratio of at least 1.
fn decade_of(ratio: f64) -> f64 {
    let mut decade = 1.0;
    while 10.0 * decade <= ratio && decade < LARGEST_DECADE {
        decade *= 10.0;
    }
    decade
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reduced_peak_is_at_most_95_volts() {
        let cases =
            [(100.1, 1.2), (120.0, 1.5), (245.4, 4.0), (95.0 * 4.0, 4.0), (900.0, 10.0), (1000.0, 12.0)];
        for (volts, factor) in cases {
            assert_eq!(reduction(volts), factor, "{volts} V");
        }
        for exponent in 0..40 {
            let volts = 101.0 * 1.3f64.powi(exponent);
            let reduced = volts / reduction(volts);
            assert!(reduced <= 95.0 + 1e-6 && reduced > 59.0, "{volts} V becomes {reduced} V");
        }
    }

    #[test]
    fn an_enlarged_peak_is_between_50_and_95_volts() {
        let cases = [(4.9, 15.0), (0.721, 100.0), (0.5, 100.0), (1.2, 50.0), (2.0, 40.0), (1e-3, 8e4)];
        for (volts, factor) in cases {
            assert_eq!(enlargement(volts), factor, "{volts} V");
        }
        for exponent in 0..40 {
            let volts = 4.99 / 1.3f64.powi(exponent);
            let enlarged = volts * enlargement(volts);
            assert!((50.0..=95.0 + 1e-6).contains(&enlarged), "{volts} V becomes {enlarged} V");
        }
        assert_eq!([enlargement(80.0), enlargement(100.0)], [1.0, 1.0]);
    }

    #[test]
    fn extreme_peaks_have_factors() {
        assert!(reduction(f64::MAX).is_finite() && enlargement(1e-300).is_finite());
        assert_eq!(reduction(0.0), 1.2);
    }
}
