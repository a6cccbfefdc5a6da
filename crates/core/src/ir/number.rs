//! The arithmetic that operations need, for plain numbers and for dual numbers.
//!
//! One implementation of the operations serves several number types. Plain numbers give voltages, dual numbers give
//! derivatives. Intervals and bounds of slopes, in `loops`, give the solutions of loops.

use patchcord_expr::Function;

/// A type that operations can compute with. If two compared values are equal, the derivatives decide which one is
/// chosen.
pub(crate) trait Number: Copy {
    /// A number that does not vary.
    fn constant(value: f64) -> Self;
    /// self + other.
    fn add(self, other: Self) -> Self;
    /// self - other.
    fn subtract(self, other: Self) -> Self;
    /// self x other.
    fn multiply(self, other: Self) -> Self;
    /// self / other.
    fn divide(self, other: Self) -> Self;
    /// The smaller of two.
    fn lower_of(self, other: Self) -> Self;
    /// The larger of two.
    fn upper_of(self, other: Self) -> Self;
    /// The absolute value.
    fn absolute(self) -> Self;
    /// `then` if left >= right, otherwise `otherwise`.
    fn select(left: Self, right: Self, then: Self, otherwise: Self) -> Self;
    /// A function of one or two arguments.
    fn call(function: Function, a: Self, b: Self) -> Self;
    /// The value of a table of points (abscissa, ordinate) at this abscissa.
    fn table(self, points: &[[f64; 2]]) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn subtract(self, other: Self) -> Self {
        self - other
    }
    #[inline(always)]
    fn multiply(self, other: Self) -> Self {
        self * other
    }
    #[inline(always)]
    fn divide(self, other: Self) -> Self {
        self / other
    }
    // A NaN on the left is returned, so a limit never hides it.
    #[inline(always)]
    fn lower_of(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    #[inline(always)]
    fn upper_of(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    #[inline(always)]
    fn absolute(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn select(left: Self, right: Self, then: Self, otherwise: Self) -> Self {
        if left >= right { then } else { otherwise }
    }
    fn call(function: Function, a: Self, b: Self) -> Self {
        function.apply(a, b)
    }
    fn table(self, points: &[[f64; 2]]) -> Self {
        let (value, slope, origin) = segment(points, self);
        value + slope * (self - origin)
    }
}

/// The straight segment of a table that applies at `x`: ordinate at the origin, slope, origin. Outside the points the
/// slope is 0.
pub(crate) fn segment(points: &[[f64; 2]], x: f64) -> (f64, f64, f64) {
    segment_after(points, points.partition_point(|point| point[0] <= x))
}

/// The segment after the first `after` points of a table, in the same form.
pub(crate) fn segment_after(points: &[[f64; 2]], after: usize) -> (f64, f64, f64) {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return (f64::NAN, 0.0, 0.0);
    };
    if after == 0 {
        return (first[1], 0.0, first[0]);
    }
    if after == points.len() {
        return (last[1], 0.0, last[0]);
    }
    let ([x0, y0], [x1, y1]) = (points[after - 1], points[after]);
    (y0, (y1 - y0) / (x1 - x0), x0)
}

/// A number with its derivative along one direction. At a kink it is the one-sided derivative in that direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dual {
    /// The number.
    pub value: f64,
    /// Its derivative along the direction.
    pub slope: f64,
}

impl Dual {
    /// A number with its derivative.
    pub(super) fn new(value: f64, slope: f64) -> Self {
        Dual { value, slope }
    }

    /// Whether the value is smaller, or is equal and becomes smaller along the direction.
    fn is_below(self, other: Self) -> bool {
        self.value < other.value || (self.value == other.value && self.slope < other.slope)
    }
}

/// The rules of differentiation. At a kink, the slopes decide which side applies.
impl Number for Dual {
    fn constant(value: f64) -> Self {
        Dual::new(value, 0.0)
    }
    fn add(self, other: Self) -> Self {
        Dual::new(self.value + other.value, self.slope + other.slope)
    }
    fn subtract(self, other: Self) -> Self {
        Dual::new(self.value - other.value, self.slope - other.slope)
    }
    fn multiply(self, other: Self) -> Self {
        Dual::new(self.value * other.value, self.slope * other.value + self.value * other.slope)
    }
    fn divide(self, other: Self) -> Self {
        let value = self.value / other.value;
        Dual::new(value, (self.slope - value * other.slope) / other.value)
    }
    fn lower_of(self, other: Self) -> Self {
        if other.is_below(self) { other } else { self }
    }
    fn upper_of(self, other: Self) -> Self {
        if self.is_below(other) { other } else { self }
    }
    fn absolute(self) -> Self {
        let zero = Dual::constant(0.0);
        if self.is_below(zero) { zero.subtract(self) } else { self }
    }
    fn select(left: Self, right: Self, then: Self, otherwise: Self) -> Self {
        if left.value >= right.value && !left.is_below(right) { then } else { otherwise }
    }
    fn call(function: Function, a: Self, b: Self) -> Self {
        let (by_a, by_b) = function.derivative(a.value, b.value);
        // A constant has slope 0 even if the function is infinitely steep.
        let along = |steepness: f64, slope: f64| if slope == 0.0 { 0.0 } else { steepness * slope };
        // A function of one argument does not depend on the second one.
        let second = if function.argument_count() > 1 { along(by_b, b.slope) } else { 0.0 };
        Dual::new(function.apply(a.value, b.value), along(by_a, a.slope) + second)
    }
    fn table(self, points: &[[f64; 2]]) -> Self {
        let (value, slope, origin) = segment(points, self.value);
        let segment_slope = if self.slope < 0.0 { segment(points, self.value.next_down()).1 } else { slope };
        Dual::new(value + slope * (self.value - origin), segment_slope * self.slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_does_not_hide_a_nan() {
        assert!(f64::NAN.lower_of(100.0).upper_of(-100.0).is_nan());
    }

    #[test]
    fn tables_are_level_outside_and_straight_inside() {
        let points = [[0.0, 1.0], [1.0, 3.0], [3.0, -1.0]];
        let cases = [(-1.0, 1.0), (0.0, 1.0), (0.5, 2.0), (1.0, 3.0), (2.0, 1.0), (9.0, -1.0)];
        assert!(cases.iter().all(|&(x, y)| Number::table(x, &points) == y));
    }

    #[test]
    fn duals_follow_the_rules_of_calculus() {
        let x = Dual::new(3.0, 1.0);
        let square = x.multiply(x);
        assert_eq!(square, Dual::new(9.0, 6.0));
        assert_eq!(Dual::constant(1.0).divide(square).slope, -6.0 / 81.0);
        assert_eq!(Dual::constant(-2.0).multiply(x).absolute().slope, 2.0);
    }

    #[test]
    fn at_a_kink_duals_have_the_slope_ahead() {
        let zero = Dual::constant(0.0);
        let corner = [[-1.0, 3.0], [0.0, 0.0], [1.0, 2.0]];
        for (direction, table) in [(1.0, 2.0), (-1.0, 3.0)] {
            let x = Dual::new(0.0, direction);
            let lower = if direction < 0.0 { direction } else { 0.0 };
            assert_eq!(x.absolute().slope, 1.0);
            assert_eq!((x.lower_of(zero).slope, zero.lower_of(x).slope), (lower, lower));
            assert_eq!(
                (x.upper_of(zero).slope, zero.upper_of(x).slope),
                (direction - lower, direction - lower)
            );
            // A dead zone of width 0 has no kink.
            assert_eq!(x.upper_of(zero).add(x.lower_of(zero)).slope, direction);
            assert_eq!(Dual::select(x, zero, x, zero).slope, direction - lower);
            assert_eq!(Number::table(x, &corner).slope, table);
        }
    }
}
