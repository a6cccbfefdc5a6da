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
        expression.contains(&mut |symbol| matches!(self.symbols.entry(symbol).kind, SymbolKind::Parameter(_)))
    }

    /// The largest magnitude of an expression at the present values of its parameters and at the bounds of their ranges.
    pub(super) fn largest(&self, expression: &Fraction) -> f64 {
        let ranges = self.ranges(expression);
        let mut varied = self.values.clone();
        let magnitude = |corner: u32| {
            for (index, (symbol, ends)) in ranges.iter().enumerate() {
                varied.set(*symbol, ends[((corner >> index) & 1) as usize]);
            }
            varied.value(expression).abs()
        };
        let corners = 1u32 << ranges.len();
        (0..corners).map(magnitude).fold(self.value(expression).abs(), f64::max)
    }

    /// The ranges of the parameters of an expression in SI units.
    fn ranges(&self, expression: &Fraction) -> Vec<(Symbol, [f64; 2])> {
        let mut ranges: Vec<(Symbol, [f64; 2])> = Vec::new();
        expression.contains(&mut |symbol| {
            let is_new = ranges.len() < MOST_VARIED && ranges.iter().all(|(known, _)| *known != symbol);
            if is_new && let Some(range) = self.range(symbol) {
                ranges.push((symbol, range));
            }
            false
        });
        ranges
    }

    /// The range of a parameter in SI units. `None` for other symbols and without a range.
    fn range(&self, symbol: Symbol) -> Option<[f64; 2]> {
        let entry = self.symbols.entry(symbol);
        if !matches!(entry.kind, SymbolKind::Parameter(_)) {
            return None;
        }
        let parameter = self.circuit.patch().parameters.get(&entry.name)?;
        let (low, high) = parameter.range?;
        Some([low, high].map(|end| parameter.unit.to_si(end)))
    }
}
