//! Writes choices as cases: values by condition.

use num_traits::Signed as _;
use patchcord_expr::Dimension;

use super::Writer;
use super::maxima::with_maxima;
use crate::derive::ModeLaw;
use crate::notation::{Comparison, Condition, Notation, Relation, conditions_text};
use crate::symbolic::{Application, Atom, Fraction, Operation, Polynomial, SymbolKind, partial_derivative};

/// Most conditions of one expression that become cases. Further ones are written as a function `step`.
const MOST_CONDITIONS: usize = 3;

/// A value with the conditions under which it applies.
pub(super) type Case = (Notation, Vec<Comparison>);

impl Writer<'_> {
    /// An expression, with cases if it contains a mode or a condition.
    pub(super) fn cases(&self, value: &Fraction, dimension: Option<Dimension>) -> Notation {
        let mut cases = self.branches(value, dimension, MOST_CONDITIONS);
        // The last case needs no condition of its own if the one before it has the same value.
        while let [.., (before, _), (last, conditions)] = cases.as_slice()
            && before == last
            && conditions.is_empty()
        {
            let end = cases.len() - 2;
            cases.remove(end);
        }
        if cases.len() == 1 {
            return cases.remove(0).0;
        }
        let conditioned = cases
            .into_iter()
            .map(|(value, condition)| (value, (!condition.is_empty()).then_some(Condition(condition))));
        Notation::Cases(conditioned.collect())
    }

    /// The cases of an expression, in the order in which they are examined. The last one may have no condition.
    pub(super) fn branches(&self, value: &Fraction, dimension: Option<Dimension>, left: usize) -> Vec<Case> {
        let mode = self.system.modes.iter().find(|mode| value.contains(&mut |symbol| symbol == mode.symbol));
        if let Some(mode) = mode {
            return match mode.brake() {
                Some(brake) => self.brake_branches(&brake, value, dimension, left),
                None => self.mode_branches(mode, value, dimension, left),
            };
        }
        let condition = if left == 0 { None } else { first_condition(value) };
        let Some(condition) = condition else { return vec![(self.sum(value, dimension), Vec::new())] };
        let sides = [Side::Below, Side::Zero, Side::Above].map(|side| on_side(value, &condition, side));
        // A law of time begins with the earlier values.
        let alternatives = alternatives(sides, self.rises_with_time(&condition));
        let left = if alternatives.len() > 1 { left - 1 } else { left };
        let mut cases = Vec::new();
        for (value, relation) in alternatives {
            let mut inner = self.branches(&value, dimension, left);
            if let Some(relation) = relation {
                let comparison = self.compare(&condition, relation);
                inner.iter_mut().for_each(|(_, conditions)| conditions.insert(0, comparison.clone()));
            }
            cases.extend(inner);
        }
        cases
    }

    /// The cases by the value of a mode. Values with the same expression are one case.
    fn mode_branches(
        &self,
        mode: &ModeLaw,
        value: &Fraction,
        dimension: Option<Dimension>,
        left: usize,
    ) -> Vec<Case> {
        let mut by_expression: Vec<(Fraction, Vec<&str>)> = Vec::new();
        for (number, name) in mode.values {
            let expression = value.mapped(&mut |symbol| {
                if symbol == mode.symbol { Fraction::number(*number) } else { Fraction::symbol(symbol) }
            });
            match by_expression.iter_mut().find(|(known, _)| *known == expression) {
                Some((_, names)) if names.contains(name) => {}
                Some((_, names)) => names.push(name),
                None => by_expression.push((expression, vec![name])),
            }
        }
        // The expression of most values is last. It needs no condition.
        by_expression.sort_by_key(|(_, names)| names.len());
        let last = by_expression.len() - 1;
        let cases = by_expression.iter().enumerate().flat_map(|(index, (expression, names))| {
            let words = Comparison::Words(format!("{} is {}", mode.element, names.join(" or ")));
            let mut cases = self.branches(expression, dimension, left);
            if index < last {
                cases.iter_mut().for_each(|(_, conditions)| conditions.insert(0, words.clone()));
            }
            cases
        });
        cases.collect()
    }

    /// Whether an expression varies with time only, and is not known to fall.
    fn rises_with_time(&self, value: &Fraction) -> bool {
        let symbols = &self.system.symbols;
        let mut times = symbols.entries().filter(|(_, entry)| entry.kind == SymbolKind::Time);
        let Some((time, _)) = times.next() else { return false };
        !value.contains(&mut |symbol| !symbol.is_constant && symbol != time)
            && !partial_derivative(value, time).negated().is_positive()
    }

    /// The condition that an expression is 0 or above, or strictly above 0. The smaller of two values is above 0 if both
    /// are.
    pub(crate) fn condition(&self, guard: &Fraction, is_strict: bool) -> Condition {
        if let Some(parts) = minimum_of(guard) {
            let parts = parts.iter().flat_map(|guard| self.condition(guard, is_strict).0);
            return Condition(parts.collect());
        }
        let relation = if is_strict { Relation::Greater } else { Relation::AtLeast };
        Condition(vec![self.compare(guard, relation)])
    }

    /// The same condition as text.
    pub(crate) fn condition_text(&self, guard: &Fraction, is_strict: bool) -> String {
        conditions_text(&self.condition(guard, is_strict))
    }

    /// A comparison of an expression with 0, with variables on the left and constants on the right, and without
    /// positive factors.
    pub(super) fn compare(&self, condition: &Fraction, relation: Relation) -> Comparison {
        if condition.divisors().len() > 0 || condition.is_zero() {
            let (left, dimension) = (condition, self.dimension(condition));
            let right = Notation::Number { value: 0.0, unit: None };
            return Comparison::Compare { left: self.expression(left, dimension), relation, right };
        }
        let (number, content, rest) = with_maxima(condition.numerator()).into_primitive();
        let is_number = content.is_constant() && rest.terms().all(|(product, _)| product.is_constant());
        let unknown = content.only(|atom, exponent| is_number || !atom.has_positive_power(exponent));
        let relation = if number.is_negative() { reversed(relation) } else { relation };
        let (mut left, mut right) = (Polynomial::default(), Polynomial::default());
        for (product, number) in rest.terms() {
            let product = product.times(&unknown);
            if product.is_constant() {
                right.add_term(product, &-number.clone());
            } else {
                left.add_term(product, number);
            }
        }
        if left.is_zero() {
            std::mem::swap(&mut left, &mut right);
            left = left.negated();
        }
        let is_negative = left.terms().all(|(_, number)| number.is_negative());
        let (left, right, relation) = if is_negative {
            (left.negated(), right.negated(), reversed(relation))
        } else {
            (left, right, relation)
        };
        let dimension = self.sum_dimension(&left);
        let [left, right] = [left, right].map(|side| self.expression(&Fraction::from(side), dimension));
        Comparison::Compare { left, relation, right }
    }
}

/// The two values of which an expression is the smaller one, but for a positive factor.
fn minimum_of(guard: &Fraction) -> Option<[Fraction; 2]> {
    if guard.divisors().len() > 0 {
        return None;
    }
    let written = with_maxima(guard.numerator());
    let (product, number) = written.as_term()?;
    let is_minimum = |atom: &Atom| {
        matches!(atom, Atom::Apply(applied)
        if matches!(applied.operation, Operation::Minimum | Operation::Maximum))
    };
    let (atom, _) = product.factors().iter().find(|(atom, exponent)| is_minimum(atom) && *exponent == 1)?;
    let is_known = |(other, exponent): &(Atom, i32)| other == atom || other.has_positive_power(*exponent);
    let Atom::Apply(applied) = atom else { return None };
    let [first, second] = applied.arguments.as_slice() else { return None };
    match applied.operation {
        _ if !product.factors().iter().all(is_known) => None,
        Operation::Minimum if number.is_positive() => Some([first.clone(), second.clone()]),
        Operation::Maximum if number.is_negative() => Some([first.negated(), second.negated()]),
        _ => None,
    }
}

/// The relation with both sides negated.
fn reversed(relation: Relation) -> Relation {
    match relation {
        Relation::Less => Relation::Greater,
        Relation::AtMost => Relation::AtLeast,
        Relation::Greater => Relation::Less,
        Relation::AtLeast => Relation::AtMost,
        Relation::Equal => Relation::Equal,
    }
}

/// The argument of a step in an expression that contains no other step.
fn first_condition(value: &Fraction) -> Option<Fraction> {
    if !value.has_step() {
        return None;
    }
    let divisors = value.divisors().map(|(divisor, _)| divisor);
    let mut atoms = [value.numerator()].into_iter().chain(divisors).flat_map(Polynomial::atoms);
    atoms.find_map(|atom| match atom {
        Atom::Symbol(_) => None,
        Atom::Apply(applied) => {
            let inner = applied.arguments.iter().find_map(first_condition);
            inner.or_else(|| step_argument(applied).cloned())
        }
    })
}

/// The argument of a step.
fn step_argument(applied: &Application) -> Option<&Fraction> {
    if applied.operation == Operation::Step { applied.arguments.first() } else { None }
}

/// The side of 0 on which the argument of a step is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// It is below 0.
    Below,
    /// It is exactly 0.
    Zero,
    /// It is above 0.
    Above,
}

/// An expression with the argument of a step on this side of 0. The steps that this decides are numbers.
fn on_side(value: &Fraction, condition: &Fraction, side: Side) -> Fraction {
    value.with_factors(&mut |atom| {
        let Atom::Apply(applied) = atom else { return None };
        Some(Fraction::whole(i64::from(step_on_side(step_argument(applied)?, condition, side)?)))
    })
}

/// Whether a step of another argument is 1 if the condition is on this side of 0. `None` if that is not known.
///
/// The same steps are known at 0 and above 0. Only that of the opposite argument is 1 at 0 and 0 above it. So both sides
/// have the same expression unless it occurs.
fn step_on_side(argument: &Fraction, condition: &Fraction, side: Side) -> Option<bool> {
    let (difference, sum) = (argument.minus(condition), argument.plus(condition));
    match side {
        // The sum is below the argument. An argument that is at most the condition is below 0 too.
        Side::Below if sum.is_nonnegative() => Some(true),
        Side::Below => difference.negated().is_nonnegative().then_some(false),
        _ if difference.is_nonnegative() => Some(true),
        _ if sum.is_zero() => Some(side == Side::Zero),
        _ => sum.negated().is_positive().then_some(false),
    }
}

/// The different values of an expression below, at and above 0 of a condition, in the order in which they are examined,
/// each with the relation of the condition to 0. The last one needs none.
fn alternatives([below, zero, above]: [Fraction; 3], is_reversed: bool) -> Vec<(Fraction, Option<Relation>)> {
    if below == above {
        let exception = (zero != above).then_some((zero, Some(Relation::Equal)));
        return exception.into_iter().chain([(above, None)]).collect();
    }
    let is_low = zero == below;
    let is_apart = !is_low && zero != above;
    let under = if is_low { Relation::AtMost } else { Relation::Less };
    let over = if is_low || is_apart { Relation::Greater } else { Relation::AtLeast };
    let mut ends = [(above, Some(over)), (below, Some(under))];
    if is_reversed {
        ends.reverse();
    }
    let [first, (last, relation)] = ends;
    if is_apart { vec![first, (last, relation), (zero, None)] } else { vec![first, (last, None)] }
}
