//! An equation as expressions of the outputs of a program.

use std::collections::btree_map::{BTreeMap, Entry};
use std::collections::{BTreeSet, HashSet};
use std::f64::consts::PI;
use std::sync::Arc;

use patchcord_expr::{Equation, Function};

use crate::compare::corners::corner_functions;
use crate::compare::intended::fraction;
use crate::compare::model::{Model, Obstacle};
use crate::derive::LawKind;
use crate::symbolic::{
    Application, Atom, CallOrder, Fraction, Operation, Roots, Symbol, Values, is_at_switch, value,
};

/// An equation to be evaluated.
pub(super) struct Question {
    /// The left and the right side.
    pub sides: [Fraction; 2],
    /// The loops without a formula behind it, with the derivatives of their quantities, in the order in which they are
    /// solved.
    pub loops: Vec<Roots>,
    /// The arguments of every angle of a point in it. An angle jumps by a turn.
    angles: Vec<[Fraction; 2]>,
    /// The steps in it.
    steps: Vec<Fraction>,
}

impl Question {
    /// The expressions of an equation.
    ///
    /// # Errors
    /// If a quantity of the equation has no expression.
    pub(super) fn new(model: &mut Model<'_>, equation: &Equation) -> Result<Self, Obstacle> {
        let none = HashSet::new();
        let [left, right] = [equation.left(), equation.right()]
            .map(|side| fraction(side, &mut |name| model.named(name, &none)));
        let sides = [left?, right?];
        let loops = loops(model, &sides);
        let angles = sides.iter().flat_map(angles).collect();
        let found: BTreeSet<Arc<Application>> = sides.iter().flat_map(steps).collect();
        let steps = found.into_iter().map(|step| Fraction::atom(Atom::Apply(step))).collect();
        Ok(Question { sides, loops, angles, steps })
    }

    /// Whether a side jumps exactly at a point.
    pub(super) fn is_at_switch(&self, values: &dyn Values) -> bool {
        self.steps.iter().any(|step| is_at_switch(step, values))
    }

    /// The names of the parameters on which the equation or a loop behind it depends.
    pub(super) fn parameters(&self, model: &Model<'_>) -> Vec<String> {
        model.parameters_in(self.sides.iter().chain(self.loops.iter().flat_map(Roots::expressions)))
    }

    /// The functions of the sides, and of the loops behind them, that have corners.
    pub(super) fn corner_functions(&self) -> Vec<Arc<Application>> {
        let expressions = self.sides.iter().chain(self.loops.iter().flat_map(Roots::expressions));
        expressions.flat_map(corner_functions).collect()
    }

    /// The angles of points in rad.
    pub(super) fn angles(&self, values: &dyn Values) -> Vec<f64> {
        let angle = |[y, x]: &[Fraction; 2]| Function::Atan2.apply(value(y, values), value(x, values));
        self.angles.iter().map(angle).collect()
    }
}

/// Whether an angle has jumped between two states.
pub(super) fn has_jump(before: &[f64], after: &[f64]) -> bool {
    before.iter().zip(after).any(|(before, after)| (after - before).abs() > PI)
}

/// The loops without a formula behind two expressions. Those of higher derivatives come last.
fn loops(model: &mut Model<'_>, sides: &[Fraction; 2]) -> Vec<Roots> {
    let mut found: BTreeMap<(u8, u32), (Symbol, Fraction)> = BTreeMap::new();
    let mut open = sides.to_vec();
    while let Some(expression) = open.pop() {
        for symbol in expression.symbols() {
            let Some(LawKind::Implicit(residual)) = model.system.law(symbol) else { continue };
            let (residual, primes) = (residual.clone(), model.system.symbols.entry(symbol).primes);
            if let Entry::Vacant(entry) = found.entry((primes, symbol.index)) {
                let residual = model.expanded_fraction(&residual, &HashSet::new());
                open.push(residual.clone());
                entry.insert((symbol, residual));
            }
        }
    }
    let mut by_order: BTreeMap<u8, (Vec<Symbol>, Vec<Fraction>)> = BTreeMap::new();
    for ((primes, _), (symbol, residual)) in found {
        let (unknowns, residuals) = by_order.entry(primes).or_default();
        unknowns.push(symbol);
        residuals.push(residual);
    }
    by_order.into_values().map(|(unknowns, residuals)| Roots::new(unknowns, residuals)).collect()
}

/// The arguments of the angles of points in an expression.
fn angles(expression: &Fraction) -> Vec<[Fraction; 2]> {
    let angle = Operation::Call(CallOrder(Function::Atan2));
    let found = expression.functions_with(&|function| function.operation == angle).into_iter();
    found.filter_map(|function| <[Fraction; 2]>::try_from(function.arguments.clone()).ok()).collect()
}

/// The steps in an expression.
fn steps(expression: &Fraction) -> Vec<Arc<Application>> {
    expression.functions_with(&|function| function.operation == Operation::Step)
}
