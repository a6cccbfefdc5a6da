//! Bounds for a value and its slope while the tears of a loop vary within intervals.
//!
//! The slope is the set of all slopes between two points: at a kink it contains the slopes of both sides. So the
//! difference of two values is the difference of their arguments times some number in it.

use super::interval::Interval;
use crate::ir::number::Number;
use patchcord_expr::Function;

/// Bounds of a value and of its slope along one tear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    /// Bounds of the value.
    pub value: Interval,
    /// Bounds of the slope.
    pub slope: Interval,
}

impl Bounds {
    /// Bounds of a value that does not depend on the tear.
    pub(super) fn fixed(value: Interval) -> Self {
        Bounds { value, slope: Interval::constant(0.0) }
    }

    /// Bounds of the tear itself.
    pub(super) fn moving(value: Interval) -> Self {
        Bounds { value, slope: Interval::constant(1.0) }
    }

    /// Bounds of what is one of two, with the slopes of both.
    fn either(value: Interval, one: Self, other: Self) -> Self {
        Bounds { value, slope: one.slope.hull(other.slope) }
    }

    /// Whether the slope is exactly 0.
    pub(super) fn is_level(self) -> bool {
        self.slope == Interval::constant(0.0)
    }
}

/// The product of two intervals. A factor that is exactly 0 gives 0, even if nothing is known of the other.
fn product(a: Interval, b: Interval) -> Interval {
    let zero = Interval::constant(0.0);
    if a == zero || b == zero { zero } else { a.multiply(b) }
}

impl Number for Bounds {
    fn constant(value: f64) -> Self {
        Bounds::fixed(Interval::constant(value))
    }
    fn add(self, other: Self) -> Self {
        Bounds { value: self.value.add(other.value), slope: self.slope.add(other.slope) }
    }
    fn subtract(self, other: Self) -> Self {
        Bounds { value: self.value.subtract(other.value), slope: self.slope.subtract(other.slope) }
    }
    fn multiply(self, other: Self) -> Self {
        let slope = product(self.slope, other.value).add(product(self.value, other.slope));
        Bounds { value: product(self.value, other.value), slope }
    }
    fn divide(self, other: Self) -> Self {
        let value = self.value.divide(other.value);
        let change = self.slope.subtract(product(value, other.slope));
        let slope = if change == Interval::constant(0.0) { change } else { change.divide(other.value) };
        Bounds { value, slope }
    }
    fn lower_of(self, other: Self) -> Self {
        if self.value.high <= other.value.low {
            self
        } else if other.value.high <= self.value.low {
            other
        } else {
            Bounds::either(self.value.lower_of(other.value), self, other)
        }
    }
    fn upper_of(self, other: Self) -> Self {
        if self.value.low >= other.value.high {
            self
        } else if other.value.low >= self.value.high {
            other
        } else {
            Bounds::either(self.value.upper_of(other.value), self, other)
        }
    }
    fn absolute(self) -> Self {
        let opposite = Bounds::constant(0.0).subtract(self);
        Bounds { value: self.value.absolute(), ..self.upper_of(opposite) }
    }
    fn select(left: Self, right: Self, then: Self, otherwise: Self) -> Self {
        let value = Interval::select(left.value, right.value, then.value, otherwise.value);
        if left.value.low >= right.value.high {
            then
        } else if left.value.high < right.value.low {
            otherwise
        } else if left.is_level() && right.is_level() {
            Bounds::either(value, then, otherwise)
        } else {
            // The value jumps.
            Bounds { value, slope: Interval::EVERYTHING }
        }
    }
    fn call(function: Function, a: Self, b: Self) -> Self {
        let value = Interval::call(function, a.value, b.value);
        let slope = if function.argument_count() == 1 {
            let (low, high) = function.slope_bounds((a.value.low, a.value.high));
            product(Interval::new(low, high), a.slope)
        } else if a.is_level() && b.is_level() {
            Interval::constant(0.0)
        } else {
            Interval::EVERYTHING
        };
        Bounds { value, slope }
    }
    fn table(self, points: &[[f64; 2]]) -> Self {
        let value = Number::table(self.value, points);
        let level = Interval::constant(0.0);
        let is_outside = match (points.first(), points.last()) {
            (Some(first), Some(last)) => self.value.low < first[0] || self.value.high > last[0],
            _ => true,
        };
        let segments =
            points.windows(2).filter(|pair| self.value.low <= pair[1][0] && pair[0][0] <= self.value.high);
        let slopes = segments.map(|pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]));
        let slopes = slopes.map(Interval::constant).chain(is_outside.then_some(level));
        let all = slopes.reduce(Interval::hull).unwrap_or(level);
        Bounds { value, slope: product(all, self.slope) }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Results of all operations on a number and a second one that depends on it.
    fn results<N: Number>(x: N) -> Vec<N> {
        let points = [[-2.0, 1.0], [0.5, -3.0], [1.0, 4.0], [4.0, 4.0]];
        let y = x.multiply(x).subtract(N::constant(2.0));
        let four = [N::add, N::subtract, N::multiply, N::divide, N::lower_of, N::upper_of];
        let calls = Function::all().map(|function| N::call(function, x, y));
        four.iter()
            .map(|operation| operation(x, y))
            .chain([x.absolute(), y.absolute(), x.table(&points), y.table(&points)])
            .chain(calls)
            .collect()
    }

    proptest! {
        #[test]
        fn slopes_between_inner_points_are_inside_the_bounds(
            low in -5.0..5.0f64, width in 0.0..3.0f64, one in 0.0..1.0f64, other in 0.0..1.0f64,
        ) {
            prop_assume!((one - other).abs() > 1e-3 && width > 1e-3);
            let [x, z] = [low + one * width, low + other * width];
            let bounds = results(Bounds::moving(Interval::new(low, low + width)));
            for (index, ((bounds, at_x), at_z)) in bounds.iter().zip(results(x)).zip(results(z)).enumerate() {
                let slope = (at_x - at_z) / (x - z);
                let slack = 1e-6 * (1.0 + slope.abs());
                let is_inside = bounds.slope.low - slack <= slope && slope <= bounds.slope.high + slack;
                prop_assert!(is_inside || slope.is_nan(), "{index}: {slope} in {bounds:?} for {x} {z}");
            }
        }
    }
}
