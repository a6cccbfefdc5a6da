//! Linear pieces: the value of an operation as the tear of a loop increases, up to the next kink.

use super::number::{Number, segment};
use patchcord_expr::Function;

/// Least distance, in volts, by which the search for solutions of a loop advances.
pub(crate) const MIN_PIECE: f64 = 1e-9;

/// The function value + slope x s for s from 0 to reach, in volts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LinearPiece {
    /// Value at s = 0.
    pub value: f64,
    /// Slope with respect to the tear.
    pub slope: f64,
    /// Largest s for which the function is linear.
    pub reach: f64,
    /// Whether the function is linear. It is not if a product or a function of two varying values went into it.
    pub is_straight: bool,
}

impl LinearPiece {
    /// A value that does not depend on the tear.
    pub(crate) fn constant(value: f64) -> Self {
        LinearPiece { value, slope: 0.0, reach: f64::INFINITY, is_straight: true }
    }

    /// A result of two pieces, which is linear as far as both are.
    fn with(self, other: Self, value: f64, slope: f64) -> Self {
        LinearPiece {
            value,
            slope,
            reach: self.reach.min(other.reach),
            is_straight: self.is_straight && other.is_straight,
        }
    }

    /// A result that is linear only if both operands are constant.
    fn bent(self, other: Self, value: f64) -> Self {
        let is_moving = self.slope != 0.0 || other.slope != 0.0;
        let both = self.with(other, value, 0.0);
        LinearPiece { is_straight: both.is_straight && !is_moving, ..both }
    }

    /// Whether the value is at least 0 just to the right.
    fn is_up(self) -> bool {
        self.value > 0.0 || (self.value == 0.0 && self.slope >= 0.0)
    }

    /// Distance to the right at which the value changes its sign; infinite if it does not.
    fn zero_ahead(self) -> f64 {
        let distance = -self.value / self.slope;
        if distance > 0.0 { distance } else { f64::INFINITY }
    }

    /// The same piece, ending at the latest where a tested piece changes its sign.
    fn shortened(self, test: Self) -> Self {
        let reach = self.reach.min(test.reach).min(test.zero_ahead());
        LinearPiece { reach, is_straight: self.is_straight && test.is_straight, ..self }
    }
}

impl Number for LinearPiece {
    fn constant(value: f64) -> Self {
        LinearPiece::constant(value)
    }
    fn add(self, other: Self) -> Self {
        self.with(other, self.value + other.value, self.slope + other.slope)
    }
    fn subtract(self, other: Self) -> Self {
        self.with(other, self.value - other.value, self.slope - other.slope)
    }
    fn multiply(self, other: Self) -> Self {
        let slope = self.slope * other.value + self.value * other.slope;
        let product = self.with(other, self.value * other.value, slope);
        LinearPiece {
            is_straight: product.is_straight && (self.slope == 0.0 || other.slope == 0.0),
            ..product
        }
    }
    fn divide(self, other: Self) -> Self {
        let quotient = self.with(other, self.value / other.value, self.slope / other.value);
        LinearPiece { is_straight: quotient.is_straight && other.slope == 0.0, ..quotient }
    }
    fn lower_of(self, other: Self) -> Self {
        LinearPiece::select(self, other, other, self)
    }
    fn upper_of(self, other: Self) -> Self {
        LinearPiece::select(self, other, self, other)
    }
    fn absolute(self) -> Self {
        let opposite = LinearPiece { value: -self.value, slope: -self.slope, ..self };
        let size = if self.is_up() { self } else { opposite };
        size.shortened(self)
    }
    fn select(left: Self, right: Self, then: Self, otherwise: Self) -> Self {
        let test = left.subtract(right);
        let chosen = if test.is_up() { then } else { otherwise };
        chosen.shortened(test)
    }
    fn call(function: Function, a: Self, b: Self) -> Self {
        a.bent(b, function.apply(a.value, b.value))
    }
    fn table(self, points: &[[f64; 2]]) -> Self {
        let (value, slope, origin) = segment(points, self.value);
        let corners = points.iter().map(|point| (point[0] - self.value) / self.slope);
        let corner = corners.filter(|distance| *distance > 0.0).fold(f64::INFINITY, f64::min);
        LinearPiece {
            value: value + slope * (self.value - origin),
            slope: slope * self.slope,
            reach: self.reach.min(corner),
            is_straight: self.is_straight,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moving(value: f64, slope: f64) -> LinearPiece {
        LinearPiece { value, slope, reach: f64::INFINITY, is_straight: true }
    }

    #[test]
    fn a_kink_ends_the_piece() {
        let below = moving(-3.0, 2.0).lower_of(LinearPiece::constant(1.0));
        assert_eq!((below.value, below.slope, below.reach), (-3.0, 2.0, 2.0));
        let level = moving(3.0, 2.0).lower_of(LinearPiece::constant(1.0));
        assert_eq!((level.value, level.slope, level.reach), (1.0, 0.0, f64::INFINITY));
    }

    #[test]
    fn at_a_kink_the_right_hand_side_counts() {
        let rising = moving(0.0, 1.0).absolute();
        assert_eq!((rising.slope, rising.reach), (1.0, f64::INFINITY));
        let falling = moving(0.0, -1.0).upper_of(LinearPiece::constant(0.0));
        assert_eq!((falling.slope, falling.reach), (0.0, f64::INFINITY));
    }

    #[test]
    fn products_and_functions_of_moving_numbers_are_not_straight() {
        let x = moving(2.0, 1.0);
        assert!(!x.multiply(x).is_straight);
        assert!(x.multiply(LinearPiece::constant(3.0)).is_straight);
        assert!(!LinearPiece::call(Function::Sqrt, x, x).is_straight);
    }
}
