//! The values that stated equations give to a quantity, as functions of the signals from which the wiring computes it.
//!
//! Two equations can contain the same two unknowns, as those of two masses that are coupled by a third. The wiring has the
//! solution of both. So an unknown from which the wiring does not compute is eliminated.

use std::collections::BTreeSet;

use crate::derive::System;
use crate::symbolic::{Fraction, Symbol, SymbolKind, partial_derivative};

/// A quantity: its name and the number of its derivatives.
pub(super) type Quantity = (String, usize);

/// An equation that can be solved for a quantity.
pub(super) struct SolvedEquation {
    /// The quantity.
    pub of: Quantity,
    /// The equation as an expression that is 0, in the names of the equations.
    pub residual: Fraction,
    /// Index of the equation among those of the patch.
    pub index: usize,
}

/// The equations of a patch, each with the quantity for which it can be solved.
pub(super) struct SolvedEquations {
    /// The names of the quantities.
    pub system: System,
    /// The equations that can be solved for a quantity.
    pub solved: Vec<SolvedEquation>,
}

/// Wiring from a signal to a quantity.
#[derive(Clone, Copy)]
pub(super) struct Path<'p> {
    /// The quantity that the wiring computes.
    pub of: Symbol,
    /// The signal, or its derivative.
    pub input: Symbol,
    /// The names of all signals from which the wiring computes the quantity.
    pub inputs: &'p BTreeSet<&'p str>,
}

/// A quantity that is to be eliminated.
struct Elimination {
    /// The quantity.
    of: Symbol,
    /// Its value.
    by: Fraction,
    /// Index of the equation that gives the value.
    index: usize,
}

impl SolvedEquations {
    /// The symbol of a quantity. `None` if no equation names it.
    pub(super) fn symbol(&self, (name, order): &Quantity) -> Option<Symbol> {
        self.system.symbols.find(name, u8::try_from(*order).ok()?)
    }

    /// The values that equations give to the quantity of a path, each with the index of its equation.
    pub(super) fn values(&self, path: Path<'_>) -> Vec<(Fraction, usize)> {
        let is_own = |equation: &&SolvedEquation| self.symbol(&equation.of) == Some(path.of);
        let mut equations: Vec<&SolvedEquation> = self.solved.iter().filter(is_own).collect();
        if equations.is_empty() {
            equations = self.solved.iter().filter(|equation| self.is_simultaneous(equation)).collect();
        }
        let value = |equation: &SolvedEquation| Some((self.value(equation, path)?, equation.index));
        equations.into_iter().filter_map(value).collect()
    }

    /// Whether another equation can be solved for the same quantity, as two equations with x'' and y'' can.
    fn is_simultaneous(&self, equation: &SolvedEquation) -> bool {
        self.solved.iter().any(|other| other.index != equation.index && other.of == equation.of)
    }

    /// The value that an equation gives to the quantity of a path, after all eliminations. `None` if the equation does not
    /// determine the quantity.
    fn value(&self, equation: &SolvedEquation, path: Path<'_>) -> Option<Fraction> {
        let mut residual = equation.residual.clone();
        let mut used = vec![equation.index];
        loop {
            let value = solved_for(&residual, path.of)?;
            let Some(elimination) = self.elimination(&value, path, &used) else {
                return Some(value);
            };
            residual = residual.mapped(&mut |symbol| {
                if symbol == elimination.of { elimination.by.clone() } else { Fraction::symbol(symbol) }
            });
            used.push(elimination.index);
        }
    }

    /// The elimination of an unknown from a value by an equation that is not yet used. A factor that varies is that of
    /// wiring that is not linear, so its unknown stays.
    fn elimination(&self, value: &Fraction, path: Path<'_>, used: &[usize]) -> Option<Elimination> {
        let mut unknowns = self.unknowns(value, path);
        unknowns.retain(|unknown| partial_derivative(value, *unknown).is_constant());
        let rest = self.solved.iter().filter(|equation| !used.contains(&equation.index));
        let mut pairs = rest.flat_map(|equation| unknowns.iter().map(move |unknown| (equation, *unknown)));
        pairs.find_map(|(equation, of)| {
            if self.symbol(&equation.of) != Some(of) && !self.is_simultaneous(equation) {
                return None;
            }
            let by = solved_for(&equation.residual, of)?;
            let is_linear = partial_derivative(&by, path.input).is_constant();
            is_linear.then_some(Elimination { of, by, index: equation.index })
        })
    }

    /// The quantities in a value from which the wiring of a path does not compute.
    fn unknowns(&self, value: &Fraction, path: Path<'_>) -> BTreeSet<Symbol> {
        let symbols = &self.system.symbols;
        let primes = symbols.entry(path.input).primes;
        let mut unknowns = BTreeSet::new();
        value.contains(&mut |symbol| {
            let entry = symbols.entry(symbol);
            let is_input = entry.primes == primes && path.inputs.contains(entry.name.as_str());
            if entry.kind == SymbolKind::Variable && !is_input {
                unknowns.insert(symbol);
            }
            false
        });
        unknowns
    }
}

/// The value of a symbol for which an expression is 0. `None` if the expression is not linear in it.
pub(super) fn solved_for(residual: &Fraction, symbol: Symbol) -> Option<Fraction> {
    let slope = partial_derivative(residual, symbol);
    if slope.is_zero() || slope.contains(&mut |other| other == symbol) {
        return None;
    }
    let value = Fraction::symbol(symbol).minus(&residual.over(&slope));
    (!value.contains(&mut |other| other == symbol)).then_some(value)
}
