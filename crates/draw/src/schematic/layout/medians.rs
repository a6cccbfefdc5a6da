//! Isotonic regression in the sum of absolute deviations.
//!
//! Each item of a layer has preferred heights with weights. The heights of all items must ascend in the
//! order of the layer. The best heights are weighted medians of blocks of neighbouring items.

/// A preferred height of an item and its weight.
pub(super) type Preference = (f64, f64);

/// Returns ascending heights with the smallest weighted sum of distances to the preferred heights.
///
/// Items that would pass each other form one block at the weighted median of their preferred heights
/// (pool adjacent violators).
pub(super) fn ascending_medians(preferences: Vec<Vec<Preference>>) -> Vec<f64> {
    let mut blocks: Vec<(Vec<Preference>, usize, f64)> = Vec::new();
    for mut block in preferences {
        let mut count = 1;
        let mut height = median(&mut block);
        while let Some((mut upper, upper_count, _)) = blocks.pop_if(|(.., above)| *above > height) {
            upper.append(&mut block);
            block = upper;
            count += upper_count;
            height = median(&mut block);
        }
        blocks.push((block, count, height));
    }
    blocks.into_iter().flat_map(|(_, count, height)| std::iter::repeat_n(height, count)).collect()
}

/// Returns the lower weighted median.
fn median(preferences: &mut [Preference]) -> f64 {
    preferences.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = preferences.iter().map(|(_, weight)| weight).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let found = preferences.iter().find(|(_, weight)| {
        sum += weight;
        sum >= half
    });
    found.map_or(0.0, |(height, _)| *height)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_at_the_median_of_their_preferences() {
        let prefer = |heights: &[f64]| heights.iter().map(|height| (*height, 1.0)).collect::<Vec<_>>();
        assert_eq!(ascending_medians(vec![prefer(&[1.0]), prefer(&[5.0])]), [1.0, 5.0]);
        assert_eq!(ascending_medians(vec![prefer(&[5.0, 5.0]), prefer(&[1.0])]), [5.0, 5.0]);
        let heights = ascending_medians(vec![
            prefer(&[3.0]),
            prefer(&[9.0]),
            prefer(&[2.0, 2.0, 2.0]),
            prefer(&[10.0]),
        ]);
        assert_eq!(heights, [2.0, 2.0, 2.0, 10.0]);
    }
}
