//! Writes the law of a brake: 0 at rest, otherwise the net rate less the level of the brake in the direction of motion.

use num_traits::Signed as _;
use patchcord_expr::Dimension;

use super::Writer;
use super::cases::Case;
use super::maxima::with_maxima;
use crate::derive::BrakeLaw;
use crate::notation::{Comparison, Relation};
use crate::symbolic::{Atom, Fraction, Operation, Polynomial, Symbol, absolute, sign};

impl Writer<'_> {
    /// The cases of an expression that contains the direction of a brake: the output is at rest, or it moves.
    pub(super) fn brake_branches(
        &self,
        brake: &BrakeLaw,
        value: &Fraction,
        dimension: Option<Dimension>,
        left: usize,
    ) -> Vec<Case> {
        let moving = in_motion(value, brake);
        let resting = value.mapped(&mut |symbol| {
            if symbol == brake.direction { Fraction::zero() } else { Fraction::symbol(symbol) }
        });
        let mut cases = self.branches(&resting, dimension, left);
        if resting == moving {
            return cases;
        }
        let conditions = [Some(self.compare(&brake.output, Relation::Equal)), self.holds(brake)];
        for condition in conditions.into_iter().flatten().rev() {
            cases.iter_mut().for_each(|(_, own)| own.insert(0, condition.clone()));
        }
        cases.extend(self.branches(&moving, dimension, left));
        cases
    }

    /// The condition under which a brake holds an output at rest, such as `k abs(x) <= Fs`. `None` if nothing drives the
    /// output.
    fn holds(&self, brake: &BrakeLaw) -> Option<Comparison> {
        let [net, level] =
            [absolute(&brake.net), brake.level.clone()].map(|value| at_rest(&value, &brake.output));
        if net.is_zero() {
            return None;
        }
        if net.divisors().len() > 0 || level.divisors().len() > 0 {
            let dimension = self.dimension(&net);
            let [left, right] = [&net, &level].map(|side| self.expression(side, dimension));
            return Some(Comparison::Compare { left, relation: Relation::AtMost, right });
        }
        let sides = without_common_factors([net, level].map(|side| with_maxima(side.numerator())));
        let dimension = self.sum_dimension(&sides[0]);
        let [left, right] = sides.map(|side| self.expression(&Fraction::from(side), dimension));
        Some(Comparison::Compare { left, relation: Relation::AtMost, right })
    }
}

/// An expression while the output of a brake moves. The direction is the sign of the output then, and its size is 1.
fn in_motion(value: &Fraction, brake: &BrakeLaw) -> Fraction {
    let direction = Fraction::symbol(brake.direction);
    value.with_factors(&mut |atom| match atom {
        Atom::Symbol(symbol) => (*symbol == brake.direction).then(|| sign(&brake.output)),
        Atom::Apply(applied) => {
            let is_size = applied.operation == Operation::Absolute && applied.arguments[0] == direction;
            is_size.then(|| Fraction::whole(1))
        }
    })
}

/// An expression while an output is 0. It stays as it is if the output is no single quantity, or a divisor of it.
fn at_rest(value: &Fraction, output: &Fraction) -> Fraction {
    let Some(symbol) = quantity(output) else { return value.clone() };
    let is_divisor = value.divisors().any(|(divisor, _)| has_symbol(divisor, symbol))
        || value.numerator().by_powers(&Atom::Symbol(symbol)).keys().any(|exponent| *exponent < 0);
    if is_divisor {
        return value.clone();
    }
    value.mapped(&mut |other| if other == symbol { Fraction::zero() } else { Fraction::symbol(other) })
}

/// The quantity of which an expression is a constant multiple.
fn quantity(value: &Fraction) -> Option<Symbol> {
    let (product, _) = value.numerator().as_term().filter(|_| value.divisors().len() == 0)?;
    match product.only(|atom, _| !atom.is_constant()).factors() {
        [(Atom::Symbol(symbol), 1)] => Some(*symbol),
        _ => None,
    }
}

/// Whether a sum contains a symbol.
fn has_symbol(sum: &Polynomial, symbol: Symbol) -> bool {
    Fraction::from(sum.clone()).contains(&mut |other| other == symbol)
}

/// The sides of an inequality without the numbers and the factors above 0 that all terms have in common.
fn without_common_factors(sides: [Polynomial; 2]) -> [Polynomial; 2] {
    let [left, right] = &sides;
    let sum = left.plus(&right.negated());
    if sum.is_zero() {
        return sides;
    }
    let (number, content, _) = sum.into_primitive();
    let common = content.only(Atom::has_positive_power).power(-1);
    sides.map(|side| side.times_term(&common, &number.abs().recip()))
}
