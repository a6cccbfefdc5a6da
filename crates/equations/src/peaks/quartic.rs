//! The polynomial of degree 4 through five equally spaced values.

/// Number of intervals between five values.
pub(super) const INTERVALS: usize = 4;
/// Values over a step at equal distances, those at its ends included.
pub(super) type Values = [f64; INTERVALS + 1];
/// Number of intervals in which the largest value of a polynomial is searched.
const POINTS: usize = 32;

/// The polynomial through the values, after a share (0 ... 1) of the step.
pub(super) fn quartic(values: &Values, share: f64) -> f64 {
    let [a, b, c, d, e] = *values;
    let at = INTERVALS as f64 * share;
    // Newton's form with forward differences.
    let (first, second) = (b - a, c - 2.0 * b + a);
    let third = d - 3.0 * c + 3.0 * b - a;
    let fourth = e - 4.0 * d + 6.0 * c - 4.0 * b + a;
    let inner = second + (at - 2.0) / 3.0 * (third + (at - 3.0) / 4.0 * fourth);
    a + at * (first + (at - 1.0) / 2.0 * inner)
}

/// The share of the step at which the polynomial through the values is largest; `None` if that is at an end.
pub(super) fn largest_within(values: &Values) -> Option<f64> {
    let points: [f64; POINTS + 1] =
        std::array::from_fn(|point| quartic(values, point as f64 / POINTS as f64));
    let best = (0..=POINTS).max_by(|one, other| points[*one].total_cmp(&points[*other]))?;
    if best == 0 || best == POINTS {
        return None;
    }
    // The vertex of the parabola through the largest point and its neighbours.
    let [before, largest, after] = [best - 1, best, best + 1].map(|point| points[point]);
    let curvature = before - 2.0 * largest + after;
    let shift = if curvature < 0.0 { 0.5 * (before - after) / curvature } else { 0.0 };
    Some((best as f64 + shift) / POINTS as f64)
}
