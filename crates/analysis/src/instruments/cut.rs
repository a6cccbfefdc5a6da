//! Sections and values of a sampled signal between its samples, by linear interpolation.

/// A time in seconds and the value at that time.
pub(super) type Point = (f64, f64);

/// The part of a signal between two times inside it. Both ends are interpolated and are points of the result.
pub(super) fn cut(time: &[f64], values: &[f64], [begin, end]: [f64; 2]) -> Vec<Point> {
    let first = time.partition_point(|instant| *instant <= begin);
    let last = time.partition_point(|instant| *instant < end);
    let within = time[first..last].iter().copied().zip(values[first..last].iter().copied());
    let ends = [begin, end].map(|instant| (instant, at(time, values, instant)));
    [ends[0]].into_iter().chain(within).chain([ends[1]]).collect()
}

/// The value at a time inside the signal, interpolated linearly. Needs at least two samples.
pub(super) fn at(time: &[f64], values: &[f64], instant: f64) -> f64 {
    let after = time.partition_point(|sample| *sample < instant).clamp(1, time.len() - 1);
    let share = (instant - time[after - 1]) / (time[after] - time[after - 1]);
    values[after - 1] + share * (values[after] - values[after - 1])
}

/// The time average of the polyline through these points.
pub(super) fn mean(points: &[Point]) -> f64 {
    let area: f64 =
        points.windows(2).map(|pair| (pair[1].0 - pair[0].0) * 0.5 * (pair[0].1 + pair[1].1)).sum();
    area / (points[points.len() - 1].0 - points[0].0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_includes_both_interpolated_ends() {
        let (time, values) = ([0.0, 1.0, 2.0, 3.0], [0.0, 2.0, 0.0, -4.0]);
        let part = cut(&time, &values, [0.5, 2.25]);
        assert_eq!(part, [(0.5, 1.0), (1.0, 2.0), (2.0, 0.0), (2.25, -1.0)]);
        assert_eq!(mean(&part), (0.75 + 1.0 - 0.125) / 1.75);
        assert_eq!(cut(&time, &values, [0.0, 3.0]), [(0.0, 0.0), (1.0, 2.0), (2.0, 0.0), (3.0, -4.0)]);
    }
}
