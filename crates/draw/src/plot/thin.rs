/// Thins a long record of which x never turns back, for a picture `columns`
/// pixels wide whose edges are at `low` and `high`: of each pixel column the
/// first, lowest, highest and last point stay, in their order, so that no spike
/// vanishes. Of neighbouring points that are not finite one stays.
pub fn thin(points: &[(f64, f64)], low: f64, high: f64, columns: usize) -> Vec<(f64, f64)> {
    let column = |point: &(f64, f64)| column_of(*point, low, high, columns);
    let mut kept = Vec::new();
    for chunk in points.chunk_by(|one, next| column(one) == column(next)) {
        keep_extremes(chunk, &mut kept);
    }
    kept
}

/// Drops points that lie in the same pixel as the point before them, a pixel
/// being `pixel.0` wide and `pixel.1` high in the units of the points. Good for
/// curves that turn back. Of neighbouring points that are not finite one stays;
/// with a pixel that has no positive size all points stay.
pub fn drop_repeats(points: &[(f64, f64)], pixel: (f64, f64)) -> Vec<(f64, f64)> {
    let mut kept = points.to_vec();
    if pixel.0 > 0.0 && pixel.1 > 0.0 {
        kept.dedup_by_key(|point| {
            is_finite(*point).then(|| ((point.0 / pixel.0).floor(), (point.1 / pixel.1).floor()))
        });
    }
    kept
}

/// Whether x goes one way all along.
pub(super) fn is_one_way(points: &[(f64, f64)]) -> bool {
    points.is_sorted_by(|one, next| one.0 <= next.0) || points.is_sorted_by(|one, next| one.0 >= next.0)
}

/// Whether a point can be drawn.
pub(super) fn is_finite(point: (f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// The pixel column of a point; all points beyond an edge share one column.
fn column_of(point: (f64, f64), low: f64, high: f64, columns: usize) -> Option<i64> {
    let columns = columns as f64;
    let position = (point.0 - low) / (high - low) * columns;
    is_finite(point).then(|| position.floor().clamp(-1.0, columns) as i64)
}

/// Keeps what a column of points shows; a chunk that starts with a gap is one.
fn keep_extremes(chunk: &[(f64, f64)], kept: &mut Vec<(f64, f64)>) {
    let gap = chunk.first().is_some_and(|point| !is_finite(*point));
    let by_height = |one: &usize, other: &usize| chunk[*one].1.total_cmp(&chunk[*other].1);
    let indices = 0..if gap { 1 } else { chunk.len() };
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
    fn a_lone_spike_survives() {
        let mut points = record(100_000);
        points[54_321].1 = 9.0;
        points[54_400].1 = -7.0;
        let kept = thin(&points, 0.0, 1.0, 500);
        assert!(kept.len() <= 4 * 500);
        assert!(kept.contains(&points[54_321]) && kept.contains(&points[54_400]));
    }

    #[test]
    fn order_and_ends_stay() {
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
    fn gaps_stay_gaps() {
        let mut points = record(1000);
        points[300].1 = f64::NAN;
        points[301].1 = f64::INFINITY;
        let gaps = |list: &[(f64, f64)]| list.iter().filter(|p| !is_finite(**p)).count();
        assert_eq!(gaps(&thin(&points, 0.0, 1.0, 10)), 1);
        assert_eq!(gaps(&drop_repeats(&points, (0.1, 0.1))), 1);
    }

    #[test]
    fn odd_requests_are_survived() {
        assert!(thin(&[], 0.0, 1.0, 10).is_empty());
        assert!(drop_repeats(&[], (1.0, 1.0)).is_empty());
        let points = record(100);
        assert!(!thin(&points, 1.0, 1.0, 10).is_empty());
        assert!(!thin(&points, f64::NAN, 1.0, 0).is_empty());
        assert_eq!(drop_repeats(&points, (0.0, f64::NAN)), points);
    }

    #[test]
    fn a_curve_that_turns_back_loses_only_repeats() {
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
        assert!(is_one_way(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]));
        assert!(is_one_way(&[(1.0, 0.0), (0.0, 0.0)]));
        assert!(!is_one_way(&[(1.0, 0.0), (0.0, 0.0), (0.5, 0.0)]));
    }
}
