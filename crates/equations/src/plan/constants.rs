//! The constants of a problem: its parameters, pi, and quantities that consist of these.

use std::collections::{BTreeMap, HashSet};

use patchcord_core::circuit::Circuit;
use patchcord_expr::{Dimension, Expression, Function, Node};

use super::extent::is_short;
use super::unknowns::Unknowns;
use crate::compare::intended::fraction;
use crate::derive::System;
use crate::graph::ConstantValues;
use crate::symbolic::{
    CallOrder, Fraction, Operation, Rational, SymbolEntry, SymbolKind, Symbols, nearest, opaque,
};

/// The most terms of a constant in a formula, also inside functions. A larger one is computed by the machine.
const MOST_TERMS: usize = 24;
/// The most bits of an exact number. A longer one is a decimal.
const MOST_BITS: u64 = 512;

/// The constants with their names and present values.
pub(super) struct Constants {
    /// The symbols of the parameters and of pi. It has no laws.
    pub system: System,
    /// The expression of each name.
    named: BTreeMap<String, Fraction>,
    /// The present values of the symbols.
    values: ConstantValues,
}

impl Constants {
    /// The parameters of a circuit, and pi.
    pub(super) fn new(circuit: &Circuit) -> Self {
        let mut symbols = Symbols::default();
        let mut named = BTreeMap::new();
        let mut add = |name: &str, kind, dimension, is_nonnegative| {
            let entry = SymbolEntry { name: name.to_owned(), primes: 0, kind, dimension };
            let symbol = symbols.add(entry, is_nonnegative);
            named.entry(name.to_owned()).or_insert_with(|| Fraction::symbol(symbol));
        };
        add("pi", SymbolKind::Pi, Dimension::NONE, true);
        for (index, (name, parameter, value)) in circuit.parameters().enumerate() {
            let is_nonnegative = match parameter.range {
                Some((low, _)) => low >= 0.0,
                None => value > 0.0,
            };
            add(name, SymbolKind::Parameter(index), parameter.unit.dimension(), is_nonnegative);
        }
        let values = ConstantValues::new(&symbols, circuit);
        let system =
            System { symbols, laws: Vec::new(), modes: Vec::new(), tables: Vec::new(), margins: Vec::new() };
        Constants { system, named, values }
    }

    /// Adds the algebraic quantities that equations such as `w = sqrt(k/m)` define by constants.
    pub(super) fn add_quantities(&mut self, circuit: &Circuit, unknowns: &Unknowns) {
        let algebraic: HashSet<&str> =
            unknowns.all.iter().filter(|unknown| unknown.order == 0).map(|it| it.base.as_str()).collect();
        let definitions =
            circuit.equations().iter().filter_map(|placed| match &placed.value.left().expression {
                Expression::Name(name) if algebraic.contains(name.as_str()) => {
                    Some((name, placed.value.right()))
                }
                _ => None,
            });
        let definitions: Vec<(&String, &Node)> = definitions.collect();
        let mut count = 0;
        while count < self.named.len() {
            count = self.named.len();
            for (name, right) in &definitions {
                if !self.named.contains_key(*name)
                    && let Some(value) = self.expression(right)
                    && is_readable(&value)
                {
                    self.named.insert((*name).clone(), value);
                }
            }
        }
    }

    /// The constant with this name. `None` if the name is another one.
    pub(super) fn named(&self, name: &str) -> Option<&Fraction> {
        self.named.get(name)
    }

    /// Whether an expression contains no other names than those of constants.
    pub(super) fn is_constant(&self, node: &Node) -> bool {
        node.names().into_iter().all(|name| self.named.contains_key(name))
    }

    /// The exact value of an expression of constants. `None` if it contains another name or a table, or if it is too long.
    ///
    /// If it would be too long multiplied out, the values of its names stay as they are.
    pub(super) fn expression(&self, node: &Node) -> Option<Fraction> {
        if !self.is_constant(node) {
            return None;
        }
        let named = |name: &str| self.named.get(name).cloned().unwrap_or_default();
        let value = if is_short(node, &self.named) {
            fraction(node, &mut |name| Ok(named(name))).ok()?
        } else if is_short(node, &BTreeMap::new()) {
            fraction(node, &mut |name| Ok(kept_together(named(name)))).ok()?
        } else {
            return None;
        };
        let is_long = |number: &Rational| number.numer().bits() + number.denom().bits() > MOST_BITS;
        match value.as_rational().filter(is_long) {
            Some(number) => Some(Fraction::number(nearest(&number))),
            None => Some(value),
        }
    }

    /// The present value of an expression in SI units. It is not finite if the expression has no value.
    pub(super) fn value(&self, constant: &Fraction) -> f64 {
        self.values.value(constant)
    }

    /// Whether a constant contains a parameter.
    pub(super) fn has_parameters(&self, constant: &Fraction) -> bool {
        constant.contains(&mut |symbol| self.system.symbols.is_parameter(symbol))
    }

    /// Whether a constant is positive: at present, and for all permitted values of the parameters as far as its form
    /// shows.
    pub(super) fn is_positive(&self, constant: &Fraction) -> bool {
        constant.is_nonnegative() && self.value(constant) > 0.0
    }
}

/// Whether a constant is short enough for the formula of a pot.
pub(super) fn is_readable(constant: &Fraction) -> bool {
    constant.nested_size(MOST_TERMS + 1) <= MOST_TERMS
}

/// An expression as one factor, which is not multiplied out: its power with the exponent 1.
fn kept_together(value: Fraction) -> Fraction {
    if value.as_rational().is_some() {
        return value;
    }
    opaque(Operation::Call(CallOrder(Function::Power)), vec![value, Fraction::whole(1)])
}
