//! Places that are spread evenly, and have no period: a sequence of low discrepancy.

/// The golden ratio. Of all numbers it is the farthest from ratios of small whole numbers.
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;

/// Place number `index` of the sequence, from 0 to below 1: the fractional part of a multiple of the golden ratio.
///
/// The first places are spread evenly, however many there are. They have no period that could agree with a period of
/// what is sampled, so checks at them do not always meet the same instant of a repetition.
///
/// # Examples
///
/// ```
/// use patchcord_core::low_discrepancy::golden_place;
///
/// let places: Vec<f64> = (0..5).map(golden_place).collect();
/// assert_eq!(places[0], 0.0);
/// // Each fifth of the range has one of the five places.
/// let mut fifths: Vec<u32> = places.iter().map(|place| (5.0 * place) as u32).collect();
/// fifths.sort_unstable();
/// assert_eq!(fifths, [0, 1, 2, 3, 4]);
/// ```
pub fn golden_place(index: u64) -> f64 {
    (GOLDEN_RATIO * index as f64).fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gaps_between_the_first_places_are_similar() {
        for count in [10, 100, 1000] {
            let mut places: Vec<f64> = (0..count).map(golden_place).collect();
            assert!(places.iter().all(|place| (0.0..1.0).contains(place)));
            places.sort_by(f64::total_cmp);
            places.push(1.0);
            let gaps = places.windows(2).map(|pair| (pair[1] - pair[0]) * count as f64);
            let (least, most) = gaps.fold((f64::MAX, 0.0f64), |(a, b), gap| (a.min(gap), b.max(gap)));
            assert!(least > 0.3 && most < 2.0, "{count} places: {least} {most}");
        }
    }
}
