//! Random expressions as trees. Their values are computed directly, without the normal form.

use proptest::prelude::*;

use super::{Point, QUANTITIES, VARIABLES, symbol};
use crate::symbolic::{Fraction, absolute, root};

/// Numbers of the trees.
const NUMBERS: [f64; 8] = [0.0, 0.1, 0.5, 1.0, 2.0, 2.5, -0.3, -1.0];

/// Number of quantities of the trees: the variables and two parameters.
const QUANTITY_COUNT: usize = VARIABLES + 2;

/// A tree is not evaluated where a divisor, or the difference of two compared values, is smaller than this.
const SMALLEST: f64 = 1e-3;

/// Largest error of a value, as a part of the size of its terms.
const TOLERANCE: f64 = 1e-9;

/// An operation with two operands.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Pair {
    /// a + b
    Sum,
    /// a - b
    Difference,
    /// a b
    Product,
    /// a/b
    Quotient,
    /// The smaller operand.
    Minimum,
    /// The larger operand.
    Maximum,
    /// The root of the sum of squares.
    Norm,
}

/// The operations with two operands, except quotients.
const PAIRS: [Pair; 6] =
    [Pair::Sum, Pair::Difference, Pair::Product, Pair::Minimum, Pair::Maximum, Pair::Norm];

/// An expression.
#[derive(Debug, Clone)]
pub(crate) enum Tree {
    /// A number.
    Number(f64),
    /// A quantity, with its index.
    Quantity(usize),
    /// The absolute value.
    Absolute(Box<Tree>),
    /// A power.
    Power(Box<Tree>, i32),
    /// An operation with two operands.
    Two(Pair, Box<[Tree; 2]>),
    /// The third operand if the first one is at least as large as the second one, otherwise the fourth.
    Choice(Box<[Tree; 4]>),
}

/// The value of a tree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured {
    /// The value.
    value: f64,
    /// The sum of the absolute values of the terms if the tree is multiplied out.
    size: f64,
    /// The size of all divisors as a multiple of their values: the loss of accuracy by divisions.
    loss: f64,
}

impl Measured {
    /// The value of a number or a quantity.
    fn of(value: f64) -> Self {
        Measured { value, size: value.abs(), loss: 1.0 }
    }

    /// Whether a value is equal, except for rounding.
    pub(crate) fn is_near(&self, value: f64) -> bool {
        (value - self.value).abs() <= TOLERANCE * self.size * self.loss
    }
}

impl Pair {
    /// The value of the operation. `None` if a divisor is too small.
    fn measured(self, a: Measured, b: Measured) -> Option<Measured> {
        let (value, size, own_loss) = match self {
            Pair::Sum => (a.value + b.value, a.size + b.size, 1.0),
            Pair::Difference => (a.value - b.value, a.size + b.size, 1.0),
            Pair::Product => (a.value * b.value, a.size * b.size, 1.0),
            // These contain half the sum and half the difference of the operands.
            Pair::Minimum => (a.value.min(b.value), a.size + b.size, 1.0),
            Pair::Maximum => (a.value.max(b.value), a.size + b.size, 1.0),
            Pair::Quotient => {
                let (divisor, loss) = (b.value.abs(), b.size / b.value.abs());
                if divisor < SMALLEST {
                    return None;
                }
                (a.value / b.value, a.size / divisor * loss, loss)
            }
            Pair::Norm => {
                let (value, square) = (a.value.hypot(b.value), a.size.powi(2) + b.size.powi(2));
                if value < SMALLEST {
                    return None;
                }
                (value, square / value, square / value.powi(2))
            }
        };
        Some(Measured { value, size, loss: a.loss * b.loss * own_loss })
    }
}

impl Tree {
    /// The normal form.
    pub(crate) fn fraction(&self) -> Fraction {
        match self {
            Tree::Number(value) => Fraction::number(*value),
            Tree::Quantity(index) => Fraction::symbol(symbol(QUANTITIES[*index])),
            Tree::Absolute(operand) => absolute(&operand.fraction()),
            Tree::Power(base, exponent) => base.fraction().power(*exponent),
            Tree::Two(pair, operands) => {
                let [a, b] = operands.each_ref().map(Tree::fraction);
                match pair {
                    Pair::Sum => a.plus(&b),
                    Pair::Difference => a.minus(&b),
                    Pair::Product => a.times(&b),
                    Pair::Quotient => a.over(&b),
                    Pair::Minimum => a.minimum(&b),
                    Pair::Maximum => a.maximum(&b),
                    Pair::Norm => root(&a.power(2).plus(&b.power(2))),
                }
            }
            Tree::Choice(operands) => {
                let [left, right, then, otherwise] = operands.each_ref().map(Tree::fraction);
                Fraction::select(&left, &right, &then, &otherwise)
            }
        }
    }

    /// The value at a point. `None` near a division by 0 and near the jump of a choice.
    pub(crate) fn measured(&self, point: &Point) -> Option<Measured> {
        Some(match self {
            Tree::Number(value) => Measured::of(*value),
            Tree::Quantity(index) => Measured::of(point.0[*index]),
            Tree::Absolute(operand) => {
                let operand = operand.measured(point)?;
                Measured { value: operand.value.abs(), ..operand }
            }
            Tree::Power(base, exponent) => {
                let Measured { value, size, loss } = base.measured(point)?;
                Measured { value: value.powi(*exponent), size: size.powi(*exponent), loss }
            }
            Tree::Two(pair, operands) => {
                let [a, b] = operands.each_ref().map(|operand| operand.measured(point));
                pair.measured(a?, b?)?
            }
            Tree::Choice(operands) => {
                let [left, right, then, otherwise] =
                    operands.each_ref().map(|operand| operand.measured(point));
                let (left, right, then, otherwise) = (left?, right?, then?, otherwise?);
                if (left.value - right.value).abs() < SMALLEST {
                    return None;
                }
                let value = if left.value >= right.value { then.value } else { otherwise.value };
                // The normal form has the difference of the two values and one of them.
                let size = then.size + 2.0 * otherwise.size;
                Measured { value, size, loss: then.loss * otherwise.loss }
            }
        })
    }
}

/// A random point. The parameters are positive.
pub(crate) fn point() -> impl Strategy<Value = Point> {
    let (variable, parameter) = (-3.0..3.0f64, 0.2..3.0f64);
    [variable.clone(), variable.clone(), variable, parameter.clone(), parameter].prop_map(Point)
}

/// A random tree of continuous functions. The only divisors are parameters.
pub(crate) fn continuous(depth: u32) -> impl Strategy<Value = Tree> {
    leaf().prop_recursive(depth, size(depth), 2, |inner| operation(&inner))
}

/// A random tree that also has choices by a condition.
pub(crate) fn with_choices(depth: u32) -> impl Strategy<Value = Tree> {
    leaf().prop_recursive(
        depth,
        size(depth),
        2,
        |inner| prop_oneof![9 => operation(&inner), 1 => choice(&inner)],
    )
}

/// A random tree that also has choices by a condition and divisors of any kind.
pub(crate) fn with_quotients(depth: u32) -> impl Strategy<Value = Tree> {
    leaf().prop_recursive(depth, size(depth), 2, |inner| {
        let quotient = (inner.clone(), inner.clone()).prop_map(|operands| two(Pair::Quotient, operands));
        prop_oneof![7 => operation(&inner), 1 => choice(&inner), 2 => quotient]
    })
}

/// The number of nodes at which most trees have the depth.
fn size(depth: u32) -> u32 {
    3 << depth
}

/// A number or a quantity.
fn leaf() -> impl Strategy<Value = Tree> {
    let number = prop::sample::select(NUMBERS.to_vec()).prop_map(Tree::Number);
    prop_oneof![1 => number, 3 => (0..QUANTITY_COUNT).prop_map(Tree::Quantity)]
}

/// A continuous function of random trees.
fn operation(inner: &BoxedStrategy<Tree>) -> BoxedStrategy<Tree> {
    let pair = (prop::sample::select(PAIRS.to_vec()), (inner.clone(), inner.clone()))
        .prop_map(|(pair, operands)| two(pair, operands));
    let parameter = (VARIABLES..QUANTITY_COUNT).prop_map(Tree::Quantity);
    let share = (inner.clone(), parameter).prop_map(|operands| two(Pair::Quotient, operands));
    let absolute = inner.clone().prop_map(|operand| Tree::Absolute(Box::new(operand)));
    let power = (inner.clone(), 2..4i32).prop_map(|(base, exponent)| Tree::Power(Box::new(base), exponent));
    prop_oneof![6 => pair, 1 => share, 1 => absolute, 1 => power].boxed()
}

/// A choice between two random trees.
fn choice(inner: &BoxedStrategy<Tree>) -> BoxedStrategy<Tree> {
    let operand = || inner.clone();
    let operands = [operand(), operand(), operand(), operand()];
    operands.prop_map(|operands| Tree::Choice(Box::new(operands))).boxed()
}

/// An operation with two operands.
fn two(pair: Pair, (a, b): (Tree, Tree)) -> Tree {
    Tree::Two(pair, Box::new([a, b]))
}
