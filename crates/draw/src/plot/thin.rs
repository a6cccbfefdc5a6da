//! Thins long records of points to what a picture can show.

/// Thins a record with monotonic x for a picture that is `columns` pixels wide.
///
/// `low` and `high` are the x values at the edges of the picture. In each pixel column the first,
/// lowest, highest and last points are kept in their order, so spikes stay visible. Of consecutive
/// points that are not finite one is kept.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::thin;
///
/// let mut points: Vec<(f64, f64)> = (0..10_000).map(|index| (f64::from(index) / 10_000.0, 0.0)).collect();
/// points[5_000].1 = 9.0;
/// let kept = thin(&points, 0.0, 1.0, 100);
/// assert!(kept.len() <= 4 * 100);
/// assert!(kept.contains(&(0.5, 9.0)), "the spike is kept");
/// ```
pub fn thin(points: &[(f64, f64)], low: f64, high: f64, columns: usize) -> Vec<(f64, f64)> {
    let column = |point: &(f64, f64)| column_of(*point, low, high, columns);
    let mut kept = Vec::new();
    for chunk in points.chunk_by(|one, next| column(one) == column(next)) {
        keep_extremes(chunk, &mut kept);
    }
    kept
}

/// Drops each point that is in the same pixel as the point before it.
///
/// `pixel` is the width and height of a pixel in the units of the points. This suits curves whose x
/// is not monotonic. Of consecutive points that are not finite one is kept. If the size of the pixel
/// is not positive, all points are kept.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::drop_repeats;
///
/// let points = [(0.0, 0.0), (0.2, 0.3), (1.5, 0.0)];
/// assert_eq!(drop_repeats(&points, (1.0, 1.0)), [(0.0, 0.0), (1.5, 0.0)]);
/// ```
pub fn drop_repeats(points: &[(f64, f64)], pixel: (f64, f64)) -> Vec<(f64, f64)> {
    let mut kept = points.to_vec();
    if pixel.0 > 0.0 && pixel.1 > 0.0 {
        kept.dedup_by_key(|point| {
            is_finite(*point).then(|| ((point.0 / pixel.0).floor(), (point.1 / pixel.1).floor()))
        });
    }
    kept
}

/// Whether x never decreases or never increases.
pub(super) fn is_monotonic(points: &[(f64, f64)]) -> bool {
    points.is_sorted_by(|one, next| one.0 <= next.0) || points.is_sorted_by(|one, next| one.0 >= next.0)
}

/// Whether both coordinates are finite.
pub(super) fn is_finite(point: (f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Returns the pixel column of a point; `None` if the point is not finite.
///
/// All points beyond an edge share one column.
fn column_of(point: (f64, f64), low: f64, high: f64, columns: usize) -> Option<i64> {
    let columns = columns as f64;
    let position = (point.0 - low) / (high - low) * columns;
    is_finite(point).then(|| position.floor().clamp(-1.0, columns) as i64)
}

/// Keeps the first, lowest, highest and last points of a column.
///
/// If the first point is not finite, no point of the chunk is, and only the first is kept.
fn keep_extremes(chunk: &[(f64, f64)], kept: &mut Vec<(f64, f64)>) {
    let is_gap = chunk.first().is_some_and(|point| !is_finite(*point));
    let by_height = |one: &usize, other: &usize| chunk[*one].1.total_cmp(&chunk[*other].1);
    let indices = 0..if is_gap { 1 } else { chunk.len() };
    let lowest = indices.clone().min_by(by_height);
    let highest = indices.clone().max_by(by_height);
    let mut chosen: Vec<usize> =
        [indices.clone().next(), lowest, highest, indices.last()].into_iter().flatten().collect();
    chosen.sort_unstable();
    chosen.dedup();
    kept.extend(chosen.into_iter().map(|index| chunk[index]));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(length: usize) -> Vec<(f64, f64)> {
        (0..length).map(|n| (n as f64 / length as f64, (n as f64 * 0.7).sin())).collect()
    }

    #[test]
    fn a_single_spike_is_kept() {
        let mut points = record(100_000);
        points[54_321].1 = 9.0;
        points[54_400].1 = -7.0;
        let kept = thin(&points, 0.0, 1.0, 500);
        assert!(kept.len() <= 4 * 500);
        assert!(kept.contains(&points[54_321]) && kept.contains(&points[54_400]));
    }

    #[test]
    fn order_and_ends_are_kept() {
        let points = record(10_000);
        let kept = thin(&points, 0.0, 1.0, 100);
        assert!(kept.is_sorted_by(|one, next| one.0 < next.0));
        assert_eq!(kept.first(), points.first());
        assert_eq!(kept.last(), points.last());
    }

    #[test]
    fn every_column_keeps_its_extremes() {
        let points = record(10_000);
        let kept = thin(&points, 0.0, 1.0, 50);
        for column in 0..50 {
            let inside = |p: &&(f64, f64)| (p.0 * 50.0).floor() == f64::from(column);
            let heights = |list: &[(f64, f64)]| {
                let values: Vec<f64> = list.iter().filter(inside).map(|p| p.1).collect();
                let low = values.iter().copied().fold(f64::INFINITY, f64::min);
                let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                (low, high)
            };
            assert_eq!(heights(&kept), heights(&points));
        }
    }

    #[test]
    fn gaps_are_kept() {
        let mut points = record(1000);
        points[300].1 = f64::NAN;
        points[301].1 = f64::INFINITY;
        let gaps = |list: &[(f64, f64)]| list.iter().filter(|p| !is_finite(**p)).count();
        assert_eq!(gaps(&thin(&points, 0.0, 1.0, 10)), 1);
        assert_eq!(gaps(&drop_repeats(&points, (0.1, 0.1))), 1);
    }

    #[test]
    fn degenerate_arguments_are_accepted() {
        assert!(thin(&[], 0.0, 1.0, 10).is_empty());
        assert!(drop_repeats(&[], (1.0, 1.0)).is_empty());
        let points = record(100);
        assert!(!thin(&points, 1.0, 1.0, 10).is_empty());
        assert!(!thin(&points, f64::NAN, 1.0, 0).is_empty());
        assert_eq!(drop_repeats(&points, (0.0, f64::NAN)), points);
    }

    #[test]
    fn a_closed_curve_loses_only_repeats() {
        let circle: Vec<(f64, f64)> = (0..100_000)
            .map(|n| f64::from(n) / 100_000.0 * std::f64::consts::TAU)
            .map(|angle| (angle.cos(), angle.sin()))
            .collect();
        let kept = drop_repeats(&circle, (0.01, 0.01));
        assert!(kept.len() < 2000);
        assert!(kept.iter().any(|p| p.1 > 0.99) && kept.iter().any(|p| p.1 < -0.99));
    }

    #[test]
    fn direction_of_x_is_recognised() {
        assert!(is_monotonic(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]));
        assert!(is_monotonic(&[(1.0, 0.0), (0.0, 0.0)]));
        assert!(!is_monotonic(&[(1.0, 0.0), (0.0, 0.0), (0.5, 0.0)]));
    }
}
