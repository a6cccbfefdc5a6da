//! The names and values of the parameters and scales in exact expressions.

use patchcord_core::circuit::Circuit;
use patchcord_expr::Dimension;

use crate::graph::ConstantValues;
use crate::symbolic::{Fraction, Symbol, SymbolEntry, SymbolKind, Symbols};

/// At most this number of parameters are varied over their ranges. Every pair of bounds doubles the work.
const MOST_VARIED: usize = 6;

/// The symbols of a plan with those of the scales.
#[derive(Debug)]
pub(super) struct Expressions<'a> {
    /// The parameters of the plan, followed by the scales.
    symbols: Symbols,
    /// The circuit with the values of the parameters.
    circuit: &'a Circuit,
    /// The values of the parameters and of one volt of each scale.
    values: ConstantValues,
}

impl<'a> Expressions<'a> {
    /// The symbols of a plan, without scales.
    pub(super) fn new(symbols: &Symbols, circuit: &'a Circuit) -> Self {
        Expressions { symbols: symbols.clone(), circuit, values: ConstantValues::new(symbols, circuit) }
    }

    /// Adds a scale with its value of one volt in SI units, and returns its symbol. A scale counts as a variable, so that
    /// [`Self::has_parameters`] is false for it.
    pub(super) fn add_scale(&mut self, name: &str, dimension: Dimension, per_volt: f64) -> Fraction {
        let kind = SymbolKind::Variable;
        let symbol =
            self.symbols.add(SymbolEntry { name: name.to_owned(), primes: 0, kind, dimension }, true);
        self.values.set(symbol, per_volt);
        Fraction::symbol(symbol)
    }

    /// The value of an expression in SI units. NaN if it contains a quantity that varies in a run.
    pub(super) fn value(&self, expression: &Fraction) -> f64 {
        self.values.value(expression)
    }

    /// The name of a symbol in formulas.
    pub(super) fn name(&self, symbol: Symbol) -> &str {
        &self.symbols.entry(symbol).name
    }

    /// Whether an expression contains a parameter.
    pub(super) fn has_parameters(&self, expression: &Fraction) -> bool {
        expression.contains(&mut |symbol| self.symbols.is_parameter(symbol))
    }

    /// Whether an expression contains a parameter without a range.
    pub(super) fn has_unbounded_parameters(&self, expression: &Fraction) -> bool {
        expression.contains(&mut |symbol| self.symbols.is_parameter(symbol) && self.range(symbol).is_none())
    }

    /// The largest magnitude of an expression at the present values of its parameters and at the bounds of their ranges.
    pub(super) fn largest(&self, expression: &Fraction) -> f64 {
        let corners = self.corners(expression, &|symbol| self.range(symbol));
        corners.into_iter().map(f64::abs).fold(self.value(expression).abs(), f64::max)
    }

    /// The sign of an expression: 1 or -1. A pot with this sign in front of it is never negative.
    ///
    /// An expression that is 0 at present has the sign of its largest magnitude in the ranges of its parameters. A
    /// parameter without a range can become larger there.
    pub(super) fn sign(&self, expression: &Fraction) -> i8 {
        let value = self.value(expression);
        let decisive = if value == 0.0 { self.extreme(expression) } else { value };
        if decisive < 0.0 { -1 } else { 1 }
    }

    /// An expression without its sign.
    pub(super) fn positive(&self, expression: &Fraction) -> Fraction {
        if self.sign(expression) < 0 { expression.negated() } else { expression.clone() }
    }

    /// The value of largest magnitude in the ranges of the parameters, and in larger values of those without a range. Of
    /// two opposite ones it is the positive one.
    fn extreme(&self, expression: &Fraction) -> f64 {
        let corners = self.corners(expression, &|symbol| self.range(symbol).or_else(|| self.raised(symbol)));
        let finite = corners.into_iter().filter(|value| value.is_finite());
        finite.fold(0.0, |most: f64, value| {
            let is_larger = value.abs() > most.abs() || (value == -most && value > 0.0);
            if is_larger { value } else { most }
        })
    }

    /// The values of an expression at the corners of the ranges of its parameters.
    fn corners(&self, expression: &Fraction, range: &dyn Fn(Symbol) -> Option<[f64; 2]>) -> Vec<f64> {
        let ranges = ranges(expression, range);
        let mut varied = self.values.clone();
        let value = |corner: u32| {
            for (index, (symbol, ends)) in ranges.iter().enumerate() {
                varied.set(*symbol, ends[((corner >> index) & 1) as usize]);
            }
            varied.value(expression)
        };
        (0..1u32 << ranges.len()).map(value).collect()
    }

    /// The present value of a parameter and a larger one. `None` for other symbols.
    fn raised(&self, symbol: Symbol) -> Option<[f64; 2]> {
        let value = self.value(&Fraction::symbol(symbol));
        let is_parameter = self.symbols.is_parameter(symbol);
        is_parameter.then_some([value, if value == 0.0 { 1.0 } else { value + value.abs() / 2.0 }])
    }

    /// The range of a parameter in SI units. `None` for other symbols and without a range.
    fn range(&self, symbol: Symbol) -> Option<[f64; 2]> {
        if !self.symbols.is_parameter(symbol) {
            return None;
        }
        let parameter = self.circuit.patch().parameters.get(self.name(symbol))?;
        let (low, high) = parameter.range?;
        Some([low, high].map(|end| parameter.unit.to_si(end)))
    }
}

/// The ranges of the symbols of an expression that have one.
fn ranges(expression: &Fraction, range: &dyn Fn(Symbol) -> Option<[f64; 2]>) -> Vec<(Symbol, [f64; 2])> {
    let mut ranges: Vec<(Symbol, [f64; 2])> = Vec::new();
    expression.contains(&mut |symbol| {
        let is_new = ranges.len() < MOST_VARIED && ranges.iter().all(|(known, _)| *known != symbol);
        if is_new && let Some(range) = range(symbol) {
            ranges.push((symbol, range));
        }
        false
    });
    ranges
}
