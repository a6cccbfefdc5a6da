//! A number that may lie anywhere between two: what an operation can give for a whole stretch of a loop's tear.

use super::number::Number;
use patchcord_expr::Function;

/// Everything from low to high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub low: f64,
    pub high: f64,
}

impl Range {
    pub fn new(low: f64, high: f64) -> Self {
        Range { low, high }
    }

    pub fn width(self) -> f64 {
        self.high - self.low
    }

    pub fn middle(self) -> f64 {
        self.low + 0.5 * self.width()
    }

    fn is_point(self) -> bool {
        self.low == self.high
    }

    /// The smallest range that holds both.
    pub fn hull(self, other: Self) -> Self {
        Range { low: self.low.lower_of(other.low), high: self.high.upper_of(other.high) }
    }

    /// Where only the bounds themselves are known to be met: not a number means anything at all.
    fn of(bounds: [f64; 4]) -> Self {
        if bounds.iter().any(|bound| bound.is_nan()) {
            return Range::ANYTHING;
        }
        let low = bounds.iter().copied().fold(f64::INFINITY, f64::min);
        Range { low, high: bounds.iter().copied().fold(f64::NEG_INFINITY, f64::max) }
    }

    const ANYTHING: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
}

impl Number for Range {
    fn constant(value: f64) -> Self {
        Range { low: value, high: value }
    }
    fn add(self, other: Self) -> Self {
        Range { low: self.low + other.low, high: self.high + other.high }
    }
    fn subtract(self, other: Self) -> Self {
        Range { low: self.low - other.high, high: self.high - other.low }
    }
    fn multiply(self, other: Self) -> Self {
        if self.is_point() && other.is_point() {
            return Range::constant(self.low * other.low);
        }
        let [a, b] = [self, other];
        Range::of([a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high])
    }
    fn divide(self, other: Self) -> Self {
        if self.is_point() && other.is_point() {
            return Range::constant(self.low / other.low);
        }
        if other.low <= 0.0 && other.high >= 0.0 {
            return Range::ANYTHING;
        }
        let [a, b] = [self, other];
        Range::of([a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high])
    }
    fn lower_of(self, other: Self) -> Self {
        Range { low: self.low.lower_of(other.low), high: self.high.lower_of(other.high) }
    }
    fn upper_of(self, other: Self) -> Self {
        Range { low: self.low.upper_of(other.low), high: self.high.upper_of(other.high) }
    }
    fn absolute(self) -> Self {
        let opposite = Range { low: -self.high, high: -self.low };
        let both = self.upper_of(opposite);
        if self.low < 0.0 && self.high > 0.0 { Range { low: 0.0, ..both } } else { both }
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
        if a.is_point() && (b.is_point() || function.arguments() == 1) {
            return Range::constant(function.apply(a.low, b.low));
        }
        let (low, high) = function.over((a.low, a.high), (b.low, b.high));
        Range { low, high }
    }
    fn table(self, points: &[[f64; 2]]) -> Self {
        let ends = Range::constant(self.low.table(points)).hull(Range::constant(self.high.table(points)));
        let corners = points.iter().filter(|point| self.low < point[0] && point[0] < self.high);
        corners.fold(ends, |hull, corner| hull.hull(Range::constant(corner[1])))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn range() -> impl Strategy<Value = Range> {
        (-5.0..5.0f64, 0.0..3.0f64).prop_map(|(low, width)| Range::new(low, low + width))
    }

    /// What can be made of two numbers; the same for ranges and for what lies in them.
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
        fn what_lies_in_the_ranges_gives_what_lies_in_the_result(
            a in range(), b in range(), share in 0.0..1.0f64, other in 0.0..1.0f64,
        ) {
            let (x, y) = (a.low + share * a.width(), b.low + other * b.width());
            for (index, (range, value)) in results(a, b).iter().zip(results(x, y)).enumerate() {
                let slack = 1e-12 * (1.0 + value.abs());
                let inside = range.low - slack <= value && value <= range.high + slack;
                prop_assert!(inside || value.is_nan(), "{index}: {value} in {range:?} for {x} {y}");
            }
        }
    }
}
