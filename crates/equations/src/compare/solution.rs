//! Solves a stated equation for its highest derivative.

use std::collections::HashSet;

use patchcord_expr::{Dimension, Equation, split_primes};

use super::comparison::Comparison;
use super::intended::fraction;
use super::model::Obstacle;
use super::points::ParameterValues;
use crate::derive::LawKind;
use crate::symbolic::{Atom, Fraction, Symbol, partial_derivative, value};

/// An equation that is solved for a quantity.
pub(super) struct Solved {
    /// The quantity, with its primes.
    pub name: String,
    /// Its value.
    pub value: Fraction,
    /// The factor of the quantity in the left side minus the right side.
    pub slope: Fraction,
}

impl Comparison<'_> {
    /// An equation solved for the name with the most primes on the left, in the names of the equation. If the factor of
    /// this name is 0 for the present parameters, as that of a coupling can be, another name is taken if possible. `None`
    /// if the equation is not linear in the first name.
    pub(super) fn solved(&mut self, equation: &Equation) -> Result<Option<Solved>, Obstacle> {
        let mut names = equation.names();
        names.retain(|name| self.is_variable(name));
        names.sort_by_key(|name| std::cmp::Reverse(split_primes(name).1));
        let Some((first, others)) = names.split_first() else { return Ok(None) };
        let found = self.solved_for(equation, first)?;
        if found.as_ref().is_none_or(|solved| self.has_factor(solved)) {
            return Ok(found);
        }
        for name in others {
            if let Ok(Some(solved)) = self.solved_for(equation, name)
                && self.has_factor(&solved)
            {
                return Ok(Some(solved));
            }
        }
        Ok(found)
    }

    /// Whether the factor of the quantity for which an equation is solved is not 0 for the present parameters.
    fn has_factor(&self, solved: &Solved) -> bool {
        value(&solved.slope, &self.point(ParameterValues::Present)) != 0.0
    }

    /// An equation solved for one of its names. `None` if it is not linear in this name.
    fn solved_for(&mut self, equation: &Equation, name: &str) -> Result<Option<Solved>, Obstacle> {
        let name = name.to_owned();
        let unknown = self.model.system.symbols.variable(&name, 0, Dimension::NONE);
        let kept = self.kept(equation, &name);
        let [left, right] = [equation.left(), equation.right()].map(|side| {
            fraction(side, &mut |other| {
                if other == name { Ok(Fraction::symbol(unknown)) } else { self.model.named(other, &kept) }
            })
        });
        let (left, right) = (left?, right?);
        let parts = match (linear(&left, unknown), linear(&right, unknown)) {
            (Some(left), Some(right)) => Some((difference(&right.0, &left.0), difference(&left.1, &right.1))),
            _ => linear(&right.minus(&left), unknown).map(|(rest, slope)| (rest, slope.negated())),
        };
        let solved = |(rest, slope): (Fraction, Fraction)| {
            let value = if slope == Fraction::whole(1) { rest } else { rest.over(&slope) };
            (!slope.is_zero()).then_some(Solved { name, value, slope })
        };
        Ok(parts.and_then(solved))
    }

    /// Whether a name of an equation is a quantity that varies.
    fn is_variable(&self, name: &str) -> bool {
        let base = split_primes(name).0;
        let patch = self.circuit.patch();
        patch.signals.contains_key(base)
            || (self.model.expands_drives() && patch.drives.contains_key(base))
            || self.circuit.auxiliary_quantities().any(|auxiliary| auxiliary == base)
    }

    /// The signals of an equation that follow from others: they stay in the comparison under their names, except the
    /// one for which the equation is solved.
    pub(super) fn kept(&self, equation: &Equation, solved: &str) -> HashSet<Symbol> {
        let solved = split_primes(solved).0;
        let names = equation.names().into_iter().filter(|name| *name != solved && split_primes(name).1 == 0);
        let found = names.filter_map(|name| self.model.symbol(name, 0));
        found.filter(|symbol| self.is_expression(*symbol)).collect()
    }

    /// Whether a signal follows from others, and is not only another name for one of them.
    fn is_expression(&self, signal: Symbol) -> bool {
        let Some(LawKind::Definition(value)) = self.model.system.law(signal) else { return false };
        let is_constant = |atom: &Atom| matches!(atom, Atom::Symbol(symbol) if symbol.is_constant);
        let factors =
            value.numerator().as_term().map(|(product, _)| product.only(|atom, _| !is_constant(atom)));
        !factors.is_some_and(|product| matches!(product.factors(), [(Atom::Symbol(_), 1)]))
    }
}

/// An expression as a linear function of a symbol: its value at 0, and the factor of the symbol. `None` if it is not
/// linear.
fn linear(value: &Fraction, symbol: Symbol) -> Option<(Fraction, Fraction)> {
    let has_symbol = |value: &Fraction| value.contains(&mut |other| other == symbol);
    if !has_symbol(value) {
        return Some((value.clone(), Fraction::zero()));
    }
    let slope = partial_derivative(value, symbol);
    let rest = value.minus(&slope.times(&Fraction::symbol(symbol)));
    (!has_symbol(&slope) && !has_symbol(&rest)).then_some((rest, slope))
}

/// The difference of two expressions. If the second one is 0, it takes no time.
fn difference(first: &Fraction, second: &Fraction) -> Fraction {
    if second.is_zero() { first.clone() } else { first.minus(second) }
}
