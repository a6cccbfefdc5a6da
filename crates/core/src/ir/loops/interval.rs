//! Interval arithmetic: bounds for the result of an operation while the tear of a loop varies within an interval.
//!
//! The search for the solutions of a loop (`curved`) evaluates the loop on intervals. If the result and the tear have
//! no value in common, the interval contains no solution. Bounds are not rounded outward; the caller adds a margin for
//! rounding.

use crate::ir::number::Number;
use patchcord_expr::Function;

/// All values from `low` to `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    /// The lower bound, which belongs to the interval.
    pub low: f64,
    /// The upper bound, which belongs to the interval.
    pub high: f64,
}

impl Interval {
    /// The interval between two bounds, of which the first must not be above the second.
    pub(super) fn new(low: f64, high: f64) -> Self {
        Interval { low, high }
    }

    /// high - low.
    pub(super) fn width(self) -> f64 {
        self.high - self.low
    }

    /// The midpoint, computed as low plus half of the width.
    pub(super) fn middle(self) -> f64 {
        self.low + 0.5 * self.width()
    }

    /// Whether it contains one value only. Results are then exact.
    fn is_point(self) -> bool {
        self.low == self.high
    }

    /// The smallest interval that contains both.
    pub(super) fn hull(self, other: Self) -> Self {
        Interval { low: self.low.lower_of(other.low), high: self.high.upper_of(other.high) }
    }

    /// The interval that these bounds span. If one bound is NaN, nothing is known: the result is the whole real line.
    fn from_bounds(bounds: [f64; 4]) -> Self {
        if bounds.iter().any(|bound| bound.is_nan()) {
            return Interval::EVERYTHING;
        }
        let low = bounds.iter().copied().fold(f64::INFINITY, f64::min);
        Interval { low, high: bounds.iter().copied().fold(f64::NEG_INFINITY, f64::max) }
    }

    /// The whole real line: nothing is known.
    pub(super) const EVERYTHING: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };
}

/// Each operation gives bounds for all pairs of values of its operands. Operands are treated as independent, so the
/// bounds of a difference x - x are wider than 0.
impl Number for Interval {
    fn constant(value: f64) -> Self {
        Interval { low: value, high: value }
    }
    fn add(self, other: Self) -> Self {
        Interval { low: self.low + other.low, high: self.high + other.high }
    }
    fn subtract(self, other: Self) -> Self {
        Interval { low: self.low - other.high, high: self.high - other.low }
    }
    fn multiply(self, other: Self) -> Self {
        if self.is_point() && other.is_point() {
            return Interval::constant(self.low * other.low);
        }
        let [a, b] = [self, other];
        Interval::from_bounds([a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high])
    }
    fn divide(self, other: Self) -> Self {
        if self.is_point() && other.is_point() {
            return Interval::constant(self.low / other.low);
        }
        if other.low <= 0.0 && other.high >= 0.0 {
            return Interval::EVERYTHING;
        }
        let [a, b] = [self, other];
        Interval::from_bounds([a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high])
    }
    fn lower_of(self, other: Self) -> Self {
        Interval { low: self.low.lower_of(other.low), high: self.high.lower_of(other.high) }
    }
    fn upper_of(self, other: Self) -> Self {
        Interval { low: self.low.upper_of(other.low), high: self.high.upper_of(other.high) }
    }
    fn absolute(self) -> Self {
        let opposite = Interval { low: -self.high, high: -self.low };
        let both = self.upper_of(opposite);
        if self.low < 0.0 && self.high > 0.0 { Interval { low: 0.0, ..both } } else { both }
    }
    fn select(left: Self, right: Self, then: Self, otherwise: Self) -> Self {
        if left.low >= right.high {
            then
        } else if left.high < right.low {
            otherwise
        } else {
            then.hull(otherwise)
        }
    }
    fn call(function: Function, a: Self, b: Self) -> Self {
        if a.is_point() && (b.is_point() || function.argument_count() == 1) {
            return Interval::constant(function.apply(a.low, b.low));
        }
        let (low, high) = function.bounds((a.low, a.high), (b.low, b.high));
        Interval { low, high }
    }
    fn table(self, points: &[[f64; 2]]) -> Self {
        let ends =
            Interval::constant(self.low.table(points)).hull(Interval::constant(self.high.table(points)));
        let corners = points.iter().filter(|point| self.low < point[0] && point[0] < self.high);
        corners.fold(ends, |hull, corner| hull.hull(Interval::constant(corner[1])))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn interval() -> impl Strategy<Value = Interval> {
        (-5.0..5.0f64, 0.0..3.0f64).prop_map(|(low, width)| Interval::new(low, low + width))
    }

    /// Results of all operations on two numbers. The test applies it to intervals and to values inside them.
    fn results<N: Number>(a: N, b: N) -> Vec<N> {
        let points = [[-2.0, 1.0], [0.5, -3.0], [1.0, 4.0], [4.0, 4.0]];
        let two = [N::add, N::subtract, N::multiply, N::divide, N::lower_of, N::upper_of];
        let calls = Function::all().map(|function| N::call(function, a, b));
        two.iter()
            .map(|operation| operation(a, b))
            .chain([a.absolute(), N::select(a, b, b, a), a.table(&points)])
            .chain(calls)
            .collect()
    }

    proptest! {
        #[test]
        fn results_of_inner_values_are_inside_the_result(
            a in interval(), b in interval(), share in 0.0..1.0f64, other in 0.0..1.0f64,
        ) {
            let (x, y) = (a.low + share * a.width(), b.low + other * b.width());
            for (index, (interval, value)) in results(a, b).iter().zip(results(x, y)).enumerate() {
                let slack = 1e-12 * (1.0 + value.abs());
                let inside = interval.low - slack <= value && value <= interval.high + slack;
                prop_assert!(inside || value.is_nan(), "{index}: {value} in {interval:?} for {x} {y}");
            }
        }
    }
}
